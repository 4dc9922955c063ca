/* SPDX-License-Identifier: MIT */
/* Tests of opening segments again after a reload or restart. */
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "unity.h"

#include "src/memory/shm/futex.h"
#include "tests/unit/aid/asleep.h"
#include "tests/unit/aid/folder.h"
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
	TEST_ASSERT_EQUAL(0, ows_open(in.name, OWS_CONTROL, &h));
}

void tearDown(void)
{
	ows_close(h);
	instance_end(&in);
}

/* Reopening waits only a moment; a busy machine may need more of them. */
static int reopen(struct ows *handle)
{
	const struct timespec pause = {.tv_nsec = 1000000};
	int err = -ENOENT;

	for (int i = 0; err == -ENOENT && i < 60000; i++) {
		err = ows_reopen(handle);
		if (err)
			nanosleep(&pause, NULL); /* pace */
	}
	return err;
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
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_NO_OWSD, v.quality);
	TEST_ASSERT_EQUAL(0, reopen(h));
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
	TEST_ASSERT_EQUAL(0, reopen(h));
	TEST_ASSERT_EQUAL(c, ows_find(h, "c"));
}

static void test_a_command_goes_to_the_same_signal_after_a_reload(void)
{
	struct controller_beat beat;
	uint32_t stamp;

	TEST_ASSERT_EQUAL(0, ows_beat(h, 1000));
	TEST_ASSERT_EQUAL(0, ows_for(h, "anna"));
	TEST_ASSERT_EQUAL(0, ows_set(h, ows_find(h, "b"), 1, NULL));
	instance_reload(&in, after, 3);
	instance_lives_on(&in);
	TEST_ASSERT_EQUAL_INT64(1, instance_command(&in, 0, 2).value);
	TEST_ASSERT_EQUAL(-ESTALE, ows_set(h, ows_find(h, "b"), 0, NULL));
	TEST_ASSERT_EQUAL(0, reopen(h));
	TEST_ASSERT_EQUAL(0, ows_set(h, ows_find(h, "b"), 0, &stamp));
	TEST_ASSERT_EQUAL(2, stamp);
	TEST_ASSERT_EQUAL_INT64(0, instance_command(&in, 0, 2).value);
	TEST_ASSERT_EQUAL(1, instance_command(&in, 0, 2).person);
	controller_beat(instance_controller(&in, 0), &beat);
	TEST_ASSERT_EQUAL(1000, beat.period_ms);
	TEST_ASSERT_EQUAL(2, beat.beat);
	TEST_ASSERT_EQUAL_MESSAGE(1, instance_controllers(&in), "it stays the same controller");
}

static void test_of_several_reloads_the_last_counts(void)
{
	instance_reload(&in, after, 3);
	instance_reload(&in, before, 3);
	instance_reload(&in, after, 3);
	instance_lives_on(&in);
	TEST_ASSERT_EQUAL(0, reopen(h));
	TEST_ASSERT_EQUAL(0, ows_set(h, ows_find(h, "b"), 1, NULL));
	TEST_ASSERT_EQUAL_INT64(1, instance_command(&in, 0, 2).value);
}

/* As when owsd-porter is killed with the welcome in its queue. */
static void test_a_welcome_that_is_lost_is_asked_for_by_another_connection(void)
{
	TEST_ASSERT_EQUAL(0, ows_set(h, ows_find(h, "b"), 1, NULL));
	door_lie(in.door, DOOR_LOSES);
	instance_reload(&in, after, 3);
	instance_lives_on(&in);
	TEST_ASSERT_EQUAL(0, reopen(h));
	TEST_ASSERT_EQUAL(2, instance_controllers(&in));
	TEST_ASSERT_EQUAL_STRING("token 1", (char *)door_controller(in.door, 1)->hello.token);
	TEST_ASSERT_EQUAL(0, ows_set(h, ows_find(h, "b"), 0, NULL));
	TEST_ASSERT_EQUAL_UINT32(2, instance_command(&in, 1, 2).stamp);
}

/* The owsd after one that was killed. */
static void start_next(void)
{
	image_state(&in.image, OWS_STATE_RETIRED);
	instance_leave(&in);
	instance_make(&in, "reopen", 1, ows_now() + 1, before, 3);
	instance_lives_on(&in);
	instance_show(&in);
}

static void restart(void)
{
	instance_kill(&in);
	start_next();
}

