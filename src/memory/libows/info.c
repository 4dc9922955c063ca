/* SPDX-License-Identifier: MIT */
/*
 * What libows returns about signals, targets, devices, counters and the daemon itself. All of it is
 * in the image. What owsd changes while it runs is read by reader_entry() or word by word; the rest
 * stays as it is until the next generation.
 */
#include <errno.h>
#include <string.h>

#include "src/memory/libows/alive.h"
#include "src/memory/libows/handle.h"
#include "src/memory/libows/map.h"
#include "src/memory/shm/reader.h"

int ows_count(const struct ows *h)
{
	return (int)h->map.count - 1;
}

/* More than a double has: an image that says so would cost its readers seconds. */
#define DECIMALS_MOST 99

int ows_info(const struct ows *h, int signal, struct ows_info *info)
{
	const struct ows_info_entry *entry;
	const struct ows_record *record;

	if (signal < 0 || signal >= ows_count(h))
		return -ENOENT;
	entry = map_info(&h->map, (uint32_t)signal + 1);
	record = map_record(&h->map, (uint32_t)signal + 1);
	*info = (struct ows_info){
		.name = map_name(&h->map, (uint32_t)signal + 1),
		.path = map_string(&h->map, entry->path_off),
		.type = record->type,
		.output = (record->flags & OWS_RECORD_OUTPUT) != 0,
		.fresh = (record->flags & OWS_RECORD_FRESH) != 0,
		.alarm = (record->flags & OWS_RECORD_ALARM) != 0,
		.per_factor = entry->per_factor,
		.stale_after_ns = entry->stale_after_ns,
		.unit = map_string(&h->map, entry->unit_off),
		.description = map_string(&h->map, entry->description_off),
		.family = map_string(&h->map, entry->family_off),
		.device = map_string(&h->map, entry->device_off),
		.group = map_string(&h->map, entry->group_off),
		.calibrated = map_string(&h->map, entry->calibrated_off),
		.points = map_string(&h->map, entry->points_off),
		.scale = entry->scale,
		.offset = entry->offset,
		.min = entry->min,
		.max = entry->max,
		.limit_hh = entry->limit_hh,
		.limit_h = entry->limit_h,
		.limit_l = entry->limit_l,
		.limit_ll = entry->limit_ll,
		.filter_s = entry->filter_s,
		.deadband = entry->deadband,
		.decimals = entry->decimals <= DECIMALS_MOST ? (int32_t)entry->decimals : -1,
		.confirm = (entry->flags & OWS_INFO_CONFIRM) != 0,
		.identity = map_string(&h->map,
	                               entry->identity_off ? entry->identity_off : entry->path_off),
	};
	return 0;
}

int ows_daemon(struct ows *h, int64_t now_ns, struct ows_daemon *daemon)
{
	const struct ows_image_header *image = h->map.image;
	struct ows_sample beat;
	int err = alive_look(h, now_ns);
	bool alive = handle_alive(h, now_ns);

	if (!reader_sample(map_record(&h->map, 0), &beat))
		return -EAGAIN;
	*daemon = (struct ows_daemon){
		.pid = image->pid,
		.state = word_get(&image->state),
		.generation = image->generation,
		.start_ns = image->start_ns,
		.beat_age_ns = handle_age(now_ns, beat.measured_ns),
		.period_ns = image->period_ns,
		.alive = !err && alive,
	};
	return err;
}

const char *ows_served(const struct ows *h)
{
	uint32_t off = h->map.image->served_off;

	return off ? map_string(&h->map, off) : NULL;
}

int ows_target(struct ows *h, int index, struct ows_target *target)
{
	const struct ows_target_entry *entry;

	if (index < 0 || (uint32_t)index >= map_count(&h->map, OWS_AREA_TARGETS))
		return -ENOENT;
	entry = map_target(&h->map, (uint32_t)index);
	*target = (struct ows_target){
		.name = entry->name,
		.state = word_get(&entry->state),
		.reconnects = word_get(&entry->reconnects),
		.group = entry->group,
		.moves = word_get(&entry->moves),
	};
	return 0;
}

