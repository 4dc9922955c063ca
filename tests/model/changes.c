/* SPDX-License-Identifier: MIT */
/* The ring of changes: the code of src/memory/shm/image.c and src/memory/libows/changes.c. */
#include <assert.h>
#include <errno.h>
#include <limits.h>
#include <string.h>

#include "src/memory/libows/handle.h"
#include "src/memory/shm/futex.h"
#include "src/memory/shm/image.h"
#include "src/memory/shm/reader.h"
#include "tests/model/suites.h"

#define RING 4
#define ENTERED 6 /* changes, so that the ring goes round */
#define SIGNALS ENTERED
#define FIRST (UINT32_MAX - 1) /* their numbers wrap */

static _Alignas(64) char memory[1 << 18];
static struct image image;
static struct ows handle;
static struct ows_cursor begin;
static uint32_t marks[1];
static uint32_t name; /* stands for the file's name: 1 leads to the next image */

static void make_image(void)
{
	static struct image_signal signals[SIGNALS];
	const struct image_plan plan = {.signals = signals, .signal_count = SIGNALS};

	for (int i = 0; i < SIGNALS; i++)
		signals[i] = (struct image_signal){
			.name = &"abcdefgh"[7 - i], .path = "/x", .type = OWS_LARGE};
	assert(image_size(&plan) <= sizeof(memory));
	memset(memory, 0, sizeof(memory));
	image_build(&plan, memory, &image);
	image.change_count = RING;
	image_state(&image, OWS_STATE_LIVE);
	image.header->news = 0;
	image.header->change_head = FIRST;
	handle = (struct ows){
		.map = {.image = image.header, .base = memory, .count = SIGNALS + 1},
		.join = {.connection = -1, .bell = -1, .news = -1},
		.dead_after_ns = INT64_MAX,
		.marks = marks,
		.mark_words = 1,
	};
	marks[0] = name = 0;
	handle.map.areas[OWS_AREA_RECORDS] = (struct map_area){.base = (const char *)image.records,
	                                                       .size = sizeof(*image.records)};
	handle.map.areas[OWS_AREA_CHANGES] = (struct map_area){
		.base = (const char *)image.changes, .size = sizeof(*image.changes), .count = RING};
}

/* The cursor at FIRST, as after the look at all of the beginning. */
static void begin_at_first(void)
{
	int signal;

	begin = (struct ows_cursor){0};
	ows_changes(&handle, &begin, &signal, 1, 0);
}

static void setup_ring(void)
{
	static const char *const names[] = {"place 0", "place 1", "place 2", "place 3"};

	make_image();
	begin_at_first();
	explore_keep(marks, sizeof(marks));
	explore_track("head", &image.header->change_head, 4);
	for (int i = 0; i < RING; i++)
		explore_track(names[i], &image.changes[i].record, 4);
}

static void setup_numbers(void)
{
	setup_ring();
	for (int i = 0; i < RING; i++) {
		image.changes[i].number = FIRST - RING;
		explore_track("number", &image.changes[i].number, 4);
	}
}

/* Change number FIRST + i is of record i + 1: each number has another. */
static void enter_all(void)
{
	for (uint32_t i = 0; i < ENTERED; i++) {
		explore_forget(i);
		image_change(&image, i + 1);
	}
}

/* What was given is what lies between the two numbers. */
static void judge(uint32_t from, uint32_t before, const int *signals, int got)
{
	if ((uint32_t)got != before - from)
		explore_fail("%d of the %u changes from %u on", got, before - from, from - FIRST);
	for (int i = 0; i < got; i++)
		if ((uint32_t)signals[i] != from - FIRST + (uint32_t)i)
			explore_fail("change %u is of signal %d", from - FIRST + (uint32_t)i,
			             signals[i]);
}

static void follow(int calls, int room)
{
	struct ows_cursor cursor = begin;

	for (int i = 0; i < calls; i++) {
		uint32_t from = cursor.number;
		int signals[RING], got;

		got = ows_changes(&handle, &cursor, signals, room, 0);
		if (got != -EOVERFLOW)
			judge(from, cursor.number, signals, got);
		explore_forget((uint64_t)cursor.number << 8 | (unsigned)i);
	}
}

static void follow_all(void)
{
	follow(2, RING);
}

static void follow_by_one(void)
{
	follow(3, 1);
}

/* --- With the rows, and asleep ---------------------------------------------------------------- */

#define UPDATES 2