static void test_after_a_restart_the_controller_comes_back_with_its_token_and_beats(void)
{
	struct controller_beat beat;
	uint32_t stamp;

	TEST_ASSERT_EACH_EQUAL_UINT8(0, door_controller(in.door, 0)->hello.token, 16);
	TEST_ASSERT_EQUAL(0, ows_beat(h, 1500));
	TEST_ASSERT_EQUAL(0, ows_for(h, "anna"));
	TEST_ASSERT_EQUAL(0, ows_set(h, ows_find(h, "b"), 1, NULL));
	restart();
	TEST_ASSERT_EQUAL(-ESTALE, ows_set(h, ows_find(h, "b"), 1, NULL));
	TEST_ASSERT_EQUAL(0, reopen(h));
	TEST_ASSERT_EQUAL_STRING("token 1", (char *)door_controller(in.door, 0)->hello.token);
	controller_beat(instance_controller(&in, 0), &beat);
	TEST_ASSERT_EQUAL(1500, beat.period_ms);
	TEST_ASSERT_EQUAL(1, beat.beat);
	TEST_ASSERT_EQUAL_MESSAGE(0, instance_command(&in, 0, 2).stamp, "it sets nothing itself");
	TEST_ASSERT_EQUAL(0, ows_set(h, ows_find(h, "b"), 0, &stamp));
	TEST_ASSERT_EQUAL(2, stamp);
	TEST_ASSERT_EQUAL(1, instance_command(&in, 0, 2).person);
}

/* A thread that hangs in the kernel keeps all connections of an owsd that was killed. */
static void test_an_owsd_that_was_killed_and_hangs_up_on_nobody_is_left(void)
{
	struct controller_beat beat;
	struct instance next;
	struct ows *reader;

	TEST_ASSERT_EQUAL(0, ows_open(in.name, OWS_READ, &reader));
	TEST_ASSERT_GREATER_OR_EQUAL(0, ows_fd(reader));
	TEST_ASSERT_EQUAL(0, ows_beat(h, 1000));
	instance_make(&next, "reopen", in.generation + 1, in.start_ns + 1, before, 3);
	instance_lives_on(&next);
	instance_show(&next);
	image_state(&in.image, OWS_STATE_RETIRED);
	TEST_ASSERT_EQUAL(0, reopen(h));
	TEST_ASSERT_EQUAL_STRING("token 1", (char *)door_controller(next.door, 0)->hello.token);
	controller_beat(instance_controller(&next, 0), &beat);
	TEST_ASSERT_EQUAL(1000, beat.period_ms);
	TEST_ASSERT_EQUAL(0, ows_set(h, ows_find(h, "b"), 1, NULL));
	TEST_ASSERT_EQUAL_INT64(1, instance_command(&next, 0, 2).value);
	TEST_ASSERT_EQUAL(0, reopen(reader));
	TEST_ASSERT_EQUAL(2, instance_controllers(&next));
	ows_close(reader);
	instance_end(&next);
}

static void test_a_controller_that_never_beat_comes_back_without_a_beat(void)
{
	struct controller_beat beat;

	restart();
	TEST_ASSERT_EQUAL(0, reopen(h));
	controller_beat(instance_controller(&in, 0), &beat);
	TEST_ASSERT_EQUAL(0, beat.period_ms);
	TEST_ASSERT_EQUAL(0, beat.beat);
	TEST_ASSERT_EQUAL(0, ows_set(h, ows_find(h, "b"), 1, NULL));
}

static void test_while_nobody_listens_the_old_image_stays_readable(void)
{
	struct ows_value v;
	struct ows *other;
	int b = ows_find(h, "b");

	instance_put(&in, 2, 1, ows_now());
	instance_kill(&in);
	TEST_ASSERT_EQUAL(-ENOENT, ows_reopen(h));
	TEST_ASSERT_EQUAL(-ENOENT, ows_reopen(h));
	TEST_ASSERT_EQUAL(-ENOENT, ows_open(in.name, OWS_CONTROL, &other));
	TEST_ASSERT_EQUAL(-ESTALE, ows_set(h, b, 1, NULL));
	TEST_ASSERT_EQUAL(0, ows_get(h, b, ows_now(), &v));
	TEST_ASSERT_EQUAL_INT64(1, v.integer);
	TEST_ASSERT_EQUAL(0, ows_open(in.name, OWS_READ, &other));
	ows_close(other);
}

