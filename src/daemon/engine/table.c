/* SPDX-License-Identifier: MIT */
/* The signal table: a row for each item, and what a row says of itself. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/chips/facts.h"
#include "hal/owfs/path.h"
#include "src/daemon/engine/table.h"

/* What identifies a device: the ROM id, or the alias. */
struct device_key {
	uint8_t rom[8];
	bool has_rom;
	const char *alias;
	size_t alias_len;
	uint32_t row;
};

static int compare_keys(const void *a, const void *b)
{
	const struct device_key *x = a, *y = b;
	size_t shorter;
	int order;

	if (x->has_rom != y->has_rom)
		return x->has_rom ? -1 : 1;
	if (x->has_rom)
		return memcmp(x->rom, y->rom, sizeof(x->rom));
	shorter = x->alias_len < y->alias_len ? x->alias_len : y->alias_len;
	order = memcmp(x->alias, y->alias, shorter);
	return order ? order : (x->alias_len > y->alias_len) - (x->alias_len < y->alias_len);
}

static int order_keys(const void *a, const void *b)
{
	const struct device_key *x = a, *y = b;
	int order = compare_keys(a, b);

	return order ? order : (x->row > y->row) - (x->row < y->row);
}

/* The rows that have a device, by devices; *n gets their count. NULL: no memory. */
static struct device_key *keys_of(const struct config *config, uint32_t *n)
{
	struct device_key *keys = calloc((size_t)config->item_count + 1, sizeof(*keys));

	*n = 0;
	for (uint32_t row = 0; keys && row < config->item_count; row++) {
		const char *text = config->items[row].path;
		struct device_key *key = &keys[*n];
		struct path path;

		if (path_split(text, strlen(text), &path) || !path.device.len)
			continue;
		key->has_rom = path.has_rom;
		memcpy(key->rom, path.rom, sizeof(key->rom));
		key->alias = path.last.text;
		key->alias_len = path.last.len;
		key->row = row;
		(*n)++;
	}
	if (keys)
		qsort(keys, *n, sizeof(*keys), order_keys);
	return keys;
}

int table_image_devices(const struct config *config, uint32_t *first)
{
	uint32_t n;
	struct device_key *keys = keys_of(config, &n);
	int count = 0;

	if (!keys)
		return -ENOMEM;
	for (uint32_t i = 0; i < n && keys[i].has_rom; i++)
		if (i == 0 || compare_keys(&keys[i - 1], &keys[i]) != 0)
			first[count++] = keys[i].row;
	free(keys);
	return count;
}

/*
 * Group the rows by device: what an answer says of a device reaches all of its signals without a
 * search of the table. The rows without a device are a group of their own, the last.
 */
static int find_devices(struct table *table, const struct config *config)
{
	struct device *rest;
	uint32_t n;
	struct device_key *keys = keys_of(config, &n);

	if (!keys)
		return -ENOMEM;
	for (uint32_t row = 0; row < table->count; row++)
		table->signals[row].device = TABLE_NO_DEVICE;
	for (uint32_t i = 0; i < n; i++) {
		struct device *d;

		if (i == 0 || compare_keys(&keys[i - 1], &keys[i]) != 0) {
			d = &table->devices[table->device_count++];
			d->has_rom = keys[i].has_rom;
			memcpy(d->rom, keys[i].rom, sizeof(d->rom));
			d->signals = &table->device_signals[i];
			table->rom_count += d->has_rom;
		}
		d = &table->devices[table->device_count - 1];
		d->count++;
		table->device_signals[i] = &table->signals[keys[i].row];
		table->signals[keys[i].row].device = table->device_count - 1;
	}
	rest = &table->devices[table->device_count];
	rest->signals = &table->device_signals[n];
	for (uint32_t row = 0; row < table->count; row++)
		if (!signal_has_device(&table->signals[row]))
			rest->signals[rest->count++] = &table->signals[row];
	free(keys);
	return 0;
}

static void init_signal(struct signal *s, const struct config_item *item, uint32_t row)
{
	s->item = item;
	s->record = row + 1;
	s->sample.quality = OWS_Q_INITIAL;
	s->sample.target = 255; /* none has answered yet */
	s->attrs.flags = (item->readable ? OWS_ATTR_READ_ENABLE : 0) |
	                 (item->writable ? OWS_ATTR_WRITE_ENABLE : 0) |
	                 (item->limits.any ? OWS_ATTR_LIMITS : 0);
	s->shows_device = facts_shows_device(item->path);
	s->command.controller = CONTROLLER_NOBODY;
	if (!item->has_init)
		return;
	s->sample.value = item->init_value;
	if (item->type == OWS_STRING) {
		size_t len = strlen(item->init_text);

		if (len > TABLE_TEXT_CAP)
			len = TABLE_TEXT_CAP;
		memcpy(s->text, item->init_text, len);
		s->sample.len = (uint32_t)len;
	}
}

