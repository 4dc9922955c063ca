/* SPDX-License-Identifier: MIT */
/*
 * A writer that makes and fills the files as owsd does, killed at random points, in its start too,
 * while a program reads; the next one takes over as owsd does, and finds the command in force.
 * KILLS=10000 for more.
 */
#include <errno.h>
#include <limits.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "unity.h"

#include "src/daemon/host/memory.h"
#include "src/memory/libows/handle.h"
#include "src/memory/shm/entries.h"
#include "src/memory/shm/reader.h"
#include "src/memory/shm/word.h"
#include "tests/unit/aid/folder.h"
#include "tests/unit/aid/whole.h"

#define KILLS 200
#define TEXT_ROOM 1000
#define S INT64_C(1000000000)
#define PATIENCE (30 * S)
enum { NUMBER = 1, TEXT, OUTPUT };

static char instance[32];
static struct config_target target = {.text = "null:"};
/* clang-format off */
static struct config_item items[] = {
	{ .name = "number", .path = "/28.1/temperature", .type = OWS_LARGE, .per_factor = 1,
	  .init_text = "", .safe_text = "" },
	{ .name = "text", .path = "/23.1/memory", .type = OWS_STRING, .per_factor = 1,
	  .init_text = "", .safe_text = "" },
	{ .name = "output", .path = "/29.1/PIO.BYTE", .type = OWS_LARGE, .output = true,
	  .per_factor = 1, .init_text = "", .safe_text = "" },
};
/* clang-format on */
static struct config config = {.targets = &target,
                               .target_count = 1,
                               .items = items,
                               .item_count = 3,
                               .period_ns = 100000000};

static struct ows *handle;
/* What writers tell: the last command that one remembered, and what those after it found. */
static struct force_words {
	uint32_t remembered, torn, lost;
} * force;
/* What the reader saw; in one generation numbers only grow. */
static struct {
	unsigned long reads, alarms, takeovers;
	unsigned torn, back, gave_up, in_an_update, before_shown;
} saw;
static uint32_t last[OUTPUT], generation;

void setUp(void)
{
	folder_dir();
	snprintf(instance, sizeof(instance), "kill-%ld", (long)getpid());
	memset(&saw, 0, sizeof(saw));
	force = mmap(NULL, sizeof(*force), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1,
	             0);
	TEST_ASSERT_TRUE(force != MAP_FAILED);
	handle = NULL;
}

static void remove_file(const char *kind)
{
	unlink(folder_file(instance, kind));
}

void tearDown(void)
{
	ows_close(handle);
	remove_file("image");
	remove_file("image.new");
	remove_file("force");
	remove_file("force.new");
	munmap(force, sizeof(*force));
}

static void pause_ns(int64_t ns)
{
	struct timespec ts = {.tv_sec = ns / S, .tv_nsec = ns % S};

	nanosleep(&ts, NULL); /* any moment */
}

/* --- The writer ------------------------------------------------------------------------------- */

static void publish_all(struct image *image, uint32_t n)
{
	struct ows_journal_entry alarm = {
		.record = NUMBER,
		.occurred_ns = n,
		.before = n,
		.kind = (uint8_t)n,
		.quality = (uint8_t)n,
		.flags = OWS_JOURNAL_BEFORE,
	};

	whole_publish(image, NUMBER, n, 0);
	whole_publish(image, TEXT, n, TEXT_ROOM);
	image_alarm(image, &alarm);
	image_news(image);
}

/* What a writer without a protocol does: into the directory that readers look at. */
static void publish_in_place(struct image *image, uint32_t n)
{
	struct ows_record *r = &image->records[NUMBER];
	struct image aside = *image;
	struct ows_record copy[2] = {{0}};
	uint32_t seq = word_get(&r->seq);

	aside.records = copy;
	whole_publish(&aside, NUMBER, n, 0);
	words_store(&r->slot[seq >> 1 & 1], &copy[NUMBER].slot[1], sizeof(copy[0].slot[0]) / 4);
}

