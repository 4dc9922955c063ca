/* SPDX-License-Identifier: MIT */
/*
 * owsd publishes, consumers read: the code of src/memory/shm/image.c, src/memory/shm/reader.h,
 * src/memory/libows.
 */
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>

#include "src/memory/libows/handle.h"
#include "src/memory/shm/entries.h"
#include "src/memory/shm/futex.h"
#include "src/memory/shm/reader.h"
#include "tests/model/suites.h"

#define SAMPLE_WORDS 12
#define WORDS 32
#define UPDATES 5      /* the last state; the first is there before the threads */
#define SECOND_LIFE 16 /* added to the state's number by a writer that follows a killed one */
#define TEXT 8

static _Alignas(64) char memory[262144];
static struct image image;
static struct ows handle;
/* The words of each state: no word is the same in two of them. */
static uint32_t content[2 * SECOND_LIFE][WORDS];
static bool text_of_one_length;
/* Two words of a slot stand for all: what is torn differs in two. */
static unsigned word_a, word_b = WORDS - 1;
static uint32_t flag;
static uint32_t name; /* stands for the file's name: 1 leads to the next image */

static void fill_contents(void)
{
	for (uint32_t n = 0; n < 2 * SECOND_LIFE; n++) {
		for (uint32_t i = 0; i < WORDS; i++)
			content[n][i] = (i + 1) << 8 | n;
		content[n][10] = text_of_one_length ? TEXT : n % SECOND_LIFE;
		content[n][11] = ows_check(content[n], SAMPLE_WORDS - 1);
		content[n][WORDS - 1] = ows_check(&content[n][SAMPLE_WORDS],
		                                  WORDS - SAMPLE_WORDS - 1);
	}
}

static void publish(uint32_t n)
{
	struct ows_sample sample;
	struct ows_attrs attrs;
	uint32_t text[2] = {n, n};

	memcpy(&sample, content[n], sizeof(sample));
	memcpy(&attrs, &content[n][SAMPLE_WORDS], sizeof(attrs));
	image_publish(&image, 1, &sample, &attrs, (const char *)text);
}

static struct map_area area_of(const void *base, size_t size, uint32_t count)
{
	return (struct map_area){.base = base, .size = (uint32_t)size, .count = count};
}

static void make_image(void)
{
	static const struct image_signal signals[] = {{"text", "/x", OWS_STRING, .text_cap = TEXT}};
	static const struct image_plan plan = {.signals = signals, .signal_count = 1};

	fill_contents();
	memset(memory, 0, sizeof(memory));
	image_build(&plan, memory, &image);
	image_state(&image, OWS_STATE_LIVE);
	image.header->news = 0;
	publish(1);
	handle = (struct ows){
		.map =
			{
				.image = image.header,
				.base = memory,
				.count = 2,
			},
		.join = {.connection = -1, .bell = -1, .news = -1},
		.dead_after_ns = INT64_MAX,
	};
	handle.map.areas[OWS_AREA_RECORDS] = area_of(image.records, sizeof(*image.records), 2);
	handle.map.areas[OWS_AREA_ALARMS] = area_of(image.alarms, sizeof(*image.alarms),
	                                            OWS_JOURNAL);
	flag = name = 0;
	explore_track("seq", &image.records[1].seq, 4);
}

static void track_words(void)
{
	for (int i = 0; i < 2; i++) {
		uint32_t *slot = (void *)&image.records[1].slot[i];

		explore_track(i ? "slot 1, word a" : "slot 0, word a", &slot[word_a], 4);
		explore_track(i ? "slot 1, word b" : "slot 0, word b", &slot[word_b], 4);
	}
}

static void setup(void)
{
	text_of_one_length = false;
	make_image();
	track_words();
}

static void setup_with_flag(void)
{
	setup();
	explore_track("flag", &flag, 4);
}

static void publish_from(uint32_t n, uint32_t last, uint32_t life)
{
	for (; n <= last; n++) {
		explore_forget(n);
		publish(n + life);
	}
}

static void write_all(void)
{
	publish_from(2, UPDATES, 0);
}

static void write_few(void)
{
	publish_from(2, 3, 0);
}

/* In the memory of one who was killed; owsd makes a new image, where no reader is yet. */
static void write_after(void)
{
	publish_from(word_get(&image.records[1].seq) / 2 + 1, UPDATES, SECOND_LIFE);
}

/* A reload: one thread has built and filled the image, another goes on. */
static void write_and_hand_over(void)
{
	publish(2);
	__atomic_store_n(&flag, 1, __ATOMIC_RELEASE);
}

static void write_what_was_handed_over(void)
{
	if (__atomic_load_n(&flag, __ATOMIC_ACQUIRE) == 1)
		publish_from(3, 4, 0);
}

/* Which state a word is of, UINT32_MAX: of none. */
static uint32_t state_of(unsigned word, uint32_t value)
{
	for (uint32_t n = 0; n < 2 * SECOND_LIFE; n++)
		if (content[n][word] == value)
			return n;
	return UINT32_MAX;
}

