/* SPDX-License-Identifier: MIT */
/* The properties that most people want of a device, as signals. */
#include <string.h>

#include "hal/chips/find.h"
#include "src/scan/kind.h"

/* In periods of 0.1 s: measurements once a second, contacts in each period. */
#define MEASURED 10

static enum ows_type type_of(const struct property *row, const char *name)
{
	if (row->type == PROPERTY_FLOAT || row->type == PROPERTY_TEMPERATURE)
		return OWS_DOUBLE;
	if (row->type == PROPERTY_UNSIGNED)
		return OWS_DWORD;
	return strstr(name, ".BYTE") ? OWS_BYTE : OWS_BOOL;
}

bool scan_property(uint8_t code, unsigned i, struct scan_property *property)
{
	const struct family *family = family_of(code);
	const struct family_scan *scan = family->scan;
	const struct property *row;

	while (scan && scan->name && i--)
		scan++;
	if (!scan || !scan->name)
		return false;
	row = family_property(family, NULL, scan->name, strcspn(scan->name, "."));
	if (!row)
		return false;
	*property = (struct scan_property){.name = scan->name,
	                                   .word = scan->word,
	                                   .type = type_of(row, scan->name),
	                                   .output = row->access & ACCESS_WRITE};
	property->per_factor = property->type == OWS_DOUBLE ? MEASURED : 0;
	return true;
}

bool scan_has_identity(uint8_t code)
{
	return family_property(family_of(code), NULL, "identity", strlen("identity"));
}