/* The output's command in force: its value is as large as its stamp, and grows. */
static void remember(struct memory *memory, uint32_t n)
{
	const struct force_command command = {
		.value = n, .stamp = n, .given = true, .controller = FORCE_NOBODY};

	force_put(&memory->force, OUTPUT - 1, &command, NULL);
	__atomic_store_n(&force->remembered, n, __ATOMIC_SEQ_CST);
}

/* What the writer before has left, whole and no older than it said. */
static uint32_t find_remembered(const struct memory *memory)
{
	const struct force_signal signal = {"output", "/29.1/PIO.BYTE", OWS_LARGE};
	struct force_command left = {0};
	char text[1];

	if (memory->has_left)
		force_find(&memory->left, &signal, &left, text, sizeof(text));
	if (left.value != left.stamp)
		__atomic_fetch_add(&force->torn, 1, __ATOMIC_SEQ_CST);
	if (left.stamp < __atomic_load_n(&force->remembered, __ATOMIC_SEQ_CST))
		__atomic_fetch_add(&force->lost, 1, __ATOMIC_SEQ_CST);
	return left.stamp;
}

static void write_until_killed(void (*publish)(struct image *image, uint32_t n))
{
	struct memory memory;
	char why[256];
	uint32_t n = 1, command;

	prctl(PR_SET_PDEATHSIG, SIGKILL);
	if (memory_make(&memory,
	                &(struct memory_setup){
				.instance = instance, .dir = folder_dir(), .config = &config},
	                why, sizeof(why)))
		_exit(1);
	command = find_remembered(&memory);
	memory_resumed(&memory);
	publish_all(&memory.image, n);
	/* as an engine: the new file has what is in force before it takes the old one's place */
	force_put(&memory.force, OUTPUT - 1,
	          &(struct force_command){.value = command,
	                                  .stamp = command,
	                                  .given = true,
	                                  .controller = FORCE_NOBODY},
	          NULL);
	if (memory_show(&memory, NULL, why, sizeof(why)))
		_exit(2);
	for (;;) {
		publish(&memory.image, ++n);
		remember(&memory, ++command);
	}
}

/* --- The reader ------------------------------------------------------------------------------- */

static void in_order(uint32_t record, uint32_t n)
{
	if (n < last[record])
		saw.back++;
	last[record] = n;
}

static void read_alarm(void)
{
	uint32_t number = ows_alarm_count(handle) - 1;
	struct ows_alarm alarm;
	int err = ows_alarm(handle, number, &alarm);

	/* one that was killed in it leaves it odd for good */
	if (err)
		return;
	saw.alarms++;
	saw.torn += alarm.before_integer != alarm.occurred_ns ||
	            alarm.kind != (uint8_t)alarm.occurred_ns || alarm.quality != alarm.kind;
}

static void read_all(void)
{
	struct ows_sample sample;
	struct ows_slot slot;
	char text[TEXT_ROOM + 1];

	if (!reader_slot(map_record(&handle->map, NUMBER), &slot))
		saw.gave_up++;
	else if (!whole_slot(&slot))
		saw.torn++;
	else
		in_order(NUMBER, slot.sample.count);
	if (!reader_text(handle->map.base, map_record(&handle->map, TEXT), &sample, text,
	                 sizeof(text)))
		saw.gave_up++;
	else if (!whole_text(&sample, text, TEXT_ROOM))
		saw.torn++;
	else
		in_order(TEXT, sample.count);
	read_alarm();
	saw.reads++;
}

/* As a program does each cycle. True: with the present image. */
static bool attach(void)
{
	struct ows *opened;

	if (handle == NULL) {
		if (ows_open(instance, OWS_READ, &opened))
			return false;
		handle = opened;
	} else if (handle->map.image->generation == generation ||
	           word_get(&handle->map.image->state) != OWS_STATE_LIVE) {
		if (ows_reopen(handle))
			return false;
	}
	if (handle->map.image->generation == generation)
		return false;
	generation = handle->map.image->generation;
	memset(last, 0, sizeof(last));
	saw.takeovers++;
	return true;
}

