/* SPDX-License-Identifier: MIT */
/* Looks up in the tables of the families what programs show of a path, or judge a value by. */
#include <math.h>
#include <string.h>

#include "hal/chips/bridges/bridge.h"
#include "hal/chips/facts.h"
#include "hal/chips/find.h"
#include "hal/chips/format.h"
#include "hal/owfs/path.h"

/* Of which kind a chip is that has the property; 0: of any. */
static unsigned kind_of(const struct property *row)
{
	unsigned kind = 0;

	for (unsigned n = 1; n < 32; n++)
		if (row && row->kinds == KIND(n))
			kind = n;
	return kind;
}

const char *model_of(const char *text)
{
	const struct family *family;
	const struct property *row;
	struct path path;
	size_t len;

	if (path_split(text, strlen(text), &path) || !path.has_rom)
		return NULL;
	family = family_of(path.rom[0]);
	if (family == &family_common)
		return bridge_type(path.rom[0]);
	len = strcspn(path.property.len ? path.property.text : "", ".");
	row = family_property(family, NULL, path.property.text, len);
	if (!kind_of(row))
		return family->type;
	if (family->types)
		return family->types[kind_of(row)];
	/* the directory of those of the kind has its name */
	row = family->model ? family_property(family, NULL, path.property.text,
	                                      strcspn(path.property.text, "/"))
	                    : NULL;
	return row ? row->name : family->type;
}

/* A temperature is not below this, whatever measures it. */
#define ABSOLUTE_ZERO (-273.15)

/* What the type of a property says of it, where its row does not say more. */
static bool quantity_of_type(uint8_t type, struct quantity *quantity)
{
	*quantity = (struct quantity){
		.least = type == PROPERTY_TEMPERATURE ? ABSOLUTE_ZERO : -HUGE_VAL,
		.most = HUGE_VAL,
		.decimals = -1,
		.unit = type == PROPERTY_TEMPERATURE ? DEGREES_C
	                : type == PROPERTY_TEMPGAP   ? "K"
	                : type == PROPERTY_PRESSURE  ? "mbar"
	                                             : NULL,
	};
	return quantity->unit;
}

/* The row of the property, or of the array that it is an element of; NULL: there is none. */
static const struct property *row_of(const struct family *family, const struct path_slice *name)
{
	const char *dot = memchr(name->text, '.', name->len);
	size_t len = dot ? (size_t)(dot - name->text) : name->len;

	return family_property(family, NULL, name->text, len);
}

static bool quantity_of_row(const struct property *row, struct quantity *quantity)
{
	if (row->measures.least >= row->measures.most)
		return quantity_of_type(row->type, quantity);
	*quantity = (struct quantity){.least = row->measures.least,
	                              .most = row->measures.most,
	                              .decimals = row->measures.decimals,
	                              .starves = row->measures.starves,
	                              .unit = row->measures.unit};
	return true;
}

/* The quantity of the property, or of the array that it is an element of; false: it has none. */
static bool quantity_of_name(const struct family *family, const struct path_slice *name,
                             struct quantity *quantity)
{
	const struct property *row = row_of(family, name);

	return row && quantity_of_row(row, quantity);
}

/* Of a property whose chip is not known. */
static bool quantity_of_any(const struct path_slice *name, struct quantity *quantity)
{
	const struct family *family;
	bool found = false;

	for (unsigned n = 0; (family = family_nth(n)); n++) {
		struct quantity one;

		if (!quantity_of_name(family, name, &one))
			continue;
		if (!found || one.starves)
			*quantity = one;
		found = true;
	}
	if (!found)
		return false;
	quantity->least = strcmp(quantity->unit, DEGREES_C) ? -HUGE_VAL : ABSOLUTE_ZERO;
	quantity->most = HUGE_VAL;
	return true;
}

bool quantity_of(const char *text, struct quantity *quantity)
{
	struct path path;

	if (path_split(text, strlen(text), &path) || !path.device.len || !path.property.len)
		return false;
	return path.has_rom ? quantity_of_name(family_of(path.rom[0]), &path.property, quantity)
	                    : quantity_of_any(&path.property, quantity);
}

bool facts_shows_device(const char *text)
{
	const struct property *row;
	struct path path;

	if (path_split(text, strlen(text), &path) || !path.device.len || !path.property.len)
		return false;
	row = row_of(path.has_rom ? family_of(path.rom[0]) : &family_common, &path.property);
	return !row || !(row->offline || strcmp(row->name, "present") == 0);
}

bool facts_latches(const char *text)
{
	struct path path;

	return path_split(text, strlen(text), &path) || !path.has_rom ||
	       family_of(path.rom[0])->latches;
}

/* A sensor is good to no more, whatever its register resolves. */
static const struct {
	const char *unit;
	int decimals;
} wanted[] = {
	{DEGREES_C, 1}, {"\u00b0F", 1}, {"K", 1},   {"%", 1},   {"mbar", 1}, {"hPa", 1}, {"Pa", 0},
	{"kPa", 2},     {"inHg", 2},    {"psi", 2}, {"bar", 3}, {"V", 3},    {"mV", 1},  {"A", 3},
	{"mA", 1},      {"\u00b5A", 0}, {"lx", 1},  {"m/s", 1}, {"h", 1},    {"m", 2},
};

int unit_decimals(const char *unit)
{
	for (size_t i = 0; i < sizeof(wanted) / sizeof(wanted[0]); i++)
		if (strcmp(wanted[i].unit, unit) == 0)
			return wanted[i].decimals;
	return -1;
}

int quantity_decimals(const struct quantity *quantity)
{
	int decimals = unit_decimals(quantity->unit);

	if (decimals < 0 || quantity->decimals < 0)
		return quantity->decimals;
	if (quantity->most < 1) /* volts of a shunt */
		decimals += 2;
	return decimals < quantity->decimals ? decimals : quantity->decimals;
}

bool quantity_excludes(const struct quantity *quantity, double number)
{
	return number < quantity->least || number > quantity->most;
}

bool reading_excluded(const struct property *property, int extension, struct txn *txn)
{
	unsigned count = extension == EXTENSION_ALL ? property->array.count : 1;
	struct quantity quantity;

	if (!quantity_of_row(property, &quantity))
		return false;
	for (unsigned i = 0; i < count; i++) {
		double number = extension == EXTENSION_ALL
		                        ? txn->number[i]
		                        : format_as_number(property, extension, txn);

		if (!quantity_excludes(&quantity, number))
			continue;
		txn->number[0] = number;
		return true;
	}
	return false;
}