static void test_a_reader_that_asks_for_a_descriptor_is_woken_by_it(void)
{
	const uint64_t one = 1;
	struct pollfd news;
	struct ows *reader;
	uint32_t seen = 0;

	TEST_ASSERT_EQUAL(0, ows_open(in.name, OWS_READ, &reader));
	TEST_ASSERT_EQUAL(1, ows_wait(reader, &seen, 0));
	news = (struct pollfd){.fd = ows_fd(reader), .events = POLLIN};
	TEST_ASSERT_GREATER_OR_EQUAL(0, news.fd);
	TEST_ASSERT_EQUAL(0, door_controller(in.door, 1)->hello.flags);
	TEST_ASSERT_EQUAL(0, poll(&news, 1, 0));
	TEST_ASSERT_TRUE(controller_waits(instance_controller(&in, 1)));
	image_news(&in.image);
	TEST_ASSERT_EQUAL(8, write(door_controller(in.door, 1)->news, &one, sizeof(one)));
	TEST_ASSERT_EQUAL(1, poll(&news, 1, 60000));
	TEST_ASSERT_EQUAL(news.fd, ows_fd(reader));
	TEST_ASSERT_EQUAL(0, poll(&news, 1, 0));
	TEST_ASSERT_EQUAL(-EACCES, ows_set(reader, ows_find(reader, "b"), 1, NULL));
	instance_reload(&in, after, 3);
	instance_lives_on(&in);
	TEST_ASSERT_EQUAL(0, reopen(reader));
	TEST_ASSERT_EQUAL(news.fd, ows_fd(reader));
	ows_close(reader);
}

static void test_a_reader_that_is_refused_a_descriptor_goes_on_without(void)
{
	struct ows_value v;
	struct ows *reader;
	int fd, b;

	TEST_ASSERT_EQUAL(0, ows_open(in.name, OWS_READ, &reader));
	b = ows_find(reader, "b");
	fd = ows_fd(reader);
	TEST_ASSERT_GREATER_OR_EQUAL(0, fd);
	controller_applied(instance_controller(&in, 1), 2, 9);
	door_lie(in.door, DOOR_REFUSES);
	instance_reload(&in, after, 3);
	instance_lives_on(&in);
	TEST_ASSERT_EQUAL(0, reopen(reader));
	TEST_ASSERT_EQUAL_MESSAGE(-EACCES, reopen(h), "it commands");
	instance_put(&in, 2, 1, ows_now());
	TEST_ASSERT_EQUAL(0, ows_get(reader, b, ows_now(), &v));
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, v.quality);
	TEST_ASSERT_EQUAL(0, v.applied);
	TEST_ASSERT_EQUAL(fd, ows_fd(reader));
	door_lie(in.door, DOOR_HONEST);
	instance_reload(&in, before, 3);
	instance_lives_on(&in);
	TEST_ASSERT_EQUAL(0, reopen(reader));
	TEST_ASSERT_EQUAL(fd, ows_fd(reader));
	TEST_ASSERT_TRUE(controller_waits(instance_controller(&in, 2)));
	TEST_ASSERT_EQUAL(0, reopen(h));
	ows_close(reader);
}

/* How often poll() finds the descriptor readable in half a second, when asked anew each time. */
static int wakes(struct ows *reader)
{
	int64_t until = ows_now() + INSTANCE_S / 2;
	int count = 0;

	while (ows_now() < until) {
		struct pollfd news = {.fd = ows_fd(reader), .events = POLLIN};

		TEST_ASSERT_GREATER_OR_EQUAL(0, news.fd);
		count += poll(&news, 1, 50);
	}
	return count;
}

static void test_a_descriptor_whose_owsd_has_ended_wakes_only_now_and_then(void)
{
	const uint64_t one = 1;
	struct ows *reader;
	struct pollfd news = {.events = POLLIN};

	TEST_ASSERT_EQUAL(0, ows_open(in.name, OWS_READ, &reader));
	news.fd = ows_fd(reader);
	TEST_ASSERT_GREATER_OR_EQUAL(0, news.fd);
	instance_kill(&in);
	TEST_ASSERT_EQUAL(1, poll(&news, 1, 60000));
	TEST_ASSERT_EQUAL(news.fd, ows_fd(reader));
	TEST_ASSERT_LESS_OR_EQUAL(3, wakes(reader));
	start_next();
	TEST_ASSERT_EQUAL(0, reopen(reader));
	TEST_ASSERT_EQUAL(news.fd, ows_fd(reader));
	image_news(&in.image);
	TEST_ASSERT_EQUAL(8, write(door_controller(in.door, 0)->news, &one, sizeof(one)));
	TEST_ASSERT_EQUAL(1, poll(&news, 1, 400));
	ows_close(reader);
}

static void test_without_any_news_the_descriptor_wakes_by_itself(void)
{
	struct ows *reader;
	struct pollfd news = {.events = POLLIN};

	TEST_ASSERT_EQUAL(0, ows_open(in.name, OWS_READ, &reader));
	news.fd = ows_fd(reader);
	TEST_ASSERT_EQUAL(1, poll(&news, 1, 60000));
	TEST_ASSERT_EQUAL(news.fd, ows_fd(reader));
	TEST_ASSERT_EQUAL(0, poll(&news, 1, 0));
	ows_close(reader);
}