int ows_counter(struct ows *h, int index, struct ows_counter *counter)
{
	const struct ows_counter_entry *entry;

	if (index < 0 || (uint32_t)index >= map_count(&h->map, OWS_AREA_COUNTERS))
		return -ENOENT;
	entry = map_counter(&h->map, (uint32_t)index);
	*counter = (struct ows_counter){
		.name = entry->name,
		.target = (int)(int32_t)entry->target,
		.value = (uint64_t)word_get(&entry->high) << 32 | word_get(&entry->low),
	};
	return 0;
}

int ows_device(struct ows *h, int index, struct ows_device *device)
{
	struct ows_device_entry e;

	*device = (struct ows_device){.target = -1};
	if (index < 0 || (uint32_t)index >= map_count(&h->map, OWS_AREA_DEVICES))
		return -ENOENT;
	if (!reader_entry(map_entry(&h->map, OWS_AREA_DEVICES, (uint32_t)index), &e, sizeof(e)))
		return -EIO;
	*device = (struct ows_device){
		.id = map_string(&h->map, e.id_off),
		.family = map_string(&h->map, e.family_off),
		.target = e.target < map_count(&h->map, OWS_AREA_TARGETS) ? (int)e.target : -1,
		.power = e.power <= OWS_POWER_EXTERNAL ? e.power : OWS_POWER_UNKNOWN,
		.answers = e.answers,
		.errors = e.errors,
		.retries = e.retries,
		.wire_us = e.wire_us,
		.ok_ns = e.ok_ns,
		.wire = e.wire,
	};
	memcpy(device->identity, e.identity, sizeof(device->identity));
	device->identity[sizeof(device->identity) - 1] = '\0';
	return 0;
}

/* The line at this place of an area; number 0: none was written. */
static int placed_line(struct ows *h, enum ows_area area, uint32_t place, struct ows_log_line *line)
{
	struct ows_log_entry e;

	if (place >= map_count(&h->map, area))
		return -ENOENT;
	if (!reader_entry(map_entry(&h->map, area, place), &e, sizeof(e)))
		return -EIO;
	if (!e.number)
		return -ENOENT;
	*line = (struct ows_log_line){.number = e.number, .level = e.level, .time_ns = e.time_ns};
	memcpy(line->text, e.text, sizeof(line->text) - 1);
	return 0;
}

uint32_t ows_log_last(struct ows *h)
{
	uint32_t last = 0;
	struct ows_log_line line;

	for (uint32_t i = 0; i < map_count(&h->map, OWS_AREA_LOG); i++)
		if (placed_line(h, OWS_AREA_LOG, i, &line) == 0 && line.number > last)
			last = line.number;
	return last;
}

int ows_log_line(struct ows *h, uint32_t number, struct ows_log_line *line)
{
	uint32_t count = map_count(&h->map, OWS_AREA_LOG);
	struct ows_log_line there;
	int err = count ? placed_line(h, OWS_AREA_LOG, number % count, &there) : -ENOENT;

	if (err)
		return err;
	if (there.number != number)
		return -ENOENT;
	*line = there;
	return 0;
}

int ows_refused_reload(struct ows *h, struct ows_log_line *line)
{
	return placed_line(h, OWS_AREA_REFUSED, 0, line);
}

int ows_target_note(struct ows *h, int index, struct ows_log_line *line)
{
	int err = index < 0 ? -ENOENT : placed_line(h, OWS_AREA_NOTES, (uint32_t)index, line);

	return err || *line->text ? err : -ENOENT;
}

const char *ows_quality_text(uint8_t quality)
{
	static const struct {
		uint8_t quality;
		const char *text;
	} texts[] = {
#define QUALITY(code, health, word, cause, remedy) {OWS_Q_##code, word},
#define ERROR(err, word, remedy)
#define ALARM(kind, event, word, cause, remedy)
#include "src/ground/signal/words_list.h"
#undef ALARM
#undef ERROR
#undef QUALITY
	};

	for (size_t i = 0; i < sizeof(texts) / sizeof(texts[0]); i++)
		if (texts[i].quality == quality)
			return texts[i].text;
	if (ows_good(quality))
		return "good";
	return (quality & 0xc0) == 0x40 ? "uncertain" : "bad";
}
