/* SPDX-License-Identifier: MIT */
/* Looks up the properties that paths name in the tables of the families. */
#include <ctype.h>
#include <stdio.h>
#include <string.h>

#include "hal/chips/family.h"
#include "hal/chips/find.h"
#include "hal/chips/format.h"
#include "hal/owfs/path.h"
#include "src/config/check/property.h"
#include "src/ground/text/distance.h"

static bool is_below(const struct property *property, const char *name, size_t len)
{
	return !strncmp(property->name, name, len) && property->name[len] == '/';
}

/* Is name the property itself, or the directory that it is in? */
static bool has_name(const struct family *family, const char *name, size_t len)
{
	const struct property *property = NULL;

	if (family_property(family, NULL, name, len))
		return true;
	while ((property = family_next(family, NULL, property)))
		if (is_below(property, name, len))
			return true;
	return false;
}

static bool has_letters_of(const char *a, const char *b)
{
	int count[256] = {0};

	for (; *a && *b; a++, b++) {
		count[tolower((unsigned char)*a)]++;
		count[tolower((unsigned char)*b)]--;
	}
	for (unsigned i = 0; i < 256; i++)
		if (count[i])
			return false;
	return !*a && !*b;
}

/* Of two names that are as near the one with the same letters: pro is por, not PIO. */
static void find_nearest(const struct family *family, const char *name, const char *extension,
                         char nearest[PROPERTY_NEAREST])
{
	unsigned best = 2 * text_too_far(name);
	const struct property *property = NULL;

	while ((property = family_next(family, NULL, property))) {
		unsigned distance = 2 * text_distance(name, property->name);

		distance += !has_letters_of(name, property->name);
		if (property->type == PROPERTY_DIRECTORY || distance >= best)
			continue;
		best = distance;
		snprintf(nearest, PROPERTY_NEAREST, "%s%s", property->name, extension);
	}
}

/* The property that shows what a write of this one leaves: it, or one that is written the same. */
static const struct property *holder(const struct family *family, const struct property *property)
{
	const struct property *other = NULL;

	if (property->holds || !property->how || !(property->access & ACCESS_WRITE))
		return property->holds ? property : NULL;
	while ((other = family_next(family, NULL, other)) &&
	       (!other->holds || other->how != property->how))
		;
	return other;
}

static void take_access(const struct family *family, const struct property *property,
                        struct path_property *found)
{
	const struct property *held = property ? holder(family, property) : NULL;
	enum property_form form;

	if (!property)
		return;
	form = property_form(property->type);
	snprintf(found->held, sizeof(found->held), "%s", held ? held->name : "");
	found->readable = property->access & ACCESS_READ;
	found->writable = property->access & ACCESS_WRITE;
	found->holds = property->holds;
	found->life = property->life;
	found->alarm = property->alarm;
	found->exact = form == FORM_YESNO || form == FORM_WHOLE;
	found->whole = found->exact;
	found->text = form == FORM_TEXT || form == FORM_DATE;
}

/* What of a property can be named: "latch.BYTE, or latch.0 to latch.7", "por". */
static void print_elements(const struct property *property, char text[PROPERTY_NEAREST])
{
	int first = property->array.index == INDEX_LETTERS ? EXTENSION_LETTERS : 0;
	int last = property->array.count ? first + property->array.count - 1 : first;
	const char *name = property->name;
	char from[8], to[8];
	int n = 0;

	extension_print(property, first, from);
	extension_print(property, last, to);
	if (property->type == PROPERTY_BITS)
		n = snprintf(text, PROPERTY_NEAREST, "%s.BYTE, or ", name);
	n += snprintf(text + n, PROPERTY_NEAREST - (size_t)n, "%s%s", name, from);
	if (last > first)
		snprintf(text + n, PROPERTY_NEAREST - (size_t)n, " to %s%s", name, to);
}