/* A forked child has the connection too, and closes what it has of it: the parent goes on. */
static void test_a_childs_copy_of_the_news_keeps_no_parent_awake(void)
{
	int hold[2], status;
	struct ows *reader;
	pid_t child;
	char byte;

	TEST_ASSERT_EQUAL(0, ows_open(in.name, OWS_READ, &reader));
	TEST_ASSERT_GREATER_OR_EQUAL(0, ows_fd(reader));
	TEST_ASSERT_EQUAL(0, pipe(hold));
	child = fork();
	if (child == 0) {
		close(hold[1]);
		_exit(read(hold[0], &byte, 1) != 0);
	}
	instance_kill(&in);
	TEST_ASSERT_LESS_OR_EQUAL(3, wakes(reader));
	close(hold[0]);
	close(hold[1]);
	TEST_ASSERT_EQUAL(child, waitpid(child, &status, 0));
	TEST_ASSERT_EQUAL(0, status);
	child = fork();
	if (child == 0) {
		ows_close(reader);
		_exit(0);
	}
	TEST_ASSERT_EQUAL(child, waitpid(child, &status, 0));
	TEST_ASSERT_GREATER_OR_EQUAL(1, wakes(reader)); /* its timer still wakes it */
	ows_close(reader);
}

static void test_a_connected_sleeper_wakes_by_its_descriptor(void)
{
	const uint64_t one = 1;
	uint32_t seen = 0;

	TEST_ASSERT_EQUAL(1, ows_wait(h, &seen, 0));
	image_news(&in.image);
	TEST_ASSERT_EQUAL(8, write(door_controller(in.door, 0)->news, &one, sizeof(one)));
	TEST_ASSERT_EQUAL(1, ows_wait(h, &seen, 60 * INSTANCE_S));
	TEST_ASSERT_EQUAL(0, ows_wait(h, &seen, 1000000));
	/* owsd has hung up, and the descriptor with it: the image still counts */
	instance_kill(&in);
	TEST_ASSERT_EQUAL(0, ows_wait(h, &seen, 1000000));
}

