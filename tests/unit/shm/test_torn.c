/* SPDX-License-Identifier: MIT */
/*
 * Readers beside a writer at full speed, and beside writers that are killed. Every sample read is
 * verified by its check word, which is not part of the protocol under test.
 */
#include <errno.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "unity.h"

#include "src/memory/shm/reader.h"
#include "tests/unit/aid/instance.h"
#include "tests/unit/aid/whole.h"

static const struct instance_signal signals[] = {
	{"number", "/28.1/temperature", OWS_LARGE, false, 0},
	{"text", "/23.1/memory", OWS_STRING, false, 0},
};
enum { NUMBER = 1, TEXT };
#define READS 60000
#define KILLS 300

static struct instance in;
static int done;

void setUp(void)
{
	instance_start(&in, "torn", signals, 2);
	instance_dies_soon(&in);
	done = 0;
}

void tearDown(void)
{
	instance_end(&in);
}

static void publish(uint32_t record, uint32_t n)
{
	whole_publish(&in.image, record, n, record == TEXT ? INSTANCE_TEXT : 0);
}

static void *write_on(void *arg)
{
	uint32_t n = 1;

	while (!__atomic_load_n(&done, __ATOMIC_ACQUIRE)) {
		n++;
		publish(NUMBER, n);
		publish(TEXT, n);
	}
	*(uint32_t *)arg = n;
	return NULL;
}

struct reading {
	unsigned torn, back, gave_up;
};

static void *read_on(void *arg)
{
	struct reading *r = arg;
	uint32_t last = 0;

	for (int i = 0; i < READS; i++) {
		struct ows_slot slot;
		struct ows_sample sample;
		char text[INSTANCE_TEXT + 1];

		if (!reader_slot(&in.image.records[NUMBER], &slot))
			r->gave_up++;
		else if (!whole_slot(&slot))
			r->torn++;
		else if (slot.sample.count < last)
			r->back++;
		else
			last = slot.sample.count;
		if (!reader_sample(&in.image.records[NUMBER], &sample))
			r->gave_up++;
		else if (!whole_sample(&sample))
			r->torn++;
		if (!reader_text(in.image.base, &in.image.records[TEXT], &sample, text,
		                 sizeof(text)))
			r->gave_up++;
		else if (!whole_text(&sample, text, INSTANCE_TEXT))
			r->torn++;
	}
	return NULL;
}

/* The writer is at work: a busy machine may start it late. */
static void until_written(uint32_t before)
{
	int64_t until = ows_now() + 60 * INSTANCE_S;

	while (word_get(&in.image.records[TEXT].seq) == before)
		TEST_ASSERT_TRUE_MESSAGE(ows_now() < until, "the writer does not write");
}

static void test_readers_beside_a_busy_writer_see_whole_samples_in_order(void)
{
	struct reading readings[2] = {{0}};
	pthread_t writer, readers[2];
	uint32_t before, written = 0;

	publish(NUMBER, 1);
	publish(TEXT, 1);
	before = in.image.records[TEXT].seq;
	TEST_ASSERT_EQUAL(0, pthread_create(&writer, NULL, write_on, &written));
	until_written(before);
	for (int i = 0; i < 2; i++)
		TEST_ASSERT_EQUAL(0, pthread_create(&readers[i], NULL, read_on, &readings[i]));
	for (int i = 0; i < 2; i++)
		pthread_join(readers[i], NULL);
	__atomic_store_n(&done, 1, __ATOMIC_RELEASE);
	pthread_join(writer, NULL);
	TEST_ASSERT_GREATER_THAN(1, written);
	for (int i = 0; i < 2; i++) {
		TEST_ASSERT_EQUAL(0, readings[i].torn);
		TEST_ASSERT_EQUAL(0, readings[i].back);
		/* a reader that is put to sleep in each of 64 rounds may give up, and says so */
		TEST_ASSERT_LESS_THAN(READS / 100, readings[i].gave_up);
	}
}

static void write_until_killed(uint32_t n)
{
	for (;;) {
		n++;
		publish(NUMBER, n);
		publish(TEXT, n);
	}
}

static void pause_ns(long ns)
{
	struct timespec ts = {.tv_nsec = ns};

	nanosleep(&ts, NULL); /* any moment */
}

/* What readers find of a writer that is no more; returns the newest sample's number. */
static uint32_t look_at_the_remains(struct ows *h)
{
	struct ows_slot slot;
	struct ows_sample sample;
	struct ows_value value, later;
	char text[INSTANCE_TEXT + 1];
	int id = ows_find(h, "number");

	TEST_ASSERT_TRUE(reader_slot(&in.image.records[NUMBER], &slot));
	TEST_ASSERT_TRUE(whole_slot(&slot));
	TEST_ASSERT_TRUE(
		reader_text(in.image.base, &in.image.records[TEXT], &sample, text, sizeof(text)));
	TEST_ASSERT_TRUE(whole_text(&sample, text, INSTANCE_TEXT));
	TEST_ASSERT_EQUAL(0, ows_get(h, id, in.start_ns + INSTANCE_S, &value));
	TEST_ASSERT_EQUAL_INT64(slot.sample.value, value.integer);
	TEST_ASSERT_EQUAL(0, ows_get(h, id, in.start_ns + 5 * INSTANCE_S, &later));
	TEST_ASSERT_EQUAL_INT64(4 * INSTANCE_S, later.age_ns - value.age_ns);
	TEST_ASSERT_FALSE(ows_good(later.quality));
	return slot.sample.count;
}

static void test_a_writer_killed_anywhere_leaves_whole_samples_that_age(void)
{
	unsigned seed = (unsigned)time(NULL), in_a_write = 0;
	uint32_t last = 1;
	struct ows *h;

	printf("seed %u\n", seed);
	srandom(seed);
	TEST_ASSERT_EQUAL(0, ows_open(in.name, OWS_READ, &h));
	publish(NUMBER, 1);
	publish(TEXT, 1);
	for (int i = 0; i < KILLS; i++) {
		uint32_t found, before = in.image.records[TEXT].seq;
		pid_t child = fork();
		int status;

		if (child == 0)
			write_until_killed(last);
		TEST_ASSERT_GREATER_THAN(0, child);
		until_written(before);
		pause_ns(random() % 800000);
		TEST_ASSERT_EQUAL(0, kill(child, SIGKILL));
		TEST_ASSERT_EQUAL(child, waitpid(child, &status, 0));
		in_a_write += in.image.records[NUMBER].seq & 1;
		in_a_write += in.image.records[TEXT].seq & 1;
		found = look_at_the_remains(h);
		TEST_ASSERT_GREATER_THAN(last, found);
		last = found;
		/* A new owsd makes a new image; here the writer goes on where the dead one was */
		in.image.records[NUMBER].seq &= ~1u;
		in.image.records[TEXT].seq &= ~1u;
		publish(NUMBER, ++last);
		publish(TEXT, last);
	}
	ows_close(h);
	TEST_ASSERT_GREATER_THAN(0, in_a_write);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_readers_beside_a_busy_writer_see_whole_samples_in_order);
	RUN_TEST(test_a_writer_killed_anywhere_leaves_whole_samples_that_age);
	return UNITY_END();
}
