/* SPDX-License-Identifier: MIT */
/*
 * Sensors behind a bridge, measured as their table says. What a DS28E17 answers has no checksum. So
 * what is read from a register is read until three looks in a row are the same, and all else needs
 * a checksum of the sensor's own. All that a DS28E18 answers has one.
 */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/chips/bridges/bridge.h"
#include "hal/chips/bridges/i2c.h"
#include "hal/chips/find.h"

#define LOOKS 3
#define TRIES 12
#define SHARED 32

struct visit {
	uint8_t step, looks, tries;
	uint8_t part; /* of what a DS28E18 does one after the other */
	bool begun, written;
	int64_t begun_ns;
	uint8_t last[SENSOR_AT_ONCE];
};

const char *bridge_type(uint8_t code)
{
	return code == DS28E17_CODE ? "DS28E17" : code == DS28E18_CODE ? "DS28E18" : NULL;
}

/* --- A measurement --------------------------------------------------------------------------- */

struct sensor {
	const struct sensor_table *table;
	const struct sensor_kind *kind;
	struct sensor_chip *chip;
	const struct sensor_value *value;
};

/* That of the property: arg has the chip and the value. */
static struct sensor sensor_of(const struct txn *txn)
{
	const struct sensor_bridge *bridge = (const struct sensor_bridge *)txn->device->family;
	struct sensor_chip *chip = &bridge->chips[txn->property->arg >> 8];
	const struct sensor_kind *kind = &bridge->table->kinds[chip->kind];

	return (struct sensor){
		.table = bridge->table,
		.kind = kind,
		.chip = chip,
		.value = &bridge->table->values[kind->first_value +
	                                        (unsigned)(txn->property->arg & 0xff)],
	};
}

static double evaluate(const struct sensor *sensor, struct formula formula, double set)
{
	const struct formula_input input = {
		.bytes = sensor->chip->bytes, .names = sensor->chip->names, .set = set};

	return formula_value(&sensor->table->pool, formula, &input);
}

static int bridge_exchange(struct txn *txn, const struct i2c_transfer *transfer)
{
	struct visit *visit = txn_own(txn, struct visit);

	return txn->device->rom[0] == DS28E17_CODE ? ds28e17_exchange(txn, transfer)
	                                           : ds28e18_exchange(txn, transfer, &visit->part);
}

static int write_to_sensor(struct txn *txn, const struct sensor *sensor, unsigned first,
                           unsigned count, uint8_t *in, unsigned m)
{
	uint8_t out[SENSOR_AT_ONCE];

	for (unsigned i = 0; i < count; i++) {
		double byte = evaluate(sensor, sensor->table->bytes[first + i], txn->number[0]);

		if (!(byte >= 0 && byte <= 255) || byte != floor(byte))
			return -EINVAL;
		out[i] = (uint8_t)byte;
	}
	return bridge_exchange(txn,
	                       &(struct i2c_transfer){sensor->chip->address, out, count, in, m});
}

static bool checksum_fits(const struct sensor_step *step, const uint8_t *bytes)
{
	uint8_t crc = step->start;

	for (unsigned i = 0; i < step->n; i++) {
		crc ^= bytes[step->at + i];
		for (unsigned bit = 0; bit < 8; bit++)
			crc = (uint8_t)(crc & 0x80 ? crc << 1 ^ step->polynomial : crc << 1);
	}
	return crc == bytes[step->at + step->n];
}

/* A register: until three looks in a row are the same. 0 when they are. */
static int bridge_look(struct txn *txn, const struct sensor *sensor, const struct sensor_step *step)
{
	struct visit *visit = txn_own(txn, struct visit);
	uint8_t in[SENSOR_AT_ONCE];
	int err = write_to_sensor(txn, sensor, step->first, step->count, in, step->n);

	if (err)
		return err;
	if (visit->looks && memcmp(in, visit->last, step->n) != 0)
		visit->looks = 0;
	memcpy(visit->last, in, step->n);
	if (++visit->looks < (txn->device->rom[0] == DS28E17_CODE ? LOOKS : 1))
		return ++visit->tries < TRIES ? TXN_MORE : -EBADMSG;
	memcpy(sensor->chip->bytes + step->at, in, step->n);
	visit->looks = visit->tries = 0;
	return 0;
}

