/* SPDX-License-Identifier: MIT */
/* The rows of a family that are no reading of scan_property(). */
#include "src/tool/scan/left_out.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "hal/chips/find.h"

/* The chips of the family that have the row, as bits. */
static uint32_t chips_of(const struct family *family, const struct property *row)
{
	return row->kinds ? row->kinds : family->plain ? family->plain : UINT32_MAX;
}

/* "temp" of "latesttemp", "volt" of "8bit/latestvolt2": another form of the same reading. */
static const char *reading_of(const char *name, size_t *len)
{
	static const char *const other[] = {"latest", "fast"};
	const char *slash = strrchr(name, '/');

	name = slash ? slash + 1 : name;
	for (size_t i = 0; i < sizeof(other) / sizeof(other[0]); i++)
		if (!strncmp(name, other[i], strlen(other[i])))
			name += strlen(other[i]);
	*len = strcspn(name, ".0123456789");
	return name;
}

static bool is_form_of(const char *name, const char *wanted)
{
	size_t len, wanted_len;
	const char *reading = reading_of(name, &len);

	wanted = reading_of(wanted, &wanted_len);
	return len <= wanted_len && !memcmp(reading, wanted, len);
}

/* A reading in its range, or bits that are no flags of alarms or their settings. */
static bool measures_or_switches(const struct property *row)
{
	if (row->hidden || row->life != LIFE_VOLATILE || !(row->access & ACCESS_READ))
		return false;
	if (row->type == PROPERTY_BITS)
		return !row->alarm && !strstr(row->name, "alarm");
	return row->access == ACCESS_READ && row->measures.most > row->measures.least &&
	       isfinite(row->measures.least);
}

static bool has_form_of(const struct scan_device *device, const char *name)
{
	struct scan_property item;

	for (unsigned i = 0; scan_property(device, i, &item); i++)
		if (is_form_of(name, item.name))
			return true;
	return false;
}

/* The chips of its family that the device may be, by what it answered. */
static uint32_t possible(const struct scan_device *device, const struct family *family)
{
	struct scan_property item;
	uint32_t chips = UINT32_MAX;

	for (unsigned i = 0; scan_property(device, i, &item); i++) {
		uint32_t having = chips_of(
			family, family_property(family, NULL, item.name, strcspn(item.name, ".")));

		chips &= device->value[i].err == -ENOENT ? ~having : having;
	}
	return chips;
}

void scan_left_out(const struct scan_device *device, char *out, size_t size)
{
	const struct family *family = family_of(device->family);
	uint32_t chips = possible(device, family);
	size_t used = 0;

	out[0] = '\0';
	for (unsigned i = 0; i < family->count && used < size; i++) {
		const struct property *row = &family->properties[i];

		if (measures_or_switches(row) && chips_of(family, row) & chips &&
		    !has_form_of(device, row->name))
			used += (size_t)snprintf(out + used, size - used, "%s%s", used ? ", " : "",
			                         row->name);
	}
}