int signal_table_init(struct table *table, const struct config *config)
{
	uint32_t strings = 0;
	char *text;

	*table = (struct table){.count = config->item_count};
	for (uint32_t row = 0; row < table->count; row++)
		strings += config->items[row].type == OWS_STRING;
	table->signals = calloc((size_t)table->count + 1, sizeof(*table->signals));
	table->devices = calloc((size_t)table->count + 1, sizeof(*table->devices));
	table->device_signals = calloc((size_t)table->count + 1, sizeof(*table->device_signals));
	table->texts = calloc((size_t)strings * 3 + 1, TABLE_TEXT_CAP);
	if (!table->signals || !table->devices || !table->device_signals || !table->texts ||
	    find_devices(table, config)) {
		signal_table_free(table);
		return -ENOMEM;
	}
	text = table->texts;
	for (uint32_t row = 0; row < table->count; row++) {
		struct signal *s = &table->signals[row];

		if (config->items[row].type == OWS_STRING) {
			s->text = text;
			s->command_text = text + TABLE_TEXT_CAP;
			s->written_text = text + 2 * TABLE_TEXT_CAP;
			text += 3 * TABLE_TEXT_CAP;
		}
		init_signal(s, &config->items[row], row);
	}
	return 0;
}

void signal_table_free(struct table *table)
{
	free(table->signals);
	free(table->devices);
	free(table->device_signals);
	free(table->texts);
	*table = (struct table){0};
}

static double limit_of(const struct config_limits *limits, enum config_limit limit)
{
	return limits->has[limit] ? limits->limit[limit] : (double)NAN;
}

/* The digits that a person wants of it, in the unit of the item. */
static int decimals_of(const struct config_item *item, struct quantity quantity)
{
	if (item->converted) {
		double factor = fabs(item->scale.factor);
		int fewer = (int)floor(log10(factor));

		if (quantity.decimals >= 0)
			quantity.decimals = quantity.decimals > fewer ? quantity.decimals - fewer
			                                              : 0;
		quantity.most *= factor;
		quantity.unit = item->unit;
	}
	return quantity_decimals(&quantity);
}

/*
 * What a chip measures has a unit and decimals by its data sheet, until it is scaled otherwise than
 * to another unit.
 */
void signal_table_meta(const struct config_item *item, struct image_meta *meta)
{
	const struct scale *scale = &item->scale;
	struct quantity quantity;
	bool known = item->type != OWS_STRING && (!scale_changes(scale) || item->converted) &&
	             quantity_of(item->path, &quantity);
	int decimals = item->has_decimals ? (int)item->decimals
	               : known            ? decimals_of(item, quantity)
	               : item->unit       ? unit_decimals(item->unit)
	                                  : -1;

	*meta = (struct image_meta){
		.unit = item->unit ? item->unit
	                : known    ? quantity.unit
	                           : NULL,
		.description = item->description,
		.group = item->group,
		.family = item->family,
		.device = item->device,
		.calibrated = item->calibrated,
		.points = item->points,
		.decimals = (uint32_t)decimals,
		.scale = scale->linear ? scale->factor : 1,
		.offset = scale->linear ? scale->offset : 0,
		.min = scale->has_min ? scale->min : (double)NAN,
		.max = scale->has_max ? scale->max : (double)NAN,
		.limit_hh = limit_of(&item->limits, CONFIG_LIMIT_HH),
		.limit_h = limit_of(&item->limits, CONFIG_LIMIT_H),
		.limit_l = limit_of(&item->limits, CONFIG_LIMIT_L),
		.limit_ll = limit_of(&item->limits, CONFIG_LIMIT_LL),
		.filter_s = item->filter_s,
		.deadband = item->deadband,
	};
}

void signal_table_image(const struct config_item *item, struct image_signal *signal)
{
	*signal = (struct image_signal){
		.name = item->name,
		.path = item->path,
		.identity = item->identity,
		.type = (uint8_t)item->type,
		.flags = (uint8_t)((item->output ? OWS_RECORD_OUTPUT : 0) |
	                           (item->fresh ? OWS_RECORD_FRESH : 0) |
	                           (item->alarm ? OWS_RECORD_ALARM : 0) |
	                           (config_item_takes_sets(item) ? 0 : OWS_RECORD_NO_SET)),
		.text_cap = item->type == OWS_STRING ? TABLE_TEXT_CAP : 0,
		.per_factor = item->per_factor,
		.line = (uint32_t)item->line,
		.stale_after_ns = item->stale_after_ns,
		.has_init = item->has_init,
		.has_safe = item->has_safe,
		.starts_last = item->starts_last,
		.confirm = item->confirm,
		.init_value = item->init_value,
		.safe_value = item->safe_value,
	};
}