/* The state that a copy is of, at least the one before. */
static uint32_t judge(const void *slot, uint32_t last)
{
	const uint32_t *words = slot;
	uint32_t a = state_of(word_a, words[word_a]), b = state_of(word_b, words[word_b]);

	if (a != b)
		explore_fail("torn: word %u is of state %u, word %u of state %u", word_a, a, word_b,
		             b);
	if (a % SECOND_LIFE < last % SECOND_LIFE)
		explore_fail("back from state %u to state %u", last, a);
	return a;
}

/* A round fails only if the writer published in it. */
static void judge_rounds(unsigned loads_of_a_round)
{
	unsigned rounds = explore_loads() / loads_of_a_round;

	if (rounds > UPDATES - 1)
		explore_fail("%u rounds", rounds);
}

static void read_slots(int reads)
{
	uint32_t last = 0;

	for (int i = 0; i < reads; i++) {
		struct ows_slot slot;

		if (!reader_slot(&image.records[1], &slot))
			explore_fail("gave up");
		last = judge(&slot, last);
		judge_rounds(4);
		explore_forget((uint64_t)last << 8 | (unsigned)i);
	}
}

static void read_once(void)
{
	read_slots(1);
}

static void read_twice(void)
{
	read_slots(2);
}

/* --- Texts ------------------------------------------------------------------------------------ */

static void setup_text(void)
{
	text_of_one_length = true;
	word_a = word_b = 0;
	make_image();
	for (int i = 0; i < 2; i++) {
		uint32_t *text = (void *)(memory + image.records[1].text_off + i * TEXT);

		explore_track(i ? "slot 1, value" : "slot 0, value", &image.records[1].slot[i], 4);
		explore_track(i ? "text 1, word 0" : "text 0, word 0", &text[0], 4);
		explore_track(i ? "text 1, word 1" : "text 0, word 1", &text[1], 4);
	}
}

static void read_text(void)
{
	struct ows_sample sample;
	char text[TEXT + 1];
	uint32_t n, words[2];

	if (!reader_text(memory, &image.records[1], &sample, text, sizeof(text)))
		explore_fail("gave up");
	n = judge(&sample, 0);
	memcpy(words, text, sizeof(words));
	if (words[0] != n || words[1] != n)
		explore_fail("torn: value of state %u, text of states %u and %u", n, words[0],
		             words[1]);
	judge_rounds(5);
}

/* --- News ------------------------------------------------------------------------------------- */

#define NEWS 2

static void setup_news(void)
{
	text_of_one_length = false;
	word_a = 0;
	word_b = WORDS - 1;
	make_image();
	for (int i = 0; i < 2; i++)
		explore_track(i ? "slot 1, value" : "slot 0, value", &image.records[1].slot[i], 4);
	explore_track("news", &image.header->news, 4);
	explore_track("state", &image.header->state, 4);
	explore_track("name", &name, 4);
}

static void wake_readers(void)
{
	segment_wake(&image.header->news, INT_MAX);
}

/* As the engine's thread does after each step that published something. */
static void write_news(void)
{
	for (uint32_t n = 2; n < 2 + NEWS; n++) {
		publish(n);
		image_news(&image);
		wake_readers();
		explore_forget(n);
	}
	word_set(&name, 1);
	image_state(&image, OWS_STATE_RETIRED);
	wake_readers();
}

static void wait_for_news(void)
{
	uint32_t news = 0;

	while (ows_wait(&handle, &news, -1) > 0) {
		struct ows_sample sample;
		uint32_t n;

		if (!reader_sample(&image.records[1], &sample))
			explore_fail("gave up");
		n = state_of(0, (uint32_t)sample.value);
		if (n < (news < NEWS ? news : NEWS) + 1)
			explore_fail("woken by news %u, found state %u", news, n);
		explore_forget(news);
	}
	if (word_get(&name) != 1)
		explore_fail("retired, and the new image is not there");
}

static void nobody_sleeps(void)
{
	if (explore_asleep(1))
		explore_fail("asleep, and nobody will wake him");
}

/* --- The journal of alarms -------------------------------------------------------------------- */

/* Number OLD lies where number OLD + OWS_JOURNAL will. */
#define OLD 0u
#define NEW (OLD + OWS_JOURNAL)

static struct ows_journal_entry alarm_of(uint32_t n)
{
	return (struct ows_journal_entry){
		.record = 1,
		.occurred_ns = n,
		.kind = (uint8_t)n,
		.quality = (uint8_t)n,
	};
}

static void setup_journal(void)
{
	struct ows_journal_entry old = alarm_of(1);

	make_image();
	image_alarm(&image, &old);
	image.header->alarm_head = NEW;
	explore_track("head", &image.header->alarm_head, 4);
	explore_track("entry, seq", &image.alarms[0].seq, 4);
	explore_track("entry, occurred", &image.alarms[0].occurred_ns, 4);
	explore_track("entry, after", &image.alarms[0].after, 4);
	explore_track("entry, flags", &image.alarms[0].kind, 4);
	explore_track("entry, number", &image.alarms[0].number, 4);
}

static void write_entry(void)
{
	struct ows_journal_entry entry = alarm_of(2);

	image_alarm(&image, &entry);
}

