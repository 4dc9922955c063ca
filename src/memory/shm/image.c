/* SPDX-License-Identifier: MIT */
/* The image as owsd lays it out and publishes into it. */
#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "src/memory/shm/image.h"
#include "src/memory/shm/word.h"
#include "src/public/ows.h"

#define IMAGE_MAX 0x7fffffffu
#define SAMPLE_WORDS (sizeof(struct ows_sample) / 4)
#define ATTRS_WORDS (sizeof(struct ows_attrs) / 4)

#define CHANGES_MIN 1024u

const struct image_meta image_no_meta = {
	.decimals = UINT32_MAX,
	.scale = 1,
	.min = NAN,
	.max = NAN,
	.limit_hh = NAN,
	.limit_h = NAN,
	.limit_l = NAN,
	.limit_ll = NAN,
};

/* The areas of the image, in the order of their kinds. */
struct image_areas {
	struct image_area {
		uint64_t size, count, off;
	} of[OWS_AREAS];
	uint64_t end;
};

static uint64_t align64(uint64_t offset)
{
	return (offset + 63) & ~(uint64_t)63;
}

static const struct image_meta *meta_of(const struct image_signal *signal)
{
	return signal->meta ? signal->meta : &image_no_meta;
}

static uint64_t string_bytes(const char *text)
{
	return text && *text ? strlen(text) + 1 : 0;
}

/* Most signals have their path, which then stands in the pool once. */
static bool has_identity(const struct image_signal *signal)
{
	return signal->identity && strcmp(signal->identity, signal->path) != 0;
}

static uint64_t pool_bytes(const struct image_plan *plan)
{
	uint64_t n = 2 + string_bytes(plan->served); /* 2: name and path of record 0 */

	for (uint32_t i = 0; i < plan->signal_count; i++) {
		const struct image_meta *meta = meta_of(&plan->signals[i]);

		n += strlen(plan->signals[i].name) + 1 + strlen(plan->signals[i].path) + 1;
		if (has_identity(&plan->signals[i]))
			n += strlen(plan->signals[i].identity) + 1;
		n += string_bytes(meta->unit) + string_bytes(meta->description) +
		     string_bytes(meta->family) + string_bytes(meta->device) +
		     string_bytes(meta->calibrated) + string_bytes(meta->points) +
		     string_bytes(meta->group);
	}
	return n;
}

static uint64_t text_bytes(const struct image_plan *plan)
{
	uint64_t n = 0;

	for (uint32_t i = 0; i < plan->signal_count; i++)
		n += 2 * (uint64_t)plan->signals[i].text_cap;
	return n;
}

/* A power of two that has room for each record four times. */
static uint64_t changes_of(uint64_t records)
{
	uint64_t n = CHANGES_MIN;

	while (n < 4 * records)
		n *= 2;
	return n;
}

/*
 * Areas that came later are left out of the directory while they are empty: such an image is that
 * of the first owsd of this major version, byte for byte.
 */
static uint32_t area_count(const struct image_areas *a)
{
	uint32_t count = OWS_AREAS - 1;

	while (count > OWS_AREA_CHANGES && a->of[count].count == 0)
		count--;
	return count;
}

