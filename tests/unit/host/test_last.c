/* SPDX-License-Identifier: MIT */
/* Tests of NAME.last: what is put is on the disk, found again, and what fails is seen. */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "unity.h"

#include "hal/owfs/path.h"
#include "src/config/read/build.h"
#include "src/daemon/host/last.h"
#include "src/daemon/host/last_file.h"
#include "src/ground/signal/value.h"
#include "src/memory/shm/force.h"
#include "src/public/ows.h"

#define S 1000000000LL
/* What a busy machine may make of a store. */
#define PATIENCE (30 * S)

static struct config_item items[] = {
	{.name = "valve", .path = "/29.000000000001/PIO.0", .type = OWS_BOOL, .starts_last = true},
	{.name = "other", .path = "/29.000000000001/PIO.1", .type = OWS_BOOL},
	{.name = "level",
         .path = "/2C.000000000002/wiper",
         .type = OWS_DOUBLE,
         .starts_last = true},
	{.name = "text", .path = "/28.000000000003/alias", .type = OWS_STRING, .starts_last = true},
};
#define ITEMS (sizeof(items) / sizeof(items[0]))
static struct config config = {.items = items, .item_count = ITEMS};
static char folder[] = "/tmp/owsd-last-XXXXXX", state[64], file[96];
static uint32_t rings;

static void ring(void *ctx)
{
	(void)ctx;
	__atomic_fetch_add(&rings, 1, __ATOMIC_RELAXED);
}

void setUp(void)
{
	strcpy(folder, "/tmp/owsd-last-XXXXXX");
	TEST_ASSERT_NOT_NULL(mkdtemp(folder));
	snprintf(state, sizeof(state), "%s/state", folder);
	snprintf(file, sizeof(file), "%s/T.last", state);
	setenv("OWS_STATE_DIR", state, 1);
}

void tearDown(void)
{
	char command[96];

	snprintf(command, sizeof(command), "rm -rf %s", folder);
	TEST_ASSERT_EQUAL_INT(0, system(command));
}

static struct last *make(void)
{
	const struct last_setup setup = {.instance = "T", .config = &config, .ring = ring};
	struct last *last;

	TEST_ASSERT_EQUAL_INT(0, last_make(&setup, &last));
	TEST_ASSERT_NOT_NULL(last);
	return last;
}

static bool reached(const struct engine_last *seam, uint32_t ticket)
{
	return (int32_t)(seam->stored(seam->ctx) - ticket) >= 0;
}

static void await(const struct engine_last *seam, uint32_t ticket)
{
	int64_t until = ows_now() + PATIENCE;

	while (!reached(seam, ticket) && ows_now() < until)
		usleep(1000); /* pace */
	TEST_ASSERT_TRUE(reached(seam, ticket));
}

static int64_t bits(double number)
{
	int64_t value;

	memcpy(&value, &number, sizeof(value));
	return value;
}

/* Put all and end in order. */
static void store_all(void)
{
	struct last *last = make();
	const struct engine_last *seam = last_seam(last);

	TEST_ASSERT_EQUAL_INT(0, last_start(last));
	seam->put(seam->ctx, 0, 1, NULL, 0);
	seam->put(seam->ctx, 2, bits(0.1), NULL, 0);
	seam->put(seam->ctx, 3, 0, "a\tb\n\\c\x01", 8);
	TEST_ASSERT_TRUE(last_stop(last, PATIENCE));
	last_free(last);
}

static void expect_all(const struct engine_last *seam)
{
	char text[VALUE_STRING_MAX];
	int64_t value;
	uint32_t len;

	TEST_ASSERT_TRUE(seam->find(seam->ctx, 0, &value, text, sizeof(text), &len));
	TEST_ASSERT_EQUAL_INT64(1, value);
	TEST_ASSERT_TRUE(seam->find(seam->ctx, 2, &value, text, sizeof(text), &len));
	TEST_ASSERT_EQUAL_INT64(bits(0.1), value);
	TEST_ASSERT_TRUE(seam->find(seam->ctx, 3, &value, text, sizeof(text), &len));
	TEST_ASSERT_EQUAL_UINT32(8, len);
	TEST_ASSERT_EQUAL_MEMORY("a\tb\n\\c\x01", text, 8);
}

