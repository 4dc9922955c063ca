/* SPDX-License-Identifier: MIT */
/* Fields of areas: bits of a chip and the values that they mean. */
#include <errno.h>

#include "hal/chips/field.h"

#define BYTES_MAX 4

const struct family *family_owner(const struct family *family, const struct property *property)
{
	uintptr_t row = (uintptr_t)property, first = (uintptr_t)family->properties;

	return row >= first && row - first < family->count * sizeof(*property) ? family
	                                                                       : &family_common;
}

const struct property_how *family_how(const struct family *family, const struct property *property)
{
	static const struct property_how none;

	return property->how ? &family_owner(family, property)->how[property->how] : &none;
}

const struct area *family_area(const struct txn *txn)
{
	return family_owner(txn->device->family, txn->property)->areas[txn->property->field.area];
}

static unsigned bytes_of(const struct field *field)
{
	return field->bytes ? field->bytes : 1;
}

static uint32_t mask_of(const struct field *field)
{
	unsigned bits = field->bits ? field->bits : 8 * bytes_of(field) - field->shift;

	return bits < 32 ? (UINT32_C(1) << bits) - 1 : UINT32_MAX;
}

static uint32_t join_bytes(const struct field *field, const uint8_t *bytes)
{
	uint32_t joined = 0;
	unsigned n = bytes_of(field);

	for (unsigned i = 0; i < n; i++)
		joined = joined << 8 | bytes[field->big_endian ? i : n - 1 - i];
	return joined;
}

static void split_bytes(const struct field *field, uint32_t joined, uint8_t bytes[BYTES_MAX])
{
	unsigned n = bytes_of(field);

	for (unsigned i = 0; i < n; i++, joined >>= 8)
		bytes[field->big_endian ? n - 1 - i : i] = (uint8_t)joined;
}

static double value_of_bits(const struct field *field, uint32_t joined)
{
	uint32_t mask = mask_of(field);
	uint32_t bits = (field->inverted ? ~joined : joined) >> field->shift & mask;
	double value = bits;

	if (field->is_signed && bits > mask >> 1)
		value -= (double)mask + 1;
	return value * (field->unit != 0 ? field->unit : 1) + field->offset;
}

static bool is_binary(const struct property *property)
{
	return property->type == PROPERTY_BINARY;
}

/* Where the element begins. */
static unsigned element_at(const struct property *property, const struct field *field,
                           unsigned element)
{
	unsigned stride = field->stride || !is_binary(property) ? field->stride : property->size;

	bool counted = property->array.count || property->array.index == INDEX_NUMBERS;

	/* of a text behind the dot (SPARSE(LETTERS)) there is one element */
	return field->at + (counted ? element * stride : 0);
}

/* A txn's property has an area, so it has a device. */
static const struct area *area_of(const struct txn *txn, const struct field *field)
{
	return family_owner(txn->device->family, txn->property)->areas[field->area];
}

static const struct field *written_field(const struct family *family,
                                         const struct property *property)
{
	const struct field *set = &family_how(family, property)->set;

	return set->area ? set : &property->field;
}

int field_read(struct txn *txn)
{
	const struct property *property = txn->property;
	const struct field *field = &property->field;
	const struct area *area = area_of(txn, field);
	unsigned at = element_at(property, field, (unsigned)txn->element), count = 1;
	uint8_t bytes[AREA_UNIT];

	if (is_binary(property)) {
		unsigned left = property->size - (unsigned)txn->at;

		return area_read_data(txn, area, at + (unsigned)txn->at,
		                      left < FIELD_CHUNK ? left : FIELD_CHUNK);
	}
	if (property->array.aggregate && field->stride) {
		at = field->at;
		count = property->array.count;
	}
	int err = area_read(txn, area, at, bytes, (count - 1) * field->stride + bytes_of(field));
	if (err)
		return err;
	if (property->type == PROPERTY_BITS) {
		txn->bits = join_bytes(field, bytes) >> field->shift ^
		            (field->inverted ? UINT32_MAX : 0);
		txn->bits &= (UINT32_C(1) << property->array.count) - 1;
	}
	for (unsigned i = 0; i < count; i++)
		txn->number[i] = value_of_bits(field, join_bytes(field, bytes + i * field->stride));
	return 0;
}

/* The bits of a value, in their place; -EINVAL: there are none for it. */
static int bits_of(const struct field *field, double value, uint32_t *bits)
{
	uint32_t mask = mask_of(field);
	double steps = (value - field->offset) / (field->unit != 0 ? field->unit : 1);
	double lowest = field->is_signed ? -((double)(mask >> 1) + 1) : 0;
	double highest = field->is_signed ? mask >> 1 : mask;

	steps += steps < 0 ? -0.5 : 0.5;
	if (!(steps > lowest - 1 && steps < highest + 1))
		return -EINVAL;
	*bits = (uint32_t)(int64_t)steps;
	*bits = ((field->inverted ? ~*bits : *bits) & mask) << field->shift;
	return 0;
}

int field_write(struct txn *txn)
{
	const struct property *property = txn->property;
	const struct field *field = written_field(txn->device->family, property);
	const struct area *area = area_of(txn, field);
	unsigned at = element_at(property, field, (unsigned)txn->element), count = 1;
	uint8_t bytes[AREA_UNIT], which[AREA_UNIT] = {0};
	uint32_t bits = 0, mask = mask_of(field) << field->shift;

	if (is_binary(property))
		return area_write(txn, area, at + (unsigned)txn->at, txn->data, NULL,
		                  (unsigned)txn->len);
	if (property->type == PROPERTY_BITS) {
		mask = field->bits ? mask
		                   : ((UINT32_C(1) << property->array.count) - 1) << field->shift;
		mask = txn->one ? UINT32_C(1) << txn->element << field->shift : mask;
		bits = (field->inverted ? ~txn->bits : txn->bits) << field->shift;
		split_bytes(field, bits, bytes);
		split_bytes(field, mask, which);
		return area_write(txn, area, field->at, bytes, which, bytes_of(field));
	}
	if (property->array.aggregate && !txn->one)
		count = property->array.count;
	for (unsigned i = 0; i < count; i++) {
		bool other = property->array.aggregate && txn->one;
		int err = bits_of(field, txn->number[other ? (unsigned)txn->element : i], &bits);

		if (err)
			return err;
		split_bytes(field, bits, bytes + i * field->stride);
		split_bytes(field, mask, which + i * field->stride);
	}
	return area_write(txn, area, at, bytes, which,
	                  (count - 1) * field->stride + bytes_of(field));
}

property_function *property_reader(const struct family *family, const struct property *property)
{
	property_function *read = family_how(family, property)->read;

	return read || !property->field.area ? read : field_read;
}

property_function *property_writer(const struct family *family, const struct property *property)
{
	property_function *write = family_how(family, property)->write;
	bool none = !(property->access & ACCESS_WRITE) || !written_field(family, property)->area;

	return write || none ? write : field_write;
}