static void find_areas(const struct image_plan *plan, struct image_areas *a)
{
	uint64_t records = (uint64_t)plan->signal_count + 1;

#define X(kind, type, member, n) \
	a->of[OWS_AREA_##kind] = (struct image_area){.size = sizeof(type), .count = (n)};
	IMAGE_AREAS(X)
#undef X
	a->end = align64(sizeof(struct ows_image_header) +
	                 area_count(a) * sizeof(struct ows_area_entry));
	for (unsigned kind = 1; kind < OWS_AREAS; kind++) {
		a->of[kind].off = a->end;
		a->end = align64(a->end + a->of[kind].size * a->of[kind].count);
	}
}

size_t image_size(const struct image_plan *plan)
{
	struct image_areas a;

	find_areas(plan, &a);
	return a.end <= IMAGE_MAX ? (size_t)a.end : 0;
}

static uint32_t add_string(char *base, uint64_t *pool, const char *text)
{
	size_t n = strlen(text) + 1;
	uint32_t off = (uint32_t)*pool;

	memcpy(base + off, text, n);
	*pool += n;
	return off;
}

/* The offset of a string that may be missing: 0 then. */
static uint32_t add_optional(char *base, uint64_t *pool, const char *text)
{
	return string_bytes(text) ? add_string(base, pool, text) : 0;
}

static int compare_names(const void *a, const void *b, void *base)
{
	const struct ows_name_entry *x = a, *y = b;

	return strcmp((const char *)base + x->name_off, (const char *)base + y->name_off);
}

static void fill_header(const struct image_plan *plan, const struct image_areas *a,
                        struct ows_image_header *h)
{
	*h = (struct ows_image_header){
		.magic = OWS_IMAGE_MAGIC,
		.major = OWS_LAYOUT_MAJOR,
		.minor = OWS_LAYOUT_MINOR,
		.size = (uint32_t)a->end,
		.generation = plan->generation,
		.state = OWS_STATE_BUILDING,
		.pid = plan->pid,
		.start_id = plan->start_id,
		.area_off = sizeof(*h),
		.area_count = area_count(a),
		.start_ns = plan->start_ns,
		.start_wall_ns = plan->start_wall_ns,
		.period_ns = plan->period_ns,
	};
}

static void *area_at(const struct image_areas *a, enum ows_area kind, char *base)
{
	return a->of[kind].count ? base + a->of[kind].off : NULL;
}

/* Areas lie one behind the other; readers find them by the directory alone. */
static void point_into(const struct image_plan *plan, const struct image_areas *a, char *base,
                       struct image *image)
{
	*image = (struct image){
		.header = (void *)base,
		.areas = (void *)(base + sizeof(struct ows_image_header)),
#define X(kind, type, member, n) .member = area_at(a, OWS_AREA_##kind, base),
		IMAGE_AREAS(X)
#undef X
			.record_count = plan->signal_count + 1,
		.target_count = plan->target_count,
		.counter_count = plan->counter_count,
		.change_count = (uint32_t)a->of[OWS_AREA_CHANGES].count,
		.device_count = plan->device_count,
		.log_lines = plan->log_lines,
		.base = base,
	};
	for (unsigned kind = 1; kind <= area_count(a); kind++)
		image->areas[kind - 1] = (struct ows_area_entry){
			.kind = kind,
			.off = (uint32_t)a->of[kind].off,
			.size = (uint32_t)a->of[kind].size,
			.count = (uint32_t)a->of[kind].count,
		};
}

static void fill_info(const struct image_signal *s, char *base, uint64_t *pool,
                      struct ows_info_entry *info)
{
	const struct image_meta *meta = meta_of(s);
	bool scaled = meta->scale != 1 || meta->offset != 0 || string_bytes(meta->points);

	*info = (struct ows_info_entry){
		.name_off = add_string(base, pool, s->name),
		.per_factor = s->per_factor,
		.line = s->line,
		.stale_after_ns = s->stale_after_ns,
		.init_value = s->init_value,
		.safe_value = s->safe_value,
		.flags = (s->has_init ? OWS_INFO_INIT : 0u) | (s->has_safe ? OWS_INFO_SAFE : 0u) |
	                 (s->starts_last ? OWS_INFO_LAST : 0u) | (scaled ? OWS_INFO_SCALED : 0u) |
	                 (s->confirm ? OWS_INFO_CONFIRM : 0u),
		.decimals = meta->decimals,
		.scale = meta->scale,
		.offset = meta->offset,
		.min = meta->min,
		.max = meta->max,
		.limit_hh = meta->limit_hh,
		.limit_h = meta->limit_h,
		.limit_l = meta->limit_l,
		.limit_ll = meta->limit_ll,
		.filter_s = meta->filter_s,
		.deadband = meta->deadband,
	};
	info->path_off = add_string(base, pool, s->path);
	info->identity_off = has_identity(s) ? add_string(base, pool, s->identity) : info->path_off;
	info->unit_off = add_optional(base, pool, meta->unit);
	info->description_off = add_optional(base, pool, meta->description);
	info->family_off = add_optional(base, pool, meta->family);
	info->device_off = add_optional(base, pool, meta->device);
	info->calibrated_off = add_optional(base, pool, meta->calibrated);
	info->points_off = add_optional(base, pool, meta->points);
	info->group_off = add_optional(base, pool, meta->group);
}

/* Fill records, infos and names, and with them the pool. */
static void fill_signals(const struct image_plan *plan, const struct image_areas *a,
                         struct image *image)
{
	static const struct image_signal itself = {.name = "", .path = ""};
	uint64_t pool = a->of[OWS_AREA_POOL].off, text = a->of[OWS_AREA_TEXTS].off;

	image->records[0].type = OWS_LARGE;
	fill_info(&itself, image->base, &pool, &image->infos[0]);
	image->names[0].name_off = image->infos[0].name_off;
	image->header->served_off = add_optional(image->base, &pool, plan->served);
	for (uint32_t i = 0; i < plan->signal_count; i++) {
		const struct image_signal *s = &plan->signals[i];
		struct ows_record *r = &image->records[i + 1];

		assert(s->text_cap % 4 == 0);
		r->type = s->type;
		r->flags = s->flags;
		r->text_cap = s->text_cap;
		r->text_off = s->text_cap != 0 ? (uint32_t)text : 0;
		text += 2 * (uint64_t)s->text_cap;
		fill_info(s, image->base, &pool, &image->infos[i + 1]);
		image->names[i + 1].name_off = image->infos[i + 1].name_off;
		image->names[i + 1].record = i + 1;
	}
	qsort_r(image->names, image->record_count, sizeof(*image->names), compare_names,
	        image->base);
}

void image_build(const struct image_plan *plan, void *memory, struct image *image)
{
	struct image_areas a;

	find_areas(plan, &a);
	assert(a.end <= IMAGE_MAX);
	point_into(plan, &a, memory, image);
	fill_header(plan, &a, image->header);
	fill_signals(plan, &a, image);
	for (uint32_t i = 0; i < plan->target_count; i++) {
		snprintf(image->targets[i].name, sizeof(image->targets[i].name), "%s",
		         plan->targets[i]);
		image->targets[i].group = plan->groups ? plan->groups[i] : i;
	}
	for (uint32_t i = 0; i < plan->counter_count; i++) {
		snprintf(image->counters[i].name, sizeof(image->counters[i].name), "%s",
		         plan->counters[i].name);
		image->counters[i].target = plan->counters[i].target;
	}
	for (uint32_t i = 0; i < plan->device_count; i++) {
		const struct ows_info_entry *info = &image->infos[plan->devices[i] + 1];

		image->devices[i].id_off = info->device_off;
		image->devices[i].family_off = info->family_off;
		image->devices[i].target = UINT32_MAX;
	}
}

void image_publish(struct image *image, uint32_t record, const struct ows_sample *sample,
                   const struct ows_attrs *attrs, const char *text)
{
	struct ows_record *r = &image->records[record];
	uint32_t n = word_get(&r->seq) / 2 + 1;
	struct ows_slot *slot = &r->slot[n & 1];
	struct ows_slot whole = {.sample = *sample, .attrs = *attrs};

	assert(record < image->record_count);
	assert(sample->len <= r->text_cap);
	whole.sample.check = ows_check((const void *)&whole.sample, SAMPLE_WORDS - 1);
	whole.attrs.check = ows_check((const void *)&whole.attrs, ATTRS_WORDS - 1);
	/* A reader of this number copies the slot before: its words must be visible by now */
	__atomic_store_n(&r->seq, 2 * n - 1, __ATOMIC_RELEASE);
	word_fence(__ATOMIC_RELEASE);
	words_store(slot, &whole, SAMPLE_WORDS + ATTRS_WORDS);
	if (sample->len != 0)
		words_store_text(image->base + r->text_off + (size_t)(n & 1) * r->text_cap, text,
		                 sample->len);
	__atomic_store_n(&r->seq, 2 * n, __ATOMIC_RELEASE);
}

void image_change(struct image *image, uint32_t record)
{
	uint32_t number = word_get(&image->header->change_head);
	struct ows_change_entry *entry = &image->changes[number & (image->change_count - 1)];

	assert(record < image->record_count);
	/* A reader that sees a word of this entry sees the head before it too */
	word_fence(__ATOMIC_RELEASE);
	word_set(&entry->record, record);
	__atomic_store_n(&entry->number, number, __ATOMIC_RELEASE);
	__atomic_store_n(&image->header->change_head, number + 1, __ATOMIC_RELEASE);
}

void image_target(struct image *image, uint32_t target, uint32_t state, uint32_t reconnects)
{
	assert(target < image->target_count);
	word_set(&image->targets[target].state, state);
	word_set(&image->targets[target].reconnects, reconnects);
}

void image_moves(struct image *image, uint32_t target, uint32_t moves)
{
	assert(target < image->target_count);
	word_set(&image->targets[target].moves, moves);
}

void image_counter(struct image *image, uint32_t counter, uint64_t total)
{
	assert(counter < image->counter_count);
	word_set(&image->counters[counter].low, (uint32_t)total);
	word_set(&image->counters[counter].high, (uint32_t)(total >> 32));
}

void image_news(struct image *image)
{
	__atomic_fetch_add(&image->header->news, 1, __ATOMIC_RELEASE);
}

void image_awake(struct image *image, bool awake)
{
	__atomic_store_n(&image->header->awake, awake ? 1 : 0, __ATOMIC_SEQ_CST);
	word_fence(__ATOMIC_SEQ_CST);
}

void image_state(struct image *image, enum ows_state state)
{
	__atomic_store_n(&image->header->state, (uint32_t)state, __ATOMIC_SEQ_CST);
	image_news(image);
}

void image_retire(void *old, size_t old_size)
{
	struct ows_image_header *h = old;

	if (old_size < sizeof(*h) || word_get(&h->magic) != OWS_IMAGE_MAGIC)
		return;
	__atomic_store_n(&h->state, (uint32_t)OWS_STATE_RETIRED, __ATOMIC_SEQ_CST);
	__atomic_fetch_add(&h->news, 1, __ATOMIC_RELEASE);
}
