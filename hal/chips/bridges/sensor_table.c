/* SPDX-License-Identifier: MIT */
/* Reads a table of sensors: line by line, each a word and what belongs to it. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "hal/chips/bridges/bridge.h"
#include "hal/chips/bridges/sensor_reader.h"
#include "hal/chips/bridges/sensor_table.h"
#include "hal/owfs/path.h"

#define BRIDGES_MAX 64
#define PLACES_MAX 32
#define KIND_VALUES 200   /* the number of one is a byte (bridge.c) */
#define KIND_STEPS 255    /* likewise */
#define WAIT_MAX_MS 10000 /* of one line, and of all of a sensor */

/* One more element of a growing list: list is the address of its pointer. NULL: no memory. */
static void *grow_list(void *list, unsigned *count, size_t size)
{
	void *base;
	char *bigger;

	memcpy(&base, list, sizeof(base));
	bigger = realloc(base, (*count + 1) * size);
	if (!bigger)
		return NULL;
	memcpy(list, &bigger, sizeof(bigger));
	memset(bigger + *count * size, 0, size);
	return bigger + (*count)++ * size;
}

static bool has_bit(const uint32_t *bits, unsigned at)
{
	return bits[at / 32] >> at % 32 & 1;
}

/* --- Steps ----------------------------------------------------------------------------------- */

static struct sensor_step *sensor_table_step(struct sensor_reader *r, enum sensor_step_kind kind)
{
	struct sensor_table *table = r->table;
	struct sensor_step *step = grow_list(&table->steps, &table->step_count, sizeof(*step));

	if (step) {
		step->kind = (uint8_t)kind;
		reader_kind(r)->steps++;
	}
	return step;
}

/* Bytes up to the end or the word "read": each a number, or a formula in parentheses. */
static int take_written_bytes(struct sensor_reader *r, bool set, unsigned *first, unsigned *count)
{
	struct sensor_table *table = r->table;
	int err = 0;

	*first = table->byte_count;
	while (!err && !reader_ended(r) && strncmp(r->at, "read", 4) != 0) {
		struct formula *byte = grow_list(&table->bytes, &table->byte_count, sizeof(*byte));

		if (!byte)
			return -ENOMEM;
		if (*r->at != '(' && (*r->at < '0' || *r->at > '9'))
			return reader_fail(r, "expected a byte at \"%.24s\"", r->at);
		err = reader_formula(r, set, byte);
		if (!err && !formula_is_byte(&table->pool, *byte))
			err = reader_fail(r, "a byte that is not from 0 to 255");
	}
	*count = table->byte_count - *first;
	if (!err && (*count == 0 || *count > SENSOR_AT_ONCE))
		return reader_fail(r, "expected 1 to %d bytes to write", SENSOR_AT_ONCE);
	return err;
}

/* Room for n more bytes that are read. */
static int bytes_read(struct sensor_reader *r, struct sensor_step *to, bool lone)
{
	struct sensor_kind *kind = reader_kind(r);
	unsigned n;
	int err = reader_whole(r, 1, SENSOR_AT_ONCE, &n);

	if (err)
		return err;
	if (kind->bytes + n > SENSOR_BYTES)
		return reader_fail(r, "a sensor that reads more than %d bytes", SENSOR_BYTES);
	to->at = kind->bytes;
	to->n = (uint8_t)n;
	for (unsigned i = 0; lone && i < n; i++)
		r->lone[(kind->bytes + i) / 32] |= UINT32_C(1) << (kind->bytes + i) % 32;
	kind->bytes = (uint8_t)(kind->bytes + n);
	return 0;
}

static int read_write(struct sensor_reader *r)
{
	struct sensor_step *to = sensor_table_step(r, SENSOR_WRITE);
	unsigned first = 0, count = 0;
	int err = to ? take_written_bytes(r, false, &first, &count) : -ENOMEM;

	if (err)
		return err;
	to->first = first;
	to->count = count;
	if (!reader_take(r, "read"))
		return 0;
	to->kind = SENSOR_EXCHANGE;
	err = bytes_read(r, to, false);
	return err || count + to->n <= SENSOR_EXCHANGED
	               ? err
	               : reader_fail(r, "more than %d bytes written and read", SENSOR_EXCHANGED);
}

static int read_read(struct sensor_reader *r)
{
	struct sensor_step *to = sensor_table_step(r, SENSOR_READ);

	return to ? bytes_read(r, to, true) : -ENOMEM;
}

