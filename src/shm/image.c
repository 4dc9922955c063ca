/* SPDX-License-Identifier: MIT */
/* The image as owsd lays it out and publishes into it. */
#include <assert.h>
#include <string.h>

#include "src/libows/ows.h"
#include "src/shm/image.h"
#include "src/shm/word.h"

#define IMAGE_MAX 0x7fffffffu
#define SAMPLE_WORDS (sizeof(struct ows_sample) / 4)
#define ATTRS_WORDS (sizeof(struct ows_attrs) / 4)
#define ALARM_WORDS (sizeof(struct ows_alarm_entry) / 4)

/* The offsets of the areas of the segment, in their order. */
struct image_areas {
	uint64_t record, info, name, target, counter, alarm, text, pool, end;
};

static uint64_t align64(uint64_t offset)
{
	return (offset + 63) & ~(uint64_t)63;
}

static uint64_t pool_bytes(const struct image_plan *plan)
{
	uint64_t n = 1; /* name and path of record 0 are the empty string */

	for (uint32_t i = 0; i < plan->signal_count; i++)
		n += strlen(plan->signals[i].name) + 1 + strlen(plan->signals[i].path) + 1;
	if (plan->served)
		n += strlen(plan->served) + 1;
	return n;
}

static uint64_t text_bytes(const struct image_plan *plan)
{
	uint64_t n = 0;

	for (uint32_t i = 0; i < plan->signal_count; i++)
		n += 2 * (uint64_t)plan->signals[i].text_cap;
	return n;
}

static void find_areas(const struct image_plan *plan, struct image_areas *a)
{
	uint64_t records = (uint64_t)plan->signal_count + 1;

	a->record = sizeof(struct ows_image_header);
	a->info = a->record + records * sizeof(struct ows_record);
	a->name = a->info + records * sizeof(struct ows_info_entry);
	a->target = align64(a->name + records * sizeof(struct ows_name_entry));
	a->counter = a->target + (uint64_t)plan->target_count * sizeof(struct ows_target_entry);
	a->alarm = a->counter + (uint64_t)plan->counter_count * sizeof(struct ows_counter_entry);
	a->text = a->alarm + OWS_ALARMS * sizeof(struct ows_alarm_entry);
	a->pool = align64(a->text + text_bytes(plan));
	a->end = align64(a->pool + pool_bytes(plan));
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

static void copy_name(char *to, size_t size, const char *from)
{
	size_t n = strlen(from);

	if (n >= size)
		n = size - 1;
	memcpy(to, from, n);
	to[n] = '\0';
}

static bool name_before(const char *base, const struct ows_name_entry *a,
                        const struct ows_name_entry *b)
{
	return strcmp(base + a->name_off, base + b->name_off) < 0;
}

static void sift_down(const char *base, struct ows_name_entry *heap, uint32_t i, uint32_t n)
{
	for (;;) {
		uint32_t child = 2 * i + 1;
		struct ows_name_entry entry = heap[i];

		if (child >= n)
			return;
		if (child + 1 < n && name_before(base, &heap[child], &heap[child + 1]))
			child++;
		if (!name_before(base, &entry, &heap[child]))
			return;
		heap[i] = heap[child];
		heap[child] = entry;
		i = child;
	}
}

/* Heap sort: the comparison needs base to find the strings, and qsort() passes no context. */
static void sort_names(const char *base, struct ows_name_entry *names, uint32_t n)
{
	for (uint32_t i = n / 2; i-- > 0;)
		sift_down(base, names, i, n);
	for (uint32_t last = n; last-- > 1;) {
		struct ows_name_entry entry = names[0];

		names[0] = names[last];
		names[last] = entry;
		sift_down(base, names, 0, last);
	}
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
		.start_ns = plan->start_ns,
		.start_wall_ns = plan->start_wall_ns,
		.period_ns = plan->period_ns,
		.record_off = (uint32_t)a->record,
		.record_size = sizeof(struct ows_record),
		.record_count = plan->signal_count + 1,
		.info_off = (uint32_t)a->info,
		.info_size = sizeof(struct ows_info_entry),
		.name_off = (uint32_t)a->name,
		.target_off = (uint32_t)a->target,
		.target_size = sizeof(struct ows_target_entry),
		.target_count = plan->target_count,
		.counter_off = (uint32_t)a->counter,
		.counter_size = sizeof(struct ows_counter_entry),
		.counter_count = plan->counter_count,
		.alarm_off = (uint32_t)a->alarm,
		.alarm_size = sizeof(struct ows_alarm_entry),
		.alarm_count = OWS_ALARMS,
		.pool_off = (uint32_t)a->pool,
		.pool_size = (uint32_t)(a->end - a->pool),
		.text_off = (uint32_t)a->text,
		.text_size = (uint32_t)text_bytes(plan),
	};
}

