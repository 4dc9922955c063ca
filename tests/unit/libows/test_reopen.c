/* SPDX-License-Identifier: MIT */
/* Tests of opening segments again after a reload or restart. */
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "unity.h"

#include "src/shm/futex.h"
#include "tests/unit/aid/instance.h"

static const struct instance_signal before[] = {
	{"a", "/28.1/temperature", OWS_DOUBLE, false, 0},
	{"b", "/29.1/PIO.0", OWS_BOOL, true, 0},
	{"c", "/23.1/memory", OWS_STRING, true, 0},
};
/* b moved, c went, a changed its type, d is new */
static const struct instance_signal after[] = {
	{"d", "/26.1/VAD", OWS_DOUBLE, false, 0},
	{"b", "/29.1/PIO.0", OWS_BOOL, true, 0},
	{"a", "/28.1/temperature", OWS_FLOAT, false, 0},
};

static struct instance in;
static struct ows *h;

void setUp(void)
{
	instance_start(&in, "reopen", before, 3);
	instance_lives_on(&in);
	TEST_ASSERT_EQUAL(0, ows_open(in.name, OWS_CONTROL, &h));
}

void tearDown(void)
{
	ows_close(h);
	instance_end(&in);
}

static void test_ids_stay_right_over_a_reload(void)
{
	struct ows_value v;
	int a = ows_find(h, "a"), b = ows_find(h, "b"), c = ows_find(h, "c");
	int age = ows_find(h, "b_Age");

	instance_put(&in, 2, 1, ows_now());
	instance_reload(&in, after, 3);
	instance_lives_on(&in);
	TEST_ASSERT_EQUAL(-ESTALE, ows_get(h, b, ows_now(), &v));
	TEST_ASSERT_EQUAL_INT64(1, v.integer);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, v.quality);
	TEST_ASSERT_EQUAL(-ESTALE,
	                  ows_get(h, b, ows_now() + INSTANCE_PATIENCE + 10 * INSTANCE_S, &v));
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_TARGET, v.quality);
	TEST_ASSERT_EQUAL(0, ows_reopen(h));
	instance_put(&in, 2, 0, ows_now());
	instance_put_double(&in, 3, 2.5, ows_now());
	TEST_ASSERT_EQUAL(0, ows_get(h, b, ows_now(), &v));
	TEST_ASSERT_EQUAL_INT64(0, v.integer);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, v.quality);
	TEST_ASSERT_EQUAL(0, ows_get(h, a, ows_now(), &v));
	TEST_ASSERT_EQUAL(OWS_FLOAT, v.type);
	TEST_ASSERT_EQUAL_DOUBLE(2.5, v.number);
	TEST_ASSERT_EQUAL(0, ows_get(h, age, ows_now(), &v));
	TEST_ASSERT_EQUAL(-ENOENT, ows_get(h, c, ows_now(), &v));
	TEST_ASSERT_EQUAL(-ENOENT, ows_find(h, "c"));
	instance_reload(&in, before, 3);
	TEST_ASSERT_EQUAL(0, ows_reopen(h));
	TEST_ASSERT_EQUAL(c, ows_find(h, "c"));
}

static void test_a_commanded_value_goes_to_the_same_signal_after_a_reload(void)
{
	struct command c;
	uint32_t stamp;

	TEST_ASSERT_EQUAL(0, ows_beat(h, 1000));
	TEST_ASSERT_EQUAL(0, ows_set(h, ows_find(h, "b"), 1, NULL));
	instance_reload(&in, after, 3);
	commands_load(&in.commands, 2, &c);
	TEST_ASSERT_EQUAL_INT64(1, c.value);
	TEST_ASSERT_EQUAL(1, c.client);
	TEST_ASSERT_EQUAL(-ESTALE, ows_set(h, ows_find(h, "b"), 0, NULL));
	TEST_ASSERT_EQUAL(0, ows_reopen(h));
	TEST_ASSERT_EQUAL(0, ows_set(h, ows_find(h, "b"), 0, &stamp));
	TEST_ASSERT_EQUAL(2, stamp);
	commands_load(&in.commands, 2, &c);
	TEST_ASSERT_EQUAL(1, c.client);
}