static void test_reopen_waits_for_the_new_image(void)
{
	struct ows_value v;
	int b = ows_find(h, "b");

	instance_put(&in, 2, 1, ows_now());
	image_state(&in.image, OWS_STATE_STOPPED);
	TEST_ASSERT_EQUAL(-ENOENT, ows_reopen(h));
	TEST_ASSERT_EQUAL(0, remove(folder_file(in.name, "image")));
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

/* The loop that reopens at each -ESTALE, between the end of owsd and its next start. */
static void test_a_wait_does_not_spin_while_owsd_is_away(void)
{
	uint32_t news = 0;
	int64_t begin;

	image_state(&in.image, OWS_STATE_STOPPED);
	TEST_ASSERT_EQUAL(-ESTALE, ows_wait(h, &news, -1));
	begin = ows_now();
	for (int i = 0; i < 4; i++) {
		TEST_ASSERT_EQUAL(-ENOENT, ows_reopen(h));
		TEST_ASSERT_EQUAL(-ESTALE, ows_wait(h, &news, -1));
	}
	TEST_ASSERT_GREATER_OR_EQUAL_INT64(INSTANCE_S / 4, ows_now() - begin);
	begin = ows_now();
	for (int i = 0; i < 1000; i++)
		TEST_ASSERT_EQUAL(-ESTALE, ows_wait(h, &news, 0));
	TEST_ASSERT_LESS_THAN_INT64(90 * INSTANCE_S, ows_now() - begin);
}

static void *publish_later(void *arg)
{
	until_asleep(NULL);
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
	struct ows *reader; /* which sleeps on the word of the image */

	TEST_ASSERT_EQUAL(0, ows_open(in.name, OWS_READ, &reader));
	TEST_ASSERT_EQUAL(1, ows_wait(reader, &news, 0));
	TEST_ASSERT_EQUAL(0, pthread_create(&thread, NULL, publish_later, NULL));
	TEST_ASSERT_EQUAL(1, ows_wait(reader, &news, 60 * INSTANCE_S));
	pthread_join(thread, NULL);
	TEST_ASSERT_EQUAL(0, pthread_create(&thread, NULL, publish_later, &in));
	TEST_ASSERT_EQUAL(-ESTALE, ows_wait(reader, &news, INT64_MAX)); /* no limit either */
	pthread_join(thread, NULL);
	ows_close(reader);
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
	struct ows_area_entry *area, area_was;

#define REFUSED(h, field, value, err) \
	do { \
		h->field = value; \
		expect_open(err); \
		*h = h##_was; \
	} while (0)
	REFUSED(image, magic, 1, -EPROTO);
	REFUSED(image, major, 1, -EPROTO);
	REFUSED(image, area_off, 0xfffffff8u, -EPROTO);
	REFUSED(image, area_count, 0x10000000u, -EPROTO);
	REFUSED(image, size, 4096 * 1024, -EPROTO);
#define REFUSED_AREA(which, field, value) \
	do { \
		area = &in.image.areas[OWS_AREA_##which - 1]; \
		area_was = *area; \
		REFUSED(area, field, value, -EPROTO); \
	} while (0)
	REFUSED_AREA(RECORDS, size, 128);
	REFUSED_AREA(RECORDS, count, 0);
	REFUSED_AREA(RECORDS, count, 0xffffffffu);
	REFUSED_AREA(RECORDS, off, 0xfffffff8u);
	REFUSED_AREA(RECORDS, off, 257);
	REFUSED_AREA(RECORDS, kind, OWS_AREAS);
	REFUSED_AREA(INFOS, count, 1);
	REFUSED_AREA(NAMES, off, in.image.header->size);
	REFUSED_AREA(NAMES, count, 1);
	REFUSED_AREA(POOL, count, 0);
	REFUSED_AREA(POOL, count, 0x7fffffffu);
	REFUSED_AREA(POOL, size, 8);
	REFUSED_AREA(COUNTERS, count, 0x1000000u);
	REFUSED_AREA(TEXTS, count, 64);
	REFUSED_AREA(ORIGINS, count, 1);
	REFUSED_AREA(CHANGES, count, 1000);
	REFUSED_AREA(CONTROLLERS, kind, OWS_AREA_SHELVES);
#undef REFUSED_AREA
#undef REFUSED
}

static void test_open_refuses_names_and_files_that_cannot_be(void)
{
	struct ows *other;
	char path[DIR_PATH + 64];

	TEST_ASSERT_EQUAL(-EINVAL, ows_open("../etc", OWS_READ, &other));
	TEST_ASSERT_EQUAL(-EINVAL, ows_open("", OWS_READ, &other));
	TEST_ASSERT_EQUAL(-EINVAL, ows_open(".hidden", OWS_READ, &other));
	TEST_ASSERT_EQUAL(-ENOENT, ows_open("no-such-instance", OWS_READ, &other));
	snprintf(path, sizeof(path), "%s", folder_file(in.name, "image"));
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
	struct ows_name_entry *names = in.image.names;
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
	RUN_TEST(test_a_command_goes_to_the_same_signal_after_a_reload);
	RUN_TEST(test_of_several_reloads_the_last_counts);
	RUN_TEST(test_a_welcome_that_is_lost_is_asked_for_by_another_connection);
	RUN_TEST(test_after_a_restart_the_controller_comes_back_with_its_token_and_beats);
	RUN_TEST(test_an_owsd_that_was_killed_and_hangs_up_on_nobody_is_left);
	RUN_TEST(test_a_controller_that_never_beat_comes_back_without_a_beat);
	RUN_TEST(test_while_nobody_listens_the_old_image_stays_readable);
	RUN_TEST(test_a_reader_that_asks_for_a_descriptor_is_woken_by_it);
	RUN_TEST(test_a_reader_that_is_refused_a_descriptor_goes_on_without);
	RUN_TEST(test_a_connected_sleeper_wakes_by_its_descriptor);
	RUN_TEST(test_a_descriptor_whose_owsd_has_ended_wakes_only_now_and_then);
	RUN_TEST(test_without_any_news_the_descriptor_wakes_by_itself);
	RUN_TEST(test_a_childs_copy_of_the_news_keeps_no_parent_awake);
	RUN_TEST(test_reopen_waits_for_the_new_image);
	RUN_TEST(test_reopen_of_what_is_present_changes_nothing);
	RUN_TEST(test_wait_returns_for_news_time_and_retirement);
	RUN_TEST(test_a_wait_does_not_spin_while_owsd_is_away);
	RUN_TEST(test_a_sleeper_wakes_for_news_and_for_retirement);
	RUN_TEST(test_open_refuses_what_is_not_ours);
	RUN_TEST(test_open_refuses_names_and_files_that_cannot_be);
	RUN_TEST(test_names_with_rubbish_offsets_end_nowhere);
	return UNITY_END();
}