static int read_wait(struct sensor_reader *r)
{
	struct sensor_step *to = sensor_table_step(r, SENSOR_WAIT);
	double number;
	char *end;

	reader_skip(r);
	number = strtod(r->at, &end);
	if (!to)
		return -ENOMEM;
	if (end == r->at || strncmp(end, "ms", 2) != 0 || !strchr(" \t", end[2]) ||
	    !(number > 0 && number <= WAIT_MAX_MS))
		return reader_fail(r, "expected a time as 8.3ms, at most %d ms, at \"%.24s\"",
		                   WAIT_MAX_MS, r->at);
	to->wait_ns = (int64_t)(number * TXN_MS);
	r->wait_ns += to->wait_ns;
	if (r->wait_ns > WAIT_MAX_MS * TXN_MS)
		return reader_fail(r, "a sensor that waits for more than %d ms in all",
		                   WAIT_MAX_MS);
	r->at = end + 2;
	return 0;
}

static int read_crc8(struct sensor_reader *r)
{
	struct sensor_step *to = sensor_table_step(r, SENSOR_CRC8);
	unsigned at, n, polynomial = 0x31, start = 0xff;
	int err = to ? reader_whole(r, 0, SENSOR_BYTES - 1, &at) : -ENOMEM;

	if (!err)
		err = reader_whole(r, 1, SENSOR_BYTES - 1, &n);
	if (!err && !reader_ended(r))
		err = reader_whole(r, 1, 255, &polynomial);
	if (!err && !reader_ended(r))
		err = reader_whole(r, 0, 255, &start);
	if (err)
		return err;
	if (at + n + 1 > reader_kind(r)->bytes)
		return reader_fail(r, "bytes that are not read before");
	to->at = (uint8_t)at;
	to->n = (uint8_t)n;
	to->polynomial = (uint8_t)polynomial;
	to->start = (uint8_t)start;
	for (unsigned i = at; i <= at + n; i++)
		r->checked[i / 32] |= UINT32_C(1) << i % 32;
	return 0;
}

static int read_check(struct sensor_reader *r)
{
	struct sensor_step *to;
	struct formula a, b;
	int err;

	if (reader_take(r, "crc8"))
		return read_crc8(r);
	err = reader_formula(r, false, &a);
	if (!err)
		err = reader_equals(r);
	if (!err)
		err = reader_formula(r, false, &b);
	to = err ? NULL : sensor_table_step(r, SENSOR_SAME);
	if (!to)
		return err ? err : -ENOMEM;
	to->a = a;
	to->b = b;
	return 0;
}

static int read_let(struct sensor_reader *r)
{
	struct sensor_kind *kind = reader_kind(r);
	struct sensor_step *to = sensor_table_step(r, SENSOR_LET);
	char text[FORMULA_NAME];
	int err = to ? reader_name(r, text) : -ENOMEM;

	if (!err && kind->name_count == SENSOR_NAMES)
		return reader_fail(r, "more than %d names", SENSOR_NAMES);
	if (!err)
		err = reader_equals(r);
	if (!err)
		err = reader_formula(r, false, &to->a);
	for (unsigned i = 0; !err && i < kind->name_count; i++)
		if (strcmp(kind->names[i], text) == 0)
			err = reader_fail(r, "there is a name %s already", text);
	if (err)
		return err;
	to->name = (uint8_t)kind->name_count;
	memcpy(kind->names[kind->name_count++], text, sizeof(text));
	return 0;
}

/* --- Values ---------------------------------------------------------------------------------- */

static struct sensor_value *value_named(struct sensor_reader *r, const char *text)
{
	const struct sensor_kind *kind = reader_kind(r);

	for (unsigned i = 0; i < kind->values; i++) {
		struct sensor_value *value = &r->table->values[kind->first_value + i];

		if (strcmp(value->name, text) == 0)
			return value;
	}
	return NULL;
}

static uint8_t take_type(struct sensor_reader *r)
{
	static const struct {
		const char *word;
		uint8_t type;
	} types[] = {{"float", PROPERTY_FLOAT},       {"temperature", PROPERTY_TEMPERATURE},
	             {"pressure", PROPERTY_PRESSURE}, {"unsigned", PROPERTY_UNSIGNED},
	             {"integer", PROPERTY_INTEGER},   {"yesno", PROPERTY_YESNO}};

	for (unsigned i = 0; i < sizeof(types) / sizeof(types[0]); i++)
		if (reader_take(r, types[i].word))
			return types[i].type;
	return PROPERTY_FLOAT;
}