static void test_reopen_waits_for_the_new_image(void)
{
	struct ows_value v;
	int b = ows_find(h, "b");

	instance_put(&in, 2, 1, ows_now());
	image_state(&in.image, OWS_STATE_STOPPED);
	TEST_ASSERT_EQUAL(-ENOENT, ows_reopen(h));
	TEST_ASSERT_EQUAL(0, segment_remove(in.name, SEGMENT_IMAGE));
	TEST_ASSERT_EQUAL(-ENOENT, ows_reopen(h));
	TEST_ASSERT_EQUAL(-ESTALE, ows_get(h, b, ows_now(), &v));
	TEST_ASSERT_EQUAL_INT64(1, v.integer);
}

static void test_reopen_of_what_is_present_changes_nothing(void)
{
	struct ows_value v;
	int b = ows_find(h, "b");

	instance_put(&in, 2, 1, ows_now());
	TEST_ASSERT_EQUAL(0, ows_reopen(h));
	TEST_ASSERT_EQUAL(0, ows_get(h, b, ows_now(), &v));
	TEST_ASSERT_EQUAL_INT64(1, v.integer);
}

static void test_wait_returns_for_news_time_and_retirement(void)
{
	uint32_t news = 0;

	TEST_ASSERT_EQUAL(1, ows_wait(h, &news, 0));
	TEST_ASSERT_EQUAL(0, ows_wait(h, &news, 1000000));
	image_news(&in.image);
	TEST_ASSERT_EQUAL(1, ows_wait(h, &news, 1000000));
	image_state(&in.image, OWS_STATE_RETIRED);
	TEST_ASSERT_EQUAL(-ESTALE, ows_wait(h, &news, -1));
}

static void *publish_later(void *arg)
{
	struct timespec pause = {.tv_nsec = 20000000};

	nanosleep(&pause, NULL);
	if (arg != NULL)
		image_state(&in.image, OWS_STATE_RETIRED);
	else
		image_news(&in.image);
	segment_wake(&in.image.header->news, 1000);
	return NULL;
}

static void test_a_sleeper_wakes_for_news_and_for_retirement(void)
{
	uint32_t news = 0;
	pthread_t thread;

	TEST_ASSERT_EQUAL(1, ows_wait(h, &news, 0));
	TEST_ASSERT_EQUAL(0, pthread_create(&thread, NULL, publish_later, NULL));
	TEST_ASSERT_EQUAL(1, ows_wait(h, &news, 60 * INSTANCE_S));
	pthread_join(thread, NULL);
	TEST_ASSERT_EQUAL(0, pthread_create(&thread, NULL, publish_later, &in));
	TEST_ASSERT_EQUAL(-ESTALE, ows_wait(h, &news, INT64_MAX)); /* no limit either */
	pthread_join(thread, NULL);
}

static void expect_open(int err)
{
	struct ows *other;

	TEST_ASSERT_EQUAL(err, ows_open(in.name, OWS_CONTROL, &other));
	TEST_ASSERT_NULL(other);
}