static void write_entry_and_after(void)
{
	struct ows_journal_entry entry = alarm_of(2);

	image_alarm_after(&image, image_alarm(&image, &entry), 7);
}

static void judge_alarm(uint32_t number, uint32_t n)
{
	uint32_t head = ows_alarm_count(&handle);
	struct ows_alarm alarm;
	int err;

	explore_forget(head);
	err = ows_alarm(&handle, number, &alarm);
	if (err == -EAGAIN)
		return;
	if (err && head == number + 1)
		explore_fail("alarm %u was counted and is not there", number);
	if (err)
		return;
	if (alarm.occurred_ns != n || alarm.kind != n || alarm.quality != n)
		explore_fail("torn: alarm %u occurred at %u, kind %u", number,
		             (unsigned)alarm.occurred_ns, alarm.kind);
	if (alarm.has_after && alarm.after_integer != 7 && alarm.after != 0)
		explore_fail("alarm %u has a value after it that is none", number);
}

static void read_old_alarm(void)
{
	judge_alarm(OLD, 1);
}

static void read_new_alarm(void)
{
	judge_alarm(NEW, 2);
}

/* --- Wrong on purpose ------------------------------------------------------------------------- */

/* What the sequence word says is not asked a second time. */
static void read_unchecked(void)
{
	struct ows_slot slot;
	uint32_t seq;

	words_load(&slot, reader_begin(&image.records[1], &seq), WORDS);
	judge(&slot, 0);
}

/* One slot and nothing else: what an update in place would be. */
static void read_slot_0(void)
{
	struct ows_slot slot;

	words_load(&slot, &image.records[1].slot[0], WORDS);
	judge(&slot, 0);
}

/*
 * A reader without fences that believes the check word, here one that never errs: what it takes is
 * whole, but it may be older than what it took before.
 */
static uint32_t read_by_check_word(uint32_t last)
{
	const struct ows_record *r = &image.records[1];

	for (int i = 0; i < 4; i++) {
		uint32_t seq = word_get(&r->seq);
		struct ows_slot slot;
		const uint32_t *words = (const void *)&slot;

		words_load(&slot, &r->slot[seq >> 1 & 1], WORDS);
		if (word_get(&r->seq) - (seq & ~1u) <= 2 &&
		    state_of(word_a, words[word_a]) == state_of(word_b, words[word_b]))
			return judge(&slot, last);
	}
	return last;
}

static void read_whole_by_check_word(void)
{
	read_by_check_word(0);
}

static void read_in_order_by_check_word(void)
{
	uint32_t last = read_by_check_word(0);

	explore_forget(last);
	read_by_check_word(last);
}

/* --- */

/* clang-format off */
const struct scenario record_scenarios[] = {
	{"a slot read twice beside a busy writer", setup, 2, {write_all, read_twice}, .end = NULL},
	{"two readers", setup, 3, {write_few, read_once, read_once}, .end = NULL},
	{"a writer killed anywhere, another goes on in the same memory", setup, 2,
	 {write_all, read_twice}, {write_after}, NULL},
	{"an image filled by one thread, taken over by another", setup_with_flag, 3,
	 {write_and_hand_over, write_what_was_handed_over, read_twice}, .end = NULL},
	{"a text", setup_text, 2, {write_all, read_text}, .end = NULL},
	{"news: what was published before is there, nobody sleeps on, a reload is seen", setup_news, 2,
	 {write_news, wait_for_news}, .end = nobody_sleeps},
	{"journal: an entry that is taken by a later one", setup_journal, 2,
	 {write_entry, read_old_alarm}, .end = NULL},
	{"journal: a new entry and its value after", setup_journal, 2,
	 {write_entry_and_after, read_new_alarm}, .end = NULL},
	{"without fences, by the check word: whole", setup, 2,
	 {write_few, read_whole_by_check_word}, .end = NULL},
	{NULL},
};
/* clang-format on */

const struct scenario wrong_scenarios[] = {
	{"a reader that does not look at the sequence word again",
         setup,
         2,
         {write_all, read_unchecked},
         .end = NULL},
	{"a reader that knows one slot only", setup, 2, {write_all, read_slot_0}, .end = NULL},
	{"without fences, by the check word: in order",
         setup,
         2,
         {write_all, read_in_order_by_check_word},
         .end = NULL},
	{NULL},
};

void record_pairs(struct tally *tally)
{
	static const struct scenario pair = {"", setup, 2, {write_few, read_once}, .end = NULL};
	struct exploration result;
	unsigned pairs = 0;

	for (word_a = 0; word_a < WORDS; word_a++) {
		for (word_b = word_a + 1; word_b < WORDS; word_b++) {
			explore(&pair, NULL, 30, pairs == 0, &result);
			tally->states += result.states;
			tally->steps += result.steps;
			if (result.failed || result.too_large)
				break;
			pairs++;
		}
	}
	tally_test(tally, pairs == WORDS * (WORDS - 1) / 2, "each pair of words of a slot: %u",
	           pairs);
	word_a = 0;
	word_b = WORDS - 1;
}