static unsigned odd_words(void)
{
	const struct ows_image_header *h = handle->map.image;
	const struct ows_journal_entry *next = map_entry(&handle->map, OWS_AREA_ALARMS,
	                                                 h->alarm_head % OWS_JOURNAL);
	unsigned odd = map_record(&handle->map, NUMBER)->seq & 1;

	odd |= map_record(&handle->map, TEXT)->seq & 1;
	return odd | (next->seq & 1);
}

static pid_t start_writer(void (*publish)(struct image *image, uint32_t n))
{
	pid_t child = fork();

	if (child == 0) {
		write_until_killed(publish);
		_exit(3);
	}
	TEST_ASSERT_GREATER_THAN(0, child);
	return child;
}

static void kill_it(pid_t child)
{
	int status;

	TEST_ASSERT_EQUAL(0, kill(child, SIGKILL));
	TEST_ASSERT_EQUAL(child, waitpid(child, &status, 0));
	TEST_ASSERT_TRUE_MESSAGE(WIFSIGNALED(status), "the writer ended by itself");
}

/* In its start: whatever it has got to, what was there before is still readable. */
static void kill_in_the_start(void)
{
	pid_t child = start_writer(publish_all);

	pause_ns(random() % 1000000);
	kill_it(child);
	if (handle && !attach()) {
		saw.before_shown++;
		read_all();
	}
}

static void kill_while_it_writes(void)
{
	pid_t child = start_writer(publish_all);
	int64_t give_up = ows_now() + PATIENCE, until;

	while (!attach()) {
		TEST_ASSERT_TRUE_MESSAGE(ows_now() < give_up, "the writer does not show its image");
		if (handle)
			read_all();
	}
	until = ows_now() + random() % 500000;
	do {
		read_all();
	} while (ows_now() < until);
	kill_it(child);
	saw.in_an_update += odd_words();
	read_all();
}

static unsigned kills_wanted(void)
{
	const char *text = getenv("KILLS");
	int n = text ? atoi(text) : 0;

	return n > 0 ? (unsigned)n : KILLS;
}

static void test_a_writer_killed_anywhere_leaves_no_torn_sample_and_loses_no_command(void)
{
	unsigned seed = (unsigned)time(NULL), kills = kills_wanted();

	printf("seed %u\n", seed);
	srandom(seed);
	generation = 0;
	for (unsigned i = 0; i < kills; i++) {
		if (i % 8 == 7)
			kill_in_the_start();
		else
			kill_while_it_writes();
	}
	printf("%u kills: %u in an update, %u before the image was shown; %lu takeovers seen; "
	       "%lu reads, %lu of alarms; %u torn, %u back, %u given up, %u commands lost\n",
	       kills, saw.in_an_update, saw.before_shown, saw.takeovers, saw.reads, saw.alarms,
	       saw.torn + force->torn, saw.back, saw.gave_up, force->lost);
	TEST_ASSERT_EQUAL(0, saw.torn);
	TEST_ASSERT_EQUAL(0, saw.back);
	TEST_ASSERT_EQUAL(0, force->torn);
	TEST_ASSERT_EQUAL(0, force->lost);
	TEST_ASSERT_GREATER_THAN(kills / 20, saw.in_an_update);
	TEST_ASSERT_LESS_THAN(saw.reads / 100 + 1, saw.gave_up);
}

static void test_a_writer_without_the_protocol_is_found_out_by_kills(void)
{
	unsigned kills = 0, found = 0;

	generation = 0;
	while (!found && kills++ < 500) {
		pid_t child = start_writer(publish_in_place);
		int64_t give_up = ows_now() + PATIENCE;
		struct ows_slot slot;

		while (!attach())
			TEST_ASSERT_TRUE(ows_now() < give_up);
		pause_ns(random() % 300000);
		kill_it(child);
		TEST_ASSERT_TRUE(reader_slot(map_record(&handle->map, NUMBER), &slot));
		found = !whole_slot(&slot);
	}
	printf("found out by kill %u\n", kills);
	TEST_ASSERT_EQUAL(1, found);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_writer_killed_anywhere_leaves_no_torn_sample_and_loses_no_command);
	RUN_TEST(test_a_writer_without_the_protocol_is_found_out_by_kills);
	return UNITY_END();
}