static void test_open_refuses_what_is_not_ours(void)
{
	struct ows_image_header *image = in.image.header, image_was = *image;
	struct ows_command_header *command = (void *)in.commands.base, command_was = *command;

#define REFUSED(h, field, value, err) \
	do { \
		h->field = value; \
		expect_open(err); \
		*h = h##_was; \
	} while (0)
	REFUSED(image, magic, 1, -EPROTO);
	REFUSED(image, major, 2, -EPROTO);
	REFUSED(image, size, 4096 * 1024, -EPROTO);
	REFUSED(image, record_size, 128, -EPROTO);
	REFUSED(image, record_count, 0, -EPROTO);
	REFUSED(image, record_count, 0xffffffffu, -EPROTO);
	REFUSED(image, record_off, 0xfffffff8u, -EPROTO);
	REFUSED(image, record_off, 257, -EPROTO);
	REFUSED(image, name_off, image->size, -EPROTO);
	REFUSED(image, pool_size, 0, -EPROTO);
	REFUSED(image, pool_size, 0x7fffffffu, -EPROTO);
	REFUSED(image, counter_count, 0x1000000u, -EPROTO);
	REFUSED(image, text_size, 64, -EPROTO);
	REFUSED(command, magic, 0, -EPROTO);
	REFUSED(command, slot_off, 0x10000000u, -EPROTO);
	REFUSED(command, slot_count, 1, -EPROTO);
	REFUSED(command, dirty_words, 0x40000000u, -EPROTO);
	REFUSED(command, entry_off, 4, -EPROTO);
	REFUSED(command, text_cap, 0x10000000u, -EPROTO);
	REFUSED(command, generation, 99, -ENOENT);
	REFUSED(command, start_id, 99, -ENOENT);
#undef REFUSED
}

static void test_open_refuses_names_and_files_that_cannot_be(void)
{
	struct ows *other;
	char path[80];

	TEST_ASSERT_EQUAL(-EINVAL, ows_open("../etc", OWS_READ, &other));
	TEST_ASSERT_EQUAL(-EINVAL, ows_open("", OWS_READ, &other));
	TEST_ASSERT_EQUAL(-EINVAL, ows_open(".hidden", OWS_READ, &other));
	TEST_ASSERT_EQUAL(-ENOENT, ows_open("no-such-instance", OWS_READ, &other));
	snprintf(path, sizeof(path), "/dev/shm/owsd.%s.image", in.name);
	TEST_ASSERT_EQUAL(0, unlink(path));
	TEST_ASSERT_EQUAL(0, symlink("/etc/passwd", path));
	TEST_ASSERT_EQUAL(-EPERM, ows_open(in.name, OWS_READ, &other));
	TEST_ASSERT_EQUAL(0, unlink(path));
	TEST_ASSERT_EQUAL(0, mkfifo(path, 0600));
	TEST_ASSERT_EQUAL(-EPERM, ows_open(in.name, OWS_READ, &other));
	TEST_ASSERT_EQUAL(0, unlink(path));
	close(open(path, O_CREAT | O_WRONLY, 0600));
	TEST_ASSERT_EQUAL(-EPROTO, ows_open(in.name, OWS_READ, &other));
}

static void test_names_with_rubbish_offsets_end_nowhere(void)
{
	struct ows_name_entry *names = (void *)(in.image.base + in.image.header->name_off);
	struct ows *other;

	for (int i = 0; i < 4; i++)
		names[i].name_off = 0xfffffff0u + (uint32_t)i;
	TEST_ASSERT_EQUAL(0, ows_open(in.name, OWS_READ, &other));
	TEST_ASSERT_EQUAL(-ENOENT, ows_find(other, "a"));
	ows_close(other);
	names[1].record = 77;
	expect_open(-EPROTO);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_ids_stay_right_over_a_reload);
	RUN_TEST(test_a_commanded_value_goes_to_the_same_signal_after_a_reload);
	RUN_TEST(test_reopen_waits_for_the_new_image);
	RUN_TEST(test_reopen_of_what_is_present_changes_nothing);
	RUN_TEST(test_wait_returns_for_news_time_and_retirement);
	RUN_TEST(test_a_sleeper_wakes_for_news_and_for_retirement);
	RUN_TEST(test_open_refuses_what_is_not_ours);
	RUN_TEST(test_open_refuses_names_and_files_that_cannot_be);
	RUN_TEST(test_names_with_rubbish_offsets_end_nowhere);
	return UNITY_END();
}