void signal_hold(struct signal *s)
{
	if (s->read.held)
		return;
	s->read.held = true;
	s->read.held_quality = s->sample.quality;
	s->read.held_err = s->sample.err;
}

void signal_lapse(struct signal *s)
{
	if (s->read.held && !signal_reads(s)) {
		s->sample.quality = s->read.held_quality;
		s->sample.err = s->read.held_err;
	}
	s->read.held = false;
	if (s->sample.quality & 0xc0)
		s->sample.quality = OWS_Q_LAST_USABLE;
	else if (s->sample.quality != OWS_Q_INITIAL)
		return;
	s->sample.err = 0;
}

static bool command_differs(const struct signal *s)
{
	if (!s->command.confirmed || s->command.forced)
		return true;
	if (signal_is_string(s))
		return s->command.len != s->command.written_len ||
		       memcmp(s->command_text, s->written_text, s->command.len) != 0;
	return s->command.value != s->command.written;
}

bool signal_changed(const struct signal *s)
{
	return s->command.given && !s->command.awaited &&
	       (s->command.one_shot || (signal_writes(s) && command_differs(s)));
}

bool signal_settled(const struct signal *s)
{
	return s->command.given && !s->command.awaited && signal_writes(s) && !s->writing &&
	       !signal_changed(s);
}

bool signal_is_read(const struct signal *s)
{
	/* what was never written, or is to be written, need not be compared */
	return signal_reads(s) || s->read.once ||
	       (s->item->read_back_ns && s->sample.count && !signal_changed(s));
}

bool signal_lapses(const struct signal *s)
{
	return !signal_reads(s) && !s->item->output && !s->command.confirmed &&
	       ows_good(s->sample.quality);
}

int64_t signal_stale_at(const struct signal *s)
{
	int64_t since = s->sample.measured_ns ? s->sample.measured_ns : s->read.known_ns;

	return s->item->stale_after_ns ? since + s->item->stale_after_ns + 1 : INT64_MAX;
}

void signal_begin(struct signal *s, uint64_t period)
{
	s->attrs.pend_base = (uint32_t)period;
	s->attrs.flags |= OWS_ATTR_IN_WORK;
}

void signal_end(struct signal *s, uint64_t period, uint64_t begun)
{
	uint32_t waited = (uint32_t)(period - begun);

	s->attrs.pend_last = waited;
	if (waited > s->attrs.pend_max)
		s->attrs.pend_max = waited;
	if (!s->reading && !s->writing && !s->alarming)
		s->attrs.flags &= ~(uint32_t)OWS_ATTR_IN_WORK;
}

void signal_update(struct signal *s, uint64_t period, int64_t measured_ns, int64_t now_ns)
{
	uint32_t waited = (uint32_t)period - s->attrs.per_base;
	int64_t age = now_ns - (s->sample.count ? s->sample.measured_ns : s->read.known_ns);

	if (waited > s->attrs.per_max)
		s->attrs.per_max = waited;
	if (age > s->attrs.age_max_ns)
		s->attrs.age_max_ns = age;
	if (s->sample.count)
		s->attrs.update_ns = now_ns - s->read.updated_ns;
	s->read.updated_ns = now_ns;
	s->attrs.per_base = (uint32_t)period;
	s->sample.measured_ns = measured_ns;
	s->sample.count++;
}

struct ows_journal_entry signal_entry(const struct signal *s, enum ows_alarm_kind kind,
                                      enum ows_alarm_event event, int64_t now_ns)
{
	return (struct ows_journal_entry){
		.record = s->record,
		.occurred_ns = now_ns,
		.kind = (uint8_t)kind,
		.event = (uint8_t)event,
		.quality = s->sample.quality,
	};
}

void signal_reset_diagnostics(struct signal *s, uint64_t period, int64_t now_ns)
{
	s->attrs.transactions = 0;
	s->attrs.pend_last = 0;
	s->attrs.per_max = (uint32_t)period - s->attrs.per_base;
	s->attrs.pend_max = s->attrs.flags & OWS_ATTR_IN_WORK
	                            ? (uint32_t)period - s->attrs.pend_base
	                            : 0;
	s->attrs.age_max_ns = now_ns - (s->sample.count ? s->sample.measured_ns : s->read.known_ns);
}

static int compare_rom(const void *rom, const void *device)
{
	return memcmp(rom, ((const struct device *)device)->rom, ROM_LEN);
}

uint32_t table_device(const struct table *table, const uint8_t rom[8])
{
	const struct device *d = bsearch(rom, table->devices, table->rom_count, sizeof(*d),
	                                 compare_rom);

	return d ? (uint32_t)(d - table->devices) : TABLE_NO_DEVICE;
}