static void test_what_was_put_is_found_by_the_next_owsd(void)
{
	struct last *last;

	store_all();
	last = make();
	expect_all(last_seam(last));
	last_free(last);
}

static void test_what_was_put_is_found_under_another_name(void)
{
	static const char *const names[ITEMS] = {"tap", "other", "height", "label"};
	const char *before[ITEMS];
	struct last *last;

	store_all();
	for (unsigned i = 0; i < ITEMS; i++) {
		before[i] = items[i].name;
		items[i].name = names[i];
	}
	last = make();
	for (unsigned i = 0; i < ITEMS; i++)
		items[i].name = before[i];
	expect_all(last_seam(last));
	last_free(last);
}

/* What was of one that is still there is nobody else's. */
static void test_a_new_output_has_nothing_of_another_one_of_its_path(void)
{
	struct config_item both[] = {items[0], items[0]};
	const struct config two = {.items = both, .item_count = 2};
	const struct last_setup setup = {.instance = "T", .config = &two, .ring = ring};
	char text[VALUE_STRING_MAX];
	struct last *last;
	const struct engine_last *seam;
	int64_t value;
	uint32_t len;

	store_all();
	both[0].name = "new";
	both[1].starts_last = false;
	TEST_ASSERT_EQUAL_INT(0, last_make(&setup, &last));
	seam = last_seam(last);
	TEST_ASSERT_FALSE(seam->find(seam->ctx, 0, &value, text, sizeof(text), &len));
	last_free(last);
	both[1].starts_last = true;
	TEST_ASSERT_EQUAL_INT(0, last_make(&setup, &last));
	seam = last_seam(last);
	TEST_ASSERT_FALSE(seam->find(seam->ctx, 0, &value, text, sizeof(text), &len));
	TEST_ASSERT_TRUE(seam->find(seam->ctx, 1, &value, text, sizeof(text), &len));
	last_free(last);
}

static void test_nothing_is_found_at_first_and_of_outputs_that_are_not_last(void)
{
	struct config none = {.items = &items[1], .item_count = 1};
	const struct last_setup setup = {.instance = "T", .config = &none, .ring = ring};
	struct last *last = make();
	const struct engine_last *seam = last_seam(last);
	int64_t value;
	uint32_t len;
	char text[8];

	TEST_ASSERT_FALSE(seam->find(seam->ctx, 0, &value, text, sizeof(text), &len));
	last_free(last);
	TEST_ASSERT_EQUAL_INT(0, last_make(&setup, &last));
	TEST_ASSERT_NULL(last);
	TEST_ASSERT_NULL(last_seam(last));
}

static void test_a_ticket_is_reached_when_the_file_stands_and_the_engine_is_rung(void)
{
	struct last *last = make();
	const struct engine_last *seam = last_seam(last);
	uint32_t ticket, before = __atomic_load_n(&rings, __ATOMIC_RELAXED);
	struct stat st;

	ticket = seam->put(seam->ctx, 0, 1, NULL, 0);
	TEST_ASSERT_FALSE(reached(seam, ticket)); /* nobody stores yet */
	TEST_ASSERT_EQUAL_INT(0, last_start(last));
	await(seam, ticket);
	TEST_ASSERT_EQUAL_INT(0, stat(file, &st));
	TEST_ASSERT_EQUAL_HEX(0600, st.st_mode & 07777);
	TEST_ASSERT_TRUE(last_stop(last, PATIENCE));
	TEST_ASSERT_GREATER_THAN_UINT32(before, __atomic_load_n(&rings, __ATOMIC_RELAXED));
	/* what is there already needs no store */
	TEST_ASSERT_TRUE(reached(seam, seam->put(seam->ctx, 0, 1, NULL, 0)));
	last_free(last);
}