static void setup_rows(void)
{
	make_image();
	begin_at_first();
	explore_keep(marks, sizeof(marks));
	explore_track("head", &image.header->change_head, 4);
	for (int i = 0; i < UPDATES; i++)
		explore_track(i ? "place of change 1" : "place of change 0",
		              &image.changes[(FIRST + (uint32_t)i) & (RING - 1)].record, 4);
	for (int i = 0; i < 2; i++)
		explore_track(i ? "slot 1, value" : "slot 0, value", &image.records[1].slot[i], 4);
	explore_track("seq", &image.records[1].seq, 4);
	explore_track("news", &image.header->news, 4);
	explore_track("state", &image.header->state, 4);
	explore_track("name", &name, 4);
}

static void wake_readers(void)
{
	segment_wake(&image.header->news, INT_MAX);
}

/* As the engine and its thread do. */
static void publish_and_enter(void)
{
	for (uint32_t n = 1; n <= UPDATES; n++) {
		struct ows_sample sample = {.value = n};
		struct ows_attrs attrs = {0};

		explore_forget(n);
		image_publish(&image, 1, &sample, &attrs, NULL);
		image_change(&image, 1);
		image_news(&image);
		wake_readers();
	}
	explore_forget(0);
	word_set(&name, 1);
	image_state(&image, OWS_STATE_RETIRED);
	wake_readers();
}

/* The row is as new as the changes that the cursor has passed. */
static void judge_row(uint32_t number)
{
	struct ows_sample sample;

	if (!reader_sample(&image.records[1], &sample))
		explore_fail("gave up");
	if (sample.value < number - FIRST)
		explore_fail("change %u, and the row is of update %u", number - FIRST,
		             (unsigned)sample.value);
}

static void wait_for_changes(void)
{
	struct ows_cursor cursor = begin;
	int signals[UPDATES], got;

	while ((got = ows_changes(&handle, &cursor, signals, UPDATES, -1)) != -ESTALE) {
		if (got != 1 || signals[0] != 0)
			explore_fail("%d signals, the first is %d", got, signals[0]);
		judge_row(cursor.number);
		explore_forget(cursor.number);
	}
	if (word_get(&name) != 1)
		explore_fail("retired, and the new image is not there");
}

static void look_at_all(void)
{
	struct ows_cursor cursor = {0};
	int signal;

	if (ows_changes(&handle, &cursor, &signal, 1, 0) == -EOVERFLOW)
		judge_row(cursor.number);
}

static void nobody_sleeps(void)
{
	if (explore_asleep(1))
		explore_fail("asleep, and nobody will wake him");
}

/* --- Wrong on purpose ------------------------------------------------------------------------- */

/* Copied entries are not judged by the head once more. */
static void follow_unchecked(void)
{
	uint32_t head = __atomic_load_n(&image.header->change_head, __ATOMIC_ACQUIRE);

	if (head - FIRST >= RING)
		return;
	for (uint32_t n = FIRST; n != head; n++) {
		uint32_t record = word_get(&image.changes[n & (RING - 1)].record);

		if (record != n - FIRST + 1)
			explore_fail("change %u is of record %u", n - FIRST, record);
	}
}

/* An entry of the number that is wanted is believed. */
static void follow_by_number(void)
{
	uint32_t head = __atomic_load_n(&image.header->change_head, __ATOMIC_ACQUIRE);

	for (uint32_t n = FIRST; n != head; n++) {
		const struct ows_change_entry *entry = &image.changes[n & (RING - 1)];
		uint32_t record = word_get(&entry->record);

		if (word_get(&entry->number) == n && record != n - FIRST + 1)
			explore_fail("change %u is of record %u", n - FIRST, record);
	}
}

/* --- */

const struct scenario change_scenarios[] = {
	{"changes: a ring that goes round under its reader",
         setup_ring,
         2,
         {enter_all, follow_all},
         .end = NULL},
	{"changes: one by one", setup_ring, 2, {enter_all, follow_by_one}, .end = NULL},
	{"changes: what is given is there, nobody sleeps on",
         setup_rows,
         2,
         {publish_and_enter, wait_for_changes},
         .end = nobody_sleeps},
	{"changes: all is looked at, and is new",
         setup_rows,
         2,
         {publish_and_enter, look_at_all},
         .end = NULL},
	{NULL},
};

const struct scenario wrong_changes[] = {
	{"a reader of changes that does not look at the head again",
         setup_ring,
         2,
         {enter_all, follow_unchecked},
         .end = NULL},
	{"a reader of changes that goes by their numbers alone",
         setup_numbers,
         2,
         {enter_all, follow_by_number},
         .end = NULL},
	{NULL},
};