void image_build(const struct image_plan *plan, void *memory, struct image *image)
{
	struct image_areas a;
	struct ows_info_entry *infos;
	struct ows_name_entry *names;
	uint64_t pool, text;

	find_areas(plan, &a);
	assert(a.end <= IMAGE_MAX);
	image->base = memory;
	image->header = memory;
	image->records = (void *)(image->base + a.record);
	image->targets = (void *)(image->base + a.target);
	image->counters = (void *)(image->base + a.counter);
	image->alarms = (void *)(image->base + a.alarm);
	infos = (void *)(image->base + a.info);
	names = (void *)(image->base + a.name);
	fill_header(plan, &a, image->header);

	pool = a.pool;
	text = a.text;
	add_string(image->base, &pool, "");
	if (plan->served)
		image->header->served_off = add_string(image->base, &pool, plan->served);
	image->records[0].type = OWS_LARGE;
	infos[0].name_off = infos[0].path_off = names[0].name_off = (uint32_t)a.pool;
	for (uint32_t i = 0; i < plan->signal_count; i++) {
		const struct image_signal *s = &plan->signals[i];
		struct ows_record *r = &image->records[i + 1];
		struct ows_info_entry *info = &infos[i + 1];

		assert(s->text_cap % 4 == 0);
		r->type = s->type;
		r->flags = s->flags;
		r->text_cap = s->text_cap;
		r->text_off = s->text_cap != 0 ? (uint32_t)text : 0;
		text += 2 * (uint64_t)s->text_cap;
		info->name_off = add_string(image->base, &pool, s->name);
		info->path_off = add_string(image->base, &pool, s->path);
		info->per_factor = s->per_factor;
		info->line = s->line;
		info->stale_after_ns = s->stale_after_ns;
		info->init_value = s->init_value;
		info->safe_value = s->safe_value;
		info->flags = (s->has_init ? OWS_INFO_INIT : 0u) |
		              (s->has_safe ? OWS_INFO_SAFE : 0u);
		names[i + 1].name_off = info->name_off;
		names[i + 1].record = i + 1;
	}
	sort_names(image->base, names, plan->signal_count + 1);
	for (uint32_t i = 0; i < plan->target_count; i++) {
		copy_name(image->targets[i].name, sizeof(image->targets[i].name), plan->targets[i]);
		image->targets[i].group = plan->groups ? plan->groups[i] : i;
	}
	for (uint32_t i = 0; i < plan->counter_count; i++) {
		copy_name(image->counters[i].name, sizeof(image->counters[i].name),
		          plan->counters[i].name);
		image->counters[i].target = plan->counters[i].target;
	}
}

static void store_text(char *to, const char *from, uint32_t len)
{
	uint32_t word;

	for (uint32_t i = 0; i < len; i += 4) {
		word = 0;
		memcpy(&word, from + i, len - i < 4 ? len - i : 4);
		words_store(to + i, &word, 1);
	}
}