static void test_many_changes_are_stored_at_once_and_no_more_than_once_a_second(void)
{
	struct last *last = make();
	const struct engine_last *seam = last_seam(last);
	uint32_t before, ticket = 0;
	int64_t began;

	TEST_ASSERT_EQUAL_INT(0, last_start(last));
	before = __atomic_load_n(&rings, __ATOMIC_RELAXED);
	began = ows_now();
	for (int i = 1; i <= 10000; i++)
		ticket = seam->put(seam->ctx, 2, bits(i), NULL, 0);
	await(seam, ticket);
	TEST_ASSERT_LESS_OR_EQUAL_UINT32(2 + (uint32_t)((ows_now() - began) / S),
	                                 __atomic_load_n(&rings, __ATOMIC_RELAXED) - before);
	TEST_ASSERT_TRUE(last_stop(last, PATIENCE));
	last_free(last);
}

static void test_a_directory_that_cannot_be_written_is_an_error_until_it_can(void)
{
	struct last *last = make();
	const struct engine_last *seam = last_seam(last);
	int64_t until = ows_now() + PATIENCE;
	uint32_t ticket;

	TEST_ASSERT_EQUAL_INT(0, rmdir(state));
	close(open(state, O_CREAT | O_WRONLY, 0600)); /* a file in its place */
	TEST_ASSERT_EQUAL_INT(0, last_start(last));
	ticket = seam->put(seam->ctx, 0, 1, NULL, 0);
	while (!seam->error(seam->ctx) && ows_now() < until)
		usleep(1000); /* pace */
	TEST_ASSERT_LESS_THAN_INT(0, seam->error(seam->ctx));
	TEST_ASSERT_FALSE(reached(seam, ticket));
	TEST_ASSERT_GREATER_THAN_UINT64(0, last_failures(last));
	TEST_ASSERT_EQUAL_INT(0, unlink(state));
	await(seam, ticket);
	TEST_ASSERT_EQUAL_INT(0, seam->error(seam->ctx));
	TEST_ASSERT_TRUE(last_stop(last, PATIENCE));
	last_free(last);
}

static void test_a_directory_that_others_may_write_into_is_refused(void)
{
	struct last *last;
	const struct engine_last *seam;
	int64_t value;
	uint32_t len;
	char text[VALUE_STRING_MAX];

	store_all();
	TEST_ASSERT_EQUAL_INT(0, chmod(state, 0777));
	last = make();
	seam = last_seam(last);
	TEST_ASSERT_FALSE(seam->find(seam->ctx, 0, &value, text, sizeof(text), &len));
	last_free(last);
}

/* Each byte in turn is another; and the file ends anywhere. */
static void test_a_damaged_file_is_nothing(void)
{
	char text[4096], damaged[4096], found_text[VALUE_STRING_MAX];
	FILE *f;
	size_t n;

	store_all();
	f = fopen(file, "rb");
	TEST_ASSERT_NOT_NULL(f);
	n = fread(text, 1, sizeof(text), f);
	fclose(f);
	TEST_ASSERT_LESS_THAN(sizeof(text), n);
	for (size_t i = 0; i < 2 * n; i++) {
		struct last *last;
		const struct engine_last *seam;
		int64_t value;
		uint32_t len;

		memcpy(damaged, text, n);
		if (i < n)
			damaged[i] ^= 1;
		f = fopen(file, "wb");
		fwrite(damaged, 1, i < n ? n : i - n, f);
		fclose(f);
		last = make();
		seam = last_seam(last);
		for (uint32_t row = 0; row < ITEMS; row++)
			if (items[row].starts_last)
				TEST_ASSERT_FALSE(seam->find(seam->ctx, row, &value, found_text,
				                             sizeof(found_text), &len));
		last_free(last);
	}
}