/* The rest of a range beyond what the type can have could never be a value. */
static int check_range(struct sensor_reader *r, const struct sensor_value *value)
{
	double least, most;

	if (!bridge_bounded(value->type))
		return 0;
	bridge_bounds(value->type, &least, &most);
	return value->low >= least && value->high <= most
	               ? 0
	               : reader_fail(r, "a range beyond that of the type, %.0f to %.0f", least,
	                             most);
}

static int read_value(struct sensor_reader *r)
{
	struct sensor_table *table = r->table;
	struct sensor_value *value, found = {0};
	int err = reader_name(r, found.name);

	if (!err && reader_kind(r)->values == KIND_VALUES)
		return reader_fail(r, "a sensor has %d values at most", KIND_VALUES);
	if (!err && value_named(r, found.name))
		return reader_fail(r, "there is a value %s already", found.name);
	found.type = take_type(r);
	if (!err)
		err = reader_equals(r);
	if (!err)
		err = reader_formula(r, false, &found.formula);
	found.ranged = !err && reader_take(r, "range");
	if (found.ranged) {
		err = reader_range(r, &found.low, &found.high);
		err = err ? err : check_range(r, &found);
	} else if (!err && !bridge_bounded(found.type)) /* these bounds are the author's */
		err = reader_fail(r,
		                  "value %s has no range: add range LOW to HIGH, what the "
		                  "sensor can mean",
		                  found.name);
	value = err ? NULL : grow_list(&table->values, &table->value_count, sizeof(*value));
	if (!value)
		return err ? err : -ENOMEM;
	*value = found;
	reader_kind(r)->values++;
	return 0;
}

static int read_set(struct sensor_reader *r)
{
	char text[FORMULA_NAME];
	struct sensor_value *value;
	int err = reader_name(r, text);

	if (err)
		return err;
	value = value_named(r, text);
	if (!value)
		return reader_fail(r, "expected a value %s before this: what is set is read back",
		                   text);
	value->writable = true;
	return reader_take(r, "write") ? take_written_bytes(r, true, &value->first, &value->count)
	                               : reader_fail(r, "expected write at \"%.24s\"", r->at);
}

/* --- Kinds and chips ------------------------------------------------------------------------- */

/* What the kind that ends here lacks. */
static int end_kind(struct sensor_reader *r)
{
	const struct sensor_kind *kind = r->table->kind_count ? reader_kind(r) : NULL;

	if (!kind)
		return 0;
	if (kind->values == 0)
		return reader_fail(r, "sensor %s of line %u has no value", kind->name, kind->line);
	if (kind->bytes == 0)
		return reader_fail(r, "sensor %s of line %u reads nothing", kind->name, kind->line);
	if (kind->steps > KIND_STEPS)
		return reader_fail(r, "sensor %s of line %u: more than %d lines to do", kind->name,
		                   kind->line, KIND_STEPS);
	for (unsigned i = 0; i < kind->bytes; i++)
		if (has_bit(r->lone, i) && !has_bit(r->checked, i))
			return reader_fail(
				r,
				"sensor %s of line %u: byte %u is read without a register and "
				"has no checksum: it cannot be proved",
				kind->name, kind->line, i);
	return 0;
}

/* NULL: there is none of this name. */
static const struct sensor_kind *kind_named(const struct sensor_table *table, const char *text)
{
	const struct sensor_kind *kind = table->kinds;

	for (unsigned i = 0; kind && i < table->kind_count; i++, kind++)
		if (strcmp(kind->name, text) == 0)
			return kind;
	return NULL;
}

static int read_sensor(struct sensor_reader *r)
{
	struct sensor_table *table = r->table;
	const struct sensor_kind *before;
	struct sensor_kind *kind;
	char text[FORMULA_NAME];
	int err = end_kind(r);

	if (!err && table->bridge_count)
		err = reader_fail(r, "a sensor below the first at");
	if (!err)
		err = reader_name(r, text);
	before = err ? NULL : kind_named(table, text);
	if (before)
		err = reader_fail(r, "there is a sensor %s already, in line %u", text,
		                  before->line);
	kind = err ? NULL : grow_list(&table->kinds, &table->kind_count, sizeof(*kind));
	if (!kind)
		return err ? err : -ENOMEM;
	memcpy(kind->name, text, sizeof(text));
	kind->line = r->line;
	kind->first_step = table->step_count;
	kind->first_value = table->value_count;
	memset(r->checked, 0, sizeof(r->checked));
	memset(r->lone, 0, sizeof(r->lone));
	r->wait_ns = 0;
	return 0;
}

