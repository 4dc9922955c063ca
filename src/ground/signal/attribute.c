/* SPDX-License-Identifier: MIT */
/* The names of driver signals and attributes, and how a name is looked up. */
#include <errno.h>
#include <stdint.h>
#include <string.h>

#include "src/ground/signal/attribute.h"
#include "src/ground/signal/utf8.h"

const struct attribute_def attribute_table[ATTR_COUNT] = {
	[ATTR_VALUE] = {"_Value", NULL, (enum ows_type)0, true, true, false},
	[ATTR_DGNRESET] = {"_DGNRESET", NULL, OWS_BOOL, false, true, false},
	[ATTR_TRANSACTIONS] = {"_TRANSACTIONS", NULL, OWS_LARGE, true, false, false},
	[ATTR_READ_ENABLE] = {"_ReadEnable", "_RE", OWS_BOOL, true, true, false},
	[ATTR_WRITE_ENABLE] = {"_WriteEnable", "_WE", OWS_BOOL, true, true, false},
	[ATTR_READ_ONE_SHOT] = {"_ReadOneShot", "_ROS", OWS_BOOL, false, true, false},
	[ATTR_WRITE_ONE_SHOT] = {"_WriteOneShot", "_WOS", OWS_BOOL, false, true, false},
	[ATTR_ALARM] = {"_Alarm", NULL, OWS_BOOL, true, false, false},
	[ATTR_PER_FACTOR] = {"_PerFactor", NULL, OWS_LARGE, true, false, false},
	[ATTR_PER_COUNT] = {"_PerCount", NULL, OWS_LARGE, true, false, false},
	[ATTR_PER_MAX] = {"_PerMax", NULL, OWS_LARGE, true, false, false},
	[ATTR_PEND_COUNT] = {"_PendCount", NULL, OWS_LARGE, true, false, false},
	[ATTR_PEND_LAST] = {"_PendLast", NULL, OWS_LARGE, true, false, false},
	[ATTR_PEND_MAX] = {"_PendMax", NULL, OWS_LARGE, true, false, false},
	[ATTR_PERIOD] = {"_Period", NULL, OWS_DOUBLE, true, false, false},
	[ATTR_AGE] = {"_Age", NULL, OWS_DOUBLE, true, false, false},
	[ATTR_AGE_MAX] = {"_AgeMax", NULL, OWS_DOUBLE, true, false, false},
	[ATTR_RAW] = {"_Raw", NULL, OWS_DOUBLE, true, false, false},
	[ATTR_DRIVER_DGNRESET] = {"_DGNRESET", NULL, OWS_BOOL, false, true, true},
	[ATTR_DRIVER_TRANSACTIONS] = {"_TRANSACTIONS", NULL, OWS_LARGE, true, false, true},
	[ATTR_DRIVER_RECONNECTS] = {"_RECONNECTS", NULL, OWS_LARGE, true, false, true},
};

static int driver_signal(const char *name)
{
	for (int i = 0; i < ATTR_COUNT; i++)
		if (attribute_table[i].driver && !strcmp(attribute_table[i].name, name))
			return i;
	return -1;
}

static bool ends_with(const char *name, size_t len, const char *suffix, size_t *stem)
{
	size_t tail = suffix ? strlen(suffix) : 0;

	if (!tail || tail >= len || memcmp(name + len - tail, suffix, tail))
		return false;
	*stem = len - tail;
	return true;
}

/* The record of the longest signal name that is followed by an attribute in name, or -1. */
static int split_lookup(const char *name, attribute_find *find, void *ctx,
                        enum attribute *attribute)
{
	size_t len = strlen(name), stem, longest = 0;
	int record = -1;

	for (int i = 0; i < ATTR_COUNT; i++) {
		const struct attribute_def *def = &attribute_table[i];
		int found;

		if (def->driver || (!ends_with(name, len, def->name, &stem) &&
		                    !ends_with(name, len, def->brief, &stem)))
			continue;
		if (stem <= longest)
			continue;
		found = find(ctx, name, stem);
		if (found < 0)
			continue;
		record = found;
		longest = stem;
		*attribute = (enum attribute)i;
	}
	return record;
}

int attribute_lookup(const char *prefix, const char *name, attribute_find *find, void *ctx,
                     enum attribute *attribute)
{
	size_t skip = prefix ? strlen(prefix) : 0;
	const char *forms[2] = {name, NULL}; /* the name as it is, and without PREFIX__ */
	int record;

	if (skip && !strncmp(name, prefix, skip) && name[skip] == '_' && name[skip + 1] == '_')
		forms[1] = name + skip + 2;
	for (int i = 0; i < 2; i++) {
		if (!forms[i] || !*forms[i])
			continue;
		record = find(ctx, forms[i], strlen(forms[i]));
		if (record >= 0) {
			*attribute = ATTR_VALUE;
			return record;
		}
	}
	for (int i = 0; i < 2; i++) {
		int driver = forms[i] ? driver_signal(forms[i]) : -1;

		if (driver >= 0) {
			*attribute = (enum attribute)driver;
			return 0;
		}
	}
	for (int i = 0; i < 2; i++) {
		record = forms[i] ? split_lookup(forms[i], find, ctx, attribute) : -1;
		if (record >= 0)
			return record;
	}
	return -ENOENT;
}

static bool between(int32_t code, int32_t first, int32_t last)
{
	return code >= first && code <= last;
}

const char *signal_name_fault(const char *name)
{
	size_t left = strnlen(name, SIGNAL_NAME_MAX + 1);

	if (!*name)
		return "is empty";
	if (left > SIGNAL_NAME_MAX)
		return "is longer than 63 bytes";
	/* a name is served as /signals/NAME, and is a file where owfs mounts /signals */
	if (!strcmp(name, ".") || !strcmp(name, ".."))
		return "cannot stand in a path";
	for (const char *p = name; left > 0;) {
		int32_t code = utf8_next(&p, &left);

		if (code < 0)
			return "is not UTF-8: convert the file, as with iconv -f cp1250 -t utf-8";
		if (code < 0x20 || between(code, 0x7f, 0x9f))
			return "holds a control character";
		if (code == ' ' || code == 0xa0 || code == 0x1680 ||
		    between(code, 0x2000, 0x200f) || between(code, 0x2028, 0x202f) ||
		    between(code, 0x205f, 0x2064) || code == 0x3000 || code == 0xfeff)
			return "holds a blank or an invisible character";
		if (code < 0x80 && strchr("/\"#{}", code))
			return "holds one of / \" # { }";
	}
	if (driver_signal(name) >= 0)
		return "is the name of a driver signal";
	return NULL;
}