/* The family that the tables have for the device in path; NULL: none. */
static const struct family *family_at(const char *path, struct path *split)
{
	const struct family *family;

	if (path_split(path, strlen(path), split) || !split->has_rom || !split->property.len)
		return NULL;
	family = family_of(split->rom[0]);
	return family->code == split->rom[0] ? family : NULL;
}

struct path_property property_look(const char *path)
{
	struct path_property found = {
		.exists = true, .readable = true, .writable = true, .exact = true};
	char name[PATH_LEN_MAX + 1], *dot;
	const struct property *property;
	struct path split;
	const struct family *family = family_at(path, &split);
	int extension;
	size_t len;

	if (!family || split.property.len >= sizeof(name))
		return found;
	found.type = family->type;
	memcpy(name, split.property.text, split.property.len);
	name[split.property.len] = '\0';
	dot = strrchr(name, '.');
	property = family_property(family, NULL, name, strlen(name));
	if (!property && dot)
		property = family_property(family, NULL, name, (size_t)(dot - name));
	take_access(family, property, &found);
	extension = extension_split(name, split.property.len, &len);
	if (property && strlen(property->name) == len && !extension_fits(property, extension)) {
		found.exists = false;
		if (dot && property->type == PROPERTY_BITS && text_distance(dot + 1, "BYTE") < 3)
			snprintf(found.nearest, PROPERTY_NEAREST, "%s.BYTE", property->name);
		else
			print_elements(property, found.nearest);
		return found;
	}
	found.text |= property && extension == EXTENSION_ALL;
	if (property || has_name(family, name, strlen(name)) ||
	    (dot && has_name(family, name, (size_t)(dot - name))))
		return found;
	found.exists = false;
	if (dot)
		*dot = '\0';
	find_nearest(family, name, dot ? split.property.text + (dot - name) : "", found.nearest);
	return found;
}

/* --- What alarms ask of a property ------------------------------------------------------------ */

/* How many characters both begin with. */
static size_t common(const char *a, const struct path_slice *b)
{
	size_t n = 0;

	while (n < b->len && a[n] && a[n] == b->text[n])
		n++;
	return n;
}

bool property_of_alarm(const char *path, uint8_t alarm, char text[PROPERTY_NEAREST])
{
	const struct property *property = NULL, *best = NULL;
	struct path split;
	const struct family *family = family_at(path, &split);

	while (family && (property = family_next(family, NULL, property)))
		if ((property->alarm & alarm) && !property->hidden &&
		    (!best ||
		     common(property->name, &split.property) > common(best->name, &split.property)))
			best = property;
	if (!best)
		return false;
	if (best->array.index == INDEX_NONE)
		snprintf(text, PROPERTY_NEAREST, "%s", best->name);
	else
		print_elements(best, text);
	return true;
}

static int digits_of(uint32_t number)
{
	return snprintf(NULL, 0, "%u", (unsigned)number);
}

bool property_takes(const char *path, const char *value, char why[PROPERTY_NEAREST])
{
	struct path split;
	const struct family *family = family_at(path, &split);
	const struct property *property = NULL;
	size_t len = 0;
	int extension = EXTENSION_NONE;

	if (family) {
		extension = extension_split(split.property.text, split.property.len, &len);
		property = family_property(family, NULL, split.property.text, len);
	}
	if (!property || !extension_fits(property, extension))
		return true;
	switch (property->type) {
	case PROPERTY_YESNO:
	case PROPERTY_BITS:
	case PROPERTY_UNSIGNED:
	case PROPERTY_INTEGER:
	case PROPERTY_FLOAT:
	case PROPERTY_TEMPERATURE:
		break;
	default:
		return true;
	}
	if (property->digits && (int)strlen(value) != digits_of(property->digits)) {
		snprintf(why, PROPERTY_NEAREST, " has %d digits", digits_of(property->digits));
		return false;
	}
	snprintf(why, PROPERTY_NEAREST, " does not take this value");
	return format_takes(property, extension, value, strlen(value));
}