void image_publish(struct image *image, uint32_t record, const struct ows_sample *sample,
                   const struct ows_attrs *attrs, const char *text)
{
	struct ows_record *r = &image->records[record];
	uint32_t n = word_get(&r->seq) / 2 + 1;
	struct ows_slot *slot = &r->slot[n & 1];
	struct ows_slot whole = {.sample = *sample, .attrs = *attrs};

	assert(record < image->header->record_count);
	assert(sample->len <= r->text_cap);
	whole.sample.check = ows_check((const void *)&whole.sample, SAMPLE_WORDS - 1);
	whole.attrs.check = ows_check((const void *)&whole.attrs, ATTRS_WORDS - 1);
	/* A reader of this number copies the slot before, whose words must be visible by now */
	__atomic_store_n(&r->seq, 2 * n - 1, __ATOMIC_RELEASE);
	word_fence(__ATOMIC_RELEASE);
	words_store(slot, &whole, SAMPLE_WORDS + ATTRS_WORDS);
	if (sample->len != 0)
		store_text(image->base + r->text_off + (size_t)(n & 1) * r->text_cap, text,
		           sample->len);
	__atomic_store_n(&r->seq, 2 * n, __ATOMIC_RELEASE);
}

/* Write all of an entry but its seq, by which a reader notices the change. */
static void write_alarm(struct ows_alarm_entry *to, struct ows_alarm_entry *entry)
{
	uint32_t seq = word_get(&to->seq);

	entry->check = ows_check(&entry->record, ALARM_WORDS - 2);
	word_set(&to->seq, seq + 1);
	word_fence(__ATOMIC_RELEASE);
	words_store(&to->record, &entry->record, ALARM_WORDS - 1);
	__atomic_store_n(&to->seq, seq + 2, __ATOMIC_RELEASE);
}

uint32_t image_alarm(struct image *image, const struct ows_alarm_entry *entry)
{
	struct ows_alarm_entry whole = *entry;
	uint32_t number = word_get(&image->header->alarm_head);

	assert(entry->record < image->header->record_count);
	whole.number = number;
	write_alarm(&image->alarms[number % OWS_ALARMS], &whole);
	__atomic_store_n(&image->header->alarm_head, number + 1, __ATOMIC_RELEASE);
	return number;
}

void image_alarm_after(struct image *image, uint32_t number, int64_t after)
{
	struct ows_alarm_entry *entry = &image->alarms[number % OWS_ALARMS], whole = *entry;

	if (word_get(&image->header->alarm_head) - 1 - number >= OWS_ALARMS)
		return;
	whole.after = after;
	whole.flags |= OWS_ALARM_AFTER;
	write_alarm(entry, &whole);
}

void image_carry_alarms(struct image *image, const struct image *before, const uint32_t *records)
{
	uint32_t head = word_get(&before->header->alarm_head);

	for (uint32_t n = head > OWS_ALARMS ? head - OWS_ALARMS : 0; n != head; n++) {
		struct ows_alarm_entry entry = before->alarms[n % OWS_ALARMS];

		if (entry.number != n || !entry.record || records[entry.record - 1] == UINT32_MAX)
			continue;
		entry.record = records[entry.record - 1] + 1;
		write_alarm(&image->alarms[n % OWS_ALARMS], &entry);
	}
	word_set(&image->header->alarm_head, head);
}

void image_target(struct image *image, uint32_t target, uint32_t state, uint32_t reconnects)
{
	assert(target < image->header->target_count);
	word_set(&image->targets[target].state, state);
	word_set(&image->targets[target].reconnects, reconnects);
}

void image_moves(struct image *image, uint32_t target, uint32_t moves)
{
	assert(target < image->header->target_count);
	word_set(&image->targets[target].moves, moves);
}

void image_counter(struct image *image, uint32_t counter, uint64_t total)
{
	assert(counter < image->header->counter_count);
	word_set(&image->counters[counter].low, (uint32_t)total);
	word_set(&image->counters[counter].high, (uint32_t)(total >> 32));
}

void image_news(struct image *image)
{
	__atomic_fetch_add(&image->header->news, 1, __ATOMIC_RELEASE);
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
