/* SPDX-License-Identifier: MIT */
/* Looks up in the tables of the families what programs show of a path, or judge a value by. */
#include <math.h>
#include <string.h>

#include "hal/chips/bridges/bridge.h"
#include "hal/chips/facts.h"
#include "hal/chips/find.h"
#include "hal/owfs/path.h"

const char *family_name(uint8_t code)
{
	const struct family *family = family_of(code);

	return family == &family_common ? bridge_type(code) : family->type;
}

/* The row of the property, or of the array that it is an element of; NULL: it measures nothing. */
static const struct property *measuring_row(const struct family *family,
                                            const struct path_slice *name)
{
	const char *dot = memchr(name->text, '.', name->len);
	size_t len = dot ? (size_t)(dot - name->text) : name->len;
	const struct property *row = family_property(family, NULL, name->text, len);

	return row && row->measures.least < row->measures.most ? row : NULL;
}

bool quantity_of(const char *text, struct quantity *quantity)
{
	const struct property *row = NULL;
	const struct family *family;
	struct path path;

	if (path_split(text, strlen(text), &path) || !path.device.len || !path.property.len)
		return false;
	if (path.has_rom)
		row = measuring_row(family_of(path.rom[0]), &path.property);
	for (unsigned n = 0; !path.has_rom && !row && (family = family_nth(n)); n++)
		row = measuring_row(family, &path.property);
	if (!row)
		return false;
	*quantity = (struct quantity){.least = row->measures.least,
	                              .most = row->measures.most,
	                              .decimals = row->measures.decimals,
	                              .starves = row->measures.starves,
	                              .unit = row->measures.unit};
	if (!path.has_rom) {
		/* a temperature is not below absolute zero, whatever measures it */
		quantity->least = quantity->starves ? -273.15 : -HUGE_VAL;
		quantity->most = HUGE_VAL;
	}
	return true;
}

bool quantity_excludes(const struct quantity *quantity, double number)
{
	return number < quantity->least || number > quantity->most;
}