static void test_the_length_of_a_number_s_text_is_no_change(void)
{
	struct last *last = make();
	const struct engine_last *seam = last_seam(last);
	uint32_t ticket = seam->put(seam->ctx, 0, 1, NULL, 0);

	TEST_ASSERT_EQUAL_UINT32(ticket, seam->put(seam->ctx, 0, 1, NULL, 3));
	TEST_ASSERT_NOT_EQUAL_UINT32(ticket, seam->put(seam->ctx, 0, 0, NULL, 3));
	ticket = seam->put(seam->ctx, 3, 0, "ab", 2);
	TEST_ASSERT_EQUAL_UINT32(ticket, seam->put(seam->ctx, 3, 0, "ab", 2));
	TEST_ASSERT_NOT_EQUAL_UINT32(ticket, seam->put(seam->ctx, 3, 0, "ab", 1));
	last_free(last);
}

static void test_what_as_many_strings_as_owsd_takes_need_is_written_and_read(void)
{
	static struct force_signal signals[CONFIG_ITEMS_MAX];
	static char name[256], path[PATH_LEN_MAX + 1];
	struct force_plan plan = {.signals = signals,
	                          .signal_count = CONFIG_ITEMS_MAX,
	                          .text_cap = VALUE_STRING_MAX,
	                          .stored = true};

	memset(name, 'n', sizeof(name) - 1);
	memset(path, 'p', sizeof(path) - 1);
	for (unsigned i = 0; i < CONFIG_ITEMS_MAX; i++)
		signals[i] = (struct force_signal){name, path, OWS_STRING};
	TEST_ASSERT_GREATER_THAN_size_t((size_t)64 << 20, force_size(&plan));
	TEST_ASSERT_LESS_THAN_size_t(LAST_MAX - LAST_CHECK, force_size(&plan));
}

static void test_a_file_is_written_only_if_it_is_read_again(void)
{
	const size_t size = (size_t)65 << 20;
	char path[LAST_WHERE], *data = calloc(1, size + LAST_CHECK), *back;
	int directory = last_directory(path), fd;
	uint32_t check;
	size_t got;

	TEST_ASSERT_NOT_NULL(data);
	TEST_ASSERT_GREATER_OR_EQUAL_INT(0, directory);
	/* as last_write() leaves it, with holes: no disk has to take all of it */
	check = ows_check_bytes(data, size);
	fd = openat(directory, "T.last", O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
	TEST_ASSERT_EQUAL_INT(LAST_CHECK, pwrite(fd, &check, LAST_CHECK, (off_t)size));
	TEST_ASSERT_EQUAL_INT(0, close(fd));
	TEST_ASSERT_EQUAL_INT(0, last_read(directory, "T", &back, &got));
	TEST_ASSERT_EQUAL_size_t(size, got);
	TEST_ASSERT_EQUAL_INT(-EFBIG, last_write(directory, "T", data, LAST_MAX - LAST_CHECK + 1));
	TEST_ASSERT_EQUAL_INT(0, close(directory));
	free(back);
	free(data);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_what_was_put_is_found_by_the_next_owsd);
	RUN_TEST(test_what_was_put_is_found_under_another_name);
	RUN_TEST(test_a_new_output_has_nothing_of_another_one_of_its_path);
	RUN_TEST(test_nothing_is_found_at_first_and_of_outputs_that_are_not_last);
	RUN_TEST(test_a_ticket_is_reached_when_the_file_stands_and_the_engine_is_rung);
	RUN_TEST(test_many_changes_are_stored_at_once_and_no_more_than_once_a_second);
	RUN_TEST(test_a_directory_that_cannot_be_written_is_an_error_until_it_can);
	RUN_TEST(test_a_directory_that_others_may_write_into_is_refused);
	RUN_TEST(test_a_damaged_file_is_nothing);
	RUN_TEST(test_the_length_of_a_number_s_text_is_no_change);
	RUN_TEST(test_what_as_many_strings_as_owsd_takes_need_is_written_and_read);
	RUN_TEST(test_a_file_is_written_only_if_it_is_read_again);
	return UNITY_END();
}