static int read_rom(struct sensor_reader *r, uint8_t rom[8])
{
	size_t n;

	reader_skip(r);
	n = strcspn(r->at, " \t");
	if (rom_parse(r->at, n, rom) || !bridge_type(rom[0]))
		return reader_fail(
			r, "expected the id of a bridge, as 19.0000000000E1, at \"%.24s\"", r->at);
	r->at += n;
	return 0;
}

/* at 19.0000000000E1 sht4x 0x44 as air */
static int read_at(struct sensor_reader *r)
{
	struct sensor_table *table = r->table;
	struct sensor_bridge *bridge = NULL;
	char text[FORMULA_NAME], prefix[FORMULA_NAME] = "";
	const struct sensor_kind *kind;
	unsigned address = 0;
	uint8_t rom[8];
	int err = table->bridge_count ? 0 : end_kind(r);

	if (!err)
		err = read_rom(r, rom);
	if (!err)
		err = reader_name(r, text);
	kind = err ? NULL : kind_named(table, text);
	if (!err && !kind)
		err = reader_fail(r, "no sensor %s stands above", text);
	if (!err)
		err = reader_whole(r, 0x08, 0x77, &address);
	if (!err && reader_take(r, "as"))
		err = reader_name(r, prefix);
	if (err)
		return err;
	for (unsigned i = 0; i < table->bridge_count; i++)
		if (memcmp(table->bridges[i].rom, rom, 8) == 0)
			bridge = &table->bridges[i];
	if (!bridge) {
		if (table->bridge_count == BRIDGES_MAX)
			return reader_fail(r, "more than %d bridges", BRIDGES_MAX);
		bridge = grow_list(&table->bridges, &table->bridge_count, sizeof(*bridge));
		if (!bridge)
			return -ENOMEM;
		memcpy(bridge->rom, rom, 8);
	}
	err = bridge->count == PLACES_MAX
	              ? reader_fail(r, "more than %d sensors behind a bridge", PLACES_MAX)
	              : bridge_place(table, bridge, (unsigned)(kind - table->kinds),
	                             (uint8_t)address, prefix);
	return err == -EEXIST
	               ? reader_fail(r, "the bridge has a property of this name already: give the "
	                                "sensor another (as)")
	       : err == -ENAMETOOLONG ? reader_fail(r, "a name that is too long")
	                              : err;
}

static int read_statement(struct sensor_reader *r)
{
	static const struct {
		const char *word;
		int (*read)(struct sensor_reader *r);
		bool in_kind;
	} statements[] = {{"sensor", read_sensor, false}, {"at", read_at, false},
	                  {"write", read_write, true},    {"read", read_read, true},
	                  {"wait", read_wait, true},      {"check", read_check, true},
	                  {"let", read_let, true},        {"value", read_value, true},
	                  {"set", read_set, true}};
	int err;

	for (unsigned i = 0; i < sizeof(statements) / sizeof(statements[0]); i++) {
		if (!reader_take(r, statements[i].word))
			continue;
		if (statements[i].in_kind && (!r->table->kind_count || r->table->bridge_count))
			return reader_fail(r, "%s stands in no sensor", statements[i].word);
		err = statements[i].read(r);
		return err || reader_ended(r) ? err : reader_fail(r, "unexpected \"%.24s\"", r->at);
	}
	return reader_fail(r, "expected sensor, write, read, wait, check, let, value, set or at");
}

int sensor_table_parse(struct sensor_table *table, const char *file, const char *text, char *why,
                       size_t why_size)
{
	struct sensor_reader r = {.table = table, .name = file, .why = why, .why_size = why_size};
	int err = 0;

	char line[SENSOR_LINE];

	while (!err && *text) {
		err = reader_line(&r, &text, line);
		if (!err && !reader_ended(&r))
			err = read_statement(&r);
	}
	if (!err && !table->bridge_count)
		err = end_kind(&r);
	if (!err)
		bridges_finish(table);
	return !err || err == -ENOMEM ? err : -EINVAL;
}

void sensor_table_free(struct sensor_table *table)
{
	for (unsigned i = 0; i < table->bridge_count; i++) {
		free(table->bridges[i].properties);
		free(table->bridges[i].chips);
	}
	free(table->bridges);
	free(table->kinds);
	free(table->values);
	free(table->steps);
	free(table->bytes);
	free(table->pool.ops);
	*table = (struct sensor_table){0};
}