/* What needs no wire. */
static int compute(struct txn *txn, const struct sensor *sensor, const struct sensor_step *step)
{
	double a = evaluate(sensor, step->a, 0);

	if (step->kind == SENSOR_CRC8)
		return txn_checked(txn, checksum_fits(step, sensor->chip->bytes));
	if (step->kind == SENSOR_LET)
		sensor->chip->names[step->name] = a;
	return step->kind == SENSOR_SAME && a != evaluate(sensor, step->b, 0) ? -EIO : 0;
}

/* One step; TXN_MORE: it used the wire, or has to be waited for. */
static int bridge_step(struct txn *txn, const struct sensor *sensor)
{
	struct visit *visit = txn_own(txn, struct visit);
	const struct sensor_step *step =
		&sensor->table->steps[sensor->kind->first_step + visit->step];
	int err;

	switch (step->kind) {
	case SENSOR_WRITE:
		err = write_to_sensor(txn, sensor, step->first, step->count, NULL, 0);
		break;
	case SENSOR_EXCHANGE:
		err = bridge_look(txn, sensor, step);
		break;
	case SENSOR_READ:
		err = bridge_exchange(txn,
		                      &(struct i2c_transfer){.address = sensor->chip->address,
		                                             .in = sensor->chip->bytes + step->at,
		                                             .m = step->n});
		break;
	case SENSOR_WAIT:
		visit->step++;
		return txn_wait(txn, step->wait_ns);
	default:
		err = compute(txn, sensor, step);
		visit->step++;
		return err;
	}
	if (err)
		return err;
	visit->step++;
	return TXN_MORE;
}

/* Bytes that another request has read serve; what was computed of them is computed again. */
static bool take_shared(struct txn *txn, const struct sensor *sensor)
{
	unsigned n = sensor->kind->bytes;

	for (unsigned at = 0; at < n; at += SHARED)
		if (!txn_shared(txn, sensor->chip, at, sensor->chip->bytes + at,
		                n - at < SHARED ? n - at : SHARED))
			return false;
	for (unsigned i = 0; i < sensor->kind->steps; i++) {
		const struct sensor_step *step =
			&sensor->table->steps[sensor->kind->first_step + i];

		if (step->kind >= SENSOR_CRC8 && compute(txn, sensor, step))
			return false;
	}
	return n > 0;
}

static void share_bytes(struct txn *txn, const struct sensor *sensor)
{
	const struct visit *visit = txn_own(txn, struct visit);
	unsigned n = sensor->kind->bytes;

	for (unsigned at = 0; at < n; at += SHARED)
		txn_share(txn, sensor->chip, at, sensor->chip->bytes + at,
		          n - at < SHARED ? n - at : SHARED, visit->begun_ns);
}

static int bridge_measure(struct txn *txn, const struct sensor *sensor)
{
	struct visit *visit = txn_own(txn, struct visit);
	int err = 0;

	if (!visit->begun) {
		visit->begun = true;
		visit->begun_ns = txn_now(txn);
		if (take_shared(txn, sensor))
			return 0;
		memset(sensor->chip->bytes, 0, sizeof(sensor->chip->bytes));
	}
	while (!err && visit->step < sensor->kind->steps)
		err = bridge_step(txn, sensor);
	if (err)
		return err;
	share_bytes(txn, sensor);
	txn->measured_ns = visit->begun_ns;
	return 0;
}

bool bridge_bounded(uint8_t type)
{
	return type == PROPERTY_UNSIGNED || type == PROPERTY_INTEGER || type == PROPERTY_YESNO;
}

void bridge_bounds(uint8_t type, double *least, double *most)
{
	*least = type == PROPERTY_INTEGER ? -2147483648.0 : 0;
	*most = type == PROPERTY_INTEGER ? 2147483647.0 : type == PROPERTY_YESNO ? 1 : 4294967295.0;
}

/* The value of what was measured; -EDOM: it is none that the sensor can mean. */
static int take_result(const struct sensor *sensor, double *number)
{
	const struct sensor_value *value = sensor->value;
	double least, most;

	bridge_bounds(value->type, &least, &most);
	*number = evaluate(sensor, value->formula, 0);
	if (!isfinite(*number) ||
	    (value->ranged && (*number < value->low || *number > value->high)))
		return -EDOM;
	if (bridge_bounded(value->type) &&
	    (*number != floor(*number) || *number < least || *number > most))
		return -EDOM;
	return 0;
}

static int read_value(struct txn *txn)
{
	struct sensor sensor = sensor_of(txn);
	int err = bridge_measure(txn, &sensor);

	return err ? err : take_result(&sensor, &txn->number[0]);
}

/* What was written is measured and has to be the same. */
static int write_value(struct txn *txn)
{
	struct visit *visit = txn_own(txn, struct visit);
	struct sensor sensor = sensor_of(txn);
	double want = txn->number[0], have;
	int err;

	if (!visit->written) {
		if (sensor.value->ranged &&
		    !(want >= sensor.value->low && want <= sensor.value->high))
			return -EINVAL;
		txn_void(txn);
		err = write_to_sensor(txn, &sensor, sensor.value->first, sensor.value->count, NULL,
		                      0);
		visit->written = !err;
		return err ? err : TXN_MORE;
	}
	err = bridge_measure(txn, &sensor);
	if (err)
		return err;
	return take_result(&sensor, &have) || have != want ? -EIO : 0;
}

/* --- Bridges as families --------------------------------------------------------------------- */

enum { WAY_VALUE = 1 };
static const struct property_how how[] = {[WAY_VALUE] = {.read = read_value, .write = write_value}};

static struct property *row_named(const struct sensor_bridge *bridge, const char *name)
{
	for (unsigned i = 0; i < bridge->family.count; i++)
		if (strcmp(bridge->properties[i].name, name) == 0)
			return &bridge->properties[i];
	return NULL;
}

static int bridge_add_row(struct sensor_bridge *bridge, const struct property *row)
{
	struct property *rows;

	/* one of the common name would hide what each device says of itself */
	if (row_named(bridge, row->name) ||
	    family_property(&family_common, NULL, row->name, strlen(row->name)))
		return -EEXIST;
	rows = realloc(bridge->properties, (bridge->family.count + 1u) * sizeof(*rows));
	if (!rows)
		return -ENOMEM;
	bridge->properties = rows;
	rows[bridge->family.count++] = *row;
	return 0;
}

static int add_value_row(struct sensor_bridge *bridge, const struct sensor_value *value,
                         int32_t arg, const char *prefix)
{
	struct property row = {
		.type = value->type,
		.life = LIFE_VOLATILE,
		.access = value->writable ? ACCESS_BOTH : ACCESS_READ,
		.how = WAY_VALUE,
		.arg = arg,
	};
	int n = snprintf(row.name, sizeof(row.name), "%s%s%s", prefix, *prefix ? "/" : "",
	                 value->name);

	return n < 0 || n >= (int)sizeof(row.name) ? -ENAMETOOLONG : bridge_add_row(bridge, &row);
}

int bridge_place(const struct sensor_table *table, struct sensor_bridge *bridge, unsigned kind,
                 uint8_t address, const char *prefix)
{
	const struct sensor_kind *of = &table->kinds[kind];
	struct sensor_chip *chips = realloc(bridge->chips,
	                                    (bridge->count + 1) * sizeof(*bridge->chips));
	struct property directory = {.type = PROPERTY_DIRECTORY, .life = LIFE_STATIC};
	int err = 0;

	if (!chips)
		return -ENOMEM;
	bridge->chips = chips;
	chips[bridge->count] = (struct sensor_chip){.kind = kind, .address = address};
	if (*prefix) {
		snprintf(directory.name, sizeof(directory.name), "%s", prefix);
		err = bridge_add_row(bridge, &directory);
	}
	for (unsigned i = 0; !err && i < of->values; i++)
		err = add_value_row(bridge, &table->values[of->first_value + i],
		                    (int32_t)(bridge->count << 8 | i), prefix);
	bridge->count++;
	return err;
}

static int compare_names_of_rows(const void *a, const void *b)
{
	const struct property *x = a, *y = b;

	return strcmp(x->name, y->name);
}

void bridges_finish(struct sensor_table *table)
{
	for (unsigned i = 0; i < table->bridge_count; i++) {
		struct sensor_bridge *bridge = &table->bridges[i];

		qsort(bridge->properties, bridge->family.count, sizeof(*bridge->properties),
		      compare_names_of_rows);
		bridge->family.code = bridge->rom[0];
		bridge->family.proof = PROOF_PRESENCE;
		bridge->family.type = bridge_type(bridge->rom[0]);
		bridge->family.properties = bridge->properties;
		bridge->family.how = how;
		bridge->family.how_count = sizeof(how) / sizeof(how[0]);
		bridge->table = table;
	}
}

const struct family *bridge_family(const struct sensor_table *table, const uint8_t rom[8])
{
	for (unsigned i = 0; i < table->bridge_count; i++)
		if (memcmp(table->bridges[i].rom, rom, 8) == 0)
			return &table->bridges[i].family;
	return NULL;
}
