/* SPDX-License-Identifier: MIT */
/* Tests of NAME.force: what is written is found after a kill; what is damaged is refused. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "src/memory/shm/force.h"
#include "src/public/ows.h"

#define TEXT_CAP 64
#define BOOT 7

static const struct force_signal signals[] = {
	{"valve", "/29.000000000001/PIO.0", OWS_BOOL},
	{"level", "/2C.000000000002/wiper", OWS_DOUBLE},
	{"name", "/28.000000000003/alias", OWS_STRING},
	{"valve", "/29.000000000001/PIO.1", OWS_BOOL},
};
#define SIGNALS (sizeof(signals) / sizeof(signals[0]))

static struct force_plan plan;
static struct force force;
static char *memory;
static size_t size;

void setUp(void)
{
	plan = (struct force_plan){signals, SIGNALS, TEXT_CAP, BOOT};
	size = force_size(&plan);
	memory = calloc(1, size);
	force_build(&plan, memory, &force);
}

void tearDown(void)
{
	free(memory);
}

static struct force_controller program(uint32_t serial)
{
	struct force_controller g = {
		.who = {.serial = serial, .uid = 1000, .pid = 42, .name = "plc"}, .period_ms = 500};

	memset(g.token, (int)serial, sizeof(g.token));
	return g;
}

static bool find(const struct force_left *left, unsigned i, struct force_command *c, char *text)
{
	return force_find(left, &signals[i], c, text, TEXT_CAP);
}

static void expect_nothing_in_force(const struct force_left *left)
{
	struct force_command c;
	char text[TEXT_CAP];

	for (unsigned i = 0; i < SIGNALS; i++) {
		TEST_ASSERT_TRUE(find(left, i, &c, text));
		TEST_ASSERT_FALSE(c.given);
	}
}

static void test_at_first_no_command_is_in_force(void)
{
	struct force_left left;
	struct force_controller g;

	TEST_ASSERT_EQUAL_INT(0, force_open(memory, size, BOOT, &left));
	expect_nothing_in_force(&left);
	for (uint32_t i = 0; i < FORCE_CONTROLLERS; i++)
		TEST_ASSERT_FALSE(force_find_controller(&left, i, &g));
	force_close(&left);
}

static void test_what_was_put_is_found_by_name_path_and_type(void)
{
	const struct force_command number = {.value = 5,
	                                     .stamp = 9,
	                                     .given = true,
	                                     .safe = true,
	                                     .applied = true,
	                                     .controller = 3};
	const struct force_command string = {.len = 6, .given = true, .controller = FORCE_NOBODY};
	const struct force_signal other_type = {"valve", "/29.000000000001/PIO.0", OWS_BYTE};
	const struct force_controller controller = program(77);
	struct force_controller found;
	struct force_command c;
	struct force_left left;
	char text[TEXT_CAP];

	force_controller(&force, 3, &controller);
	force_put(&force, 0, &number, NULL);
	force_put(&force, 2, &string, "boiler");
	TEST_ASSERT_EQUAL_INT(0, force_open(memory, size, BOOT, &left));
	TEST_ASSERT_TRUE(find(&left, 0, &c, text));
	TEST_ASSERT_TRUE(c.given && c.safe && c.applied);
	TEST_ASSERT_EQUAL_INT64(5, c.value);
	TEST_ASSERT_EQUAL_UINT32(9, c.stamp);
	TEST_ASSERT_EQUAL_UINT32(3, c.controller);
	TEST_ASSERT_TRUE(force_find_controller(&left, 3, &found));
	TEST_ASSERT_EQUAL_MEMORY(&controller, &found, sizeof(found));
	TEST_ASSERT_TRUE(find(&left, 2, &c, text));
	TEST_ASSERT_FALSE(c.applied);
	TEST_ASSERT_EQUAL_UINT32(6, c.len);
	TEST_ASSERT_EQUAL_MEMORY("boiler", text, 6);
	TEST_ASSERT_TRUE(find(&left, 3, &c, text));
	TEST_ASSERT_FALSE(c.given);
	TEST_ASSERT_FALSE(force_find(&left, &other_type, &c, text, sizeof(text)));
	force_close(&left);
}

/* What a configuration has in the place of "level" and of one "valve". */
static const struct force_signal renamed[] = {
	{"height", "/2C.000000000002/wiper", OWS_DOUBLE},
	{"tap", "/29.000000000001/PIO.0", OWS_BOOL},
};

static void test_a_signal_that_was_renamed_has_what_its_old_name_left(void)
{
	const struct force_signal other_type = {"height", "/2C.000000000002/wiper", OWS_FLOAT};
	struct force_command c = {.value = 5, .given = true, .controller = FORCE_NOBODY};
	struct force_left left;
	char text[TEXT_CAP];

	force_put(&force, 1, &c, NULL);
	TEST_ASSERT_EQUAL_INT(0, force_open(memory, size, BOOT, &left));
	force_keep(&left, &signals[0]);
	force_keep(&left, &renamed[0]); /* nobody left anything by that name */
	TEST_ASSERT_FALSE(force_find(&left, &other_type, &c, text, sizeof(text)));
	TEST_ASSERT_TRUE(force_find(&left, &renamed[0], &c, text, sizeof(text)));
	TEST_ASSERT_TRUE(c.given);
	TEST_ASSERT_EQUAL_INT64(5, c.value);
	force_close(&left);
}

static void test_a_new_signal_has_nothing_of_one_that_is_still_there(void)
{
	struct force_command c;
	struct force_left left;
	char text[TEXT_CAP];

	TEST_ASSERT_EQUAL_INT(0, force_open(memory, size, BOOT, &left));
	for (unsigned i = 0; i < SIGNALS; i++)
		force_keep(&left, &signals[i]);
	TEST_ASSERT_FALSE(force_find(&left, &renamed[0], &c, text, sizeof(text)));
	TEST_ASSERT_FALSE(force_find(&left, &renamed[1], &c, text, sizeof(text)));
	force_close(&left);
}

static void test_of_two_that_may_have_been_renamed_none_is_taken(void)
{
	const struct force_signal three[] = {
		{"a", "/29.000000000001/PIO.0", OWS_BOOL},
		{"b", "/29.000000000001/PIO.0", OWS_BOOL},
		{"c", "/29.000000000001/PIO.0", OWS_BOOL},
	};
	const struct force_plan doubled = {three, 3, TEXT_CAP, BOOT};
	struct force_command c = {.given = true, .controller = FORCE_NOBODY};
	char *file = calloc(1, force_size(&doubled)), text[TEXT_CAP];
	struct force_left left;
	struct force of;

	force_build(&doubled, file, &of);
	for (uint32_t i = 0; i < 3; i++) {
		c.value = i;
		force_put(&of, i, &c, NULL);
	}
	TEST_ASSERT_EQUAL_INT(0, force_open(file, force_size(&doubled), BOOT, &left));
	force_keep(&left, &three[1]);
	TEST_ASSERT_FALSE(force_find(&left, &renamed[1], &c, text, sizeof(text)));
	force_keep(&left, &three[0]);
	TEST_ASSERT_TRUE(force_find(&left, &renamed[1], &c, text, sizeof(text)));
	TEST_ASSERT_EQUAL_INT64(2, c.value);
	force_close(&left);
	free(file);
}

static void test_a_command_does_not_fall_to_the_next_controller_of_the_index(void)
{
	const struct force_command command = {.value = 1, .given = true, .controller = 3};
	struct force_controller controller = program(77);
	struct force_command c;
	struct force_left left;
	char text[TEXT_CAP];

	force_controller(&force, 3, &controller);
	force_put(&force, 0, &command, NULL);
	controller = program(78);
	force_controller(&force, 3, &controller);
	TEST_ASSERT_EQUAL_INT(0, force_open(memory, size, BOOT, &left));
	TEST_ASSERT_TRUE(find(&left, 0, &c, text));
	TEST_ASSERT_TRUE(c.given);
	TEST_ASSERT_EQUAL_UINT32(FORCE_NOBODY, c.controller);
	force_close(&left);
}

/*
 * A kill between any two stores: as the words change in their order, the file at each moment has
 * either the command before or the one after.
 */
static void test_a_kill_at_any_moment_leaves_the_old_or_the_new_command(void)
{
	struct force_command c = {.value = 1, .len = 3, .given = true, .controller = FORCE_NOBODY};
	char *before = malloc(size), *half = malloc(size);
	struct force_left left;
	char text[TEXT_CAP];

	force_put(&force, 2, &c, "old");
	memcpy(before, memory, size);
	c.len = 5;
	force_put(&force, 2, &c, "newer");
	/* all that changed but the count, up to any word of it */
	for (size_t cut = 0; cut <= size; cut += 4) {
		memcpy(half, memory, cut);
		memcpy(half + cut, before + cut, size - cut);
		/* seq of row 2 is written last: only the whole has the new one */
		if (cut < size)
			memcpy(half + 64 + 2 * 112, before + 64 + 2 * 112, 4);
		TEST_ASSERT_EQUAL_INT(0, force_open(half, size, BOOT, &left));
		TEST_ASSERT_TRUE(find(&left, 2, &c, text));
		TEST_ASSERT_EQUAL_UINT32(cut < size ? 3 : 5, c.len);
		TEST_ASSERT_EQUAL_MEMORY(cut < size ? "old" : "newer", text, c.len);
		force_close(&left);
	}
	free(before);
	free(half);
}

static void test_what_another_boot_left_is_not_in_force(void)
{
	struct force_left left;

	TEST_ASSERT_EQUAL_INT(-ESTALE, force_open(memory, size, BOOT + 1, &left));
	force_close(&left);
}

static void test_a_file_of_another_size_or_kind_is_refused(void)
{
	struct force_left left;

	for (size_t cut = 0; cut < size; cut += size / 50 + 1)
		TEST_ASSERT_EQUAL_INT(-EPROTO, force_open(memory, cut, BOOT, &left));
	memset(memory, 0, size);
	TEST_ASSERT_EQUAL_INT(-EPROTO, force_open(memory, size, BOOT, &left));
}

/* Flip bits in copies on the heap, where a sanitizer sees each step outside. */
static void test_a_damaged_file_is_refused_or_changes_nothing(void)
{
	const struct force_command number = {.value = 5, .given = true, .controller = 3};
	const struct force_command string = {.len = 6, .given = true, .controller = FORCE_NOBODY};
	const struct force_controller controller = program(77);
	unsigned refused = 0;

	force_controller(&force, 3, &controller);
	force_put(&force, 1, &number, NULL);
	force_put(&force, 2, &string, "boiler");
	srand(1);
	for (int round = 0; round < 4000; round++) {
		char *copy = malloc(size), text[TEXT_CAP];
		struct force_left left;
		struct force_command c;
		struct force_controller g;

		memcpy(copy, memory, size);
		for (int n = 0; n <= round % 3; n++) {
			size_t at = (size_t)rand() % (round & 1 ? 600 : size);

			copy[at] = (char)(copy[at] ^ (1 << rand() % 8));
		}
		if (force_open(copy, size, BOOT, &left)) {
			refused++;
		} else {
			for (unsigned i = 0; i < SIGNALS; i++)
				if (find(&left, i, &c, text) && c.given && i == 1)
					TEST_ASSERT_EQUAL_INT64(5, c.value);
			for (uint32_t i = 0; i < FORCE_CONTROLLERS; i++)
				force_find_controller(&left, i, &g);
			force_close(&left);
		}
		free(copy);
	}
	TEST_ASSERT_GREATER_THAN_UINT(1000, refused);
}

static unsigned long compared;

/* In the place of libc's: the compares of names and paths are the steps of a search. */
int strcmp(const char *a, const char *b)
{
	compared++;
	while (*a && *a == *b) {
		a++;
		b++;
	}
	return (unsigned char)*a - (unsigned char)*b;
}

/* In the order that is worst for a search from a guess on. */
static void test_ten_thousand_signals_are_found_in_the_steps_of_a_sort(void)
{
	enum { MANY = 10000 };
	struct force_signal *many = calloc(MANY, sizeof(*many));
	char(*names)[32] = calloc(MANY, sizeof(*names));
	struct force_plan big = {many, MANY, TEXT_CAP, BOOT};
	struct force_command c = {.given = true, .controller = FORCE_NOBODY};
	struct force_left left;
	struct force of;
	char text[TEXT_CAP], *file;

	for (unsigned i = 0; i < MANY; i++) {
		snprintf(names[i], sizeof(names[i]), "signal%u", i);
		many[i] = (struct force_signal){names[i], "/29.000000000001/PIO.0", OWS_BOOL};
	}
	file = calloc(1, force_size(&big));
	force_build(&big, file, &of);
	for (unsigned i = 0; i < MANY; i++) {
		c.value = i;
		force_put(&of, i, &c, NULL);
	}
	compared = 0;
	TEST_ASSERT_EQUAL_INT(0, force_open(file, force_size(&big), BOOT, &left));
	for (unsigned i = MANY; i-- > 0;)
		force_keep(&left, &many[i]);
	for (unsigned i = MANY; i-- > 0;) {
		TEST_ASSERT_TRUE(force_find(&left, &many[i], &c, text, sizeof(text)));
		TEST_ASSERT_EQUAL_INT64(i, c.value);
	}
	/*
	 * a search through all compares 5000 times for each signal, a sort and its search 40 times
	 */
	TEST_ASSERT_GREATER_THAN(10 * MANY, compared);
	TEST_ASSERT_LESS_THAN(100 * MANY, compared);
	force_close(&left);
	free(file);
	free(names);
	free(many);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_at_first_no_command_is_in_force);
	RUN_TEST(test_what_was_put_is_found_by_name_path_and_type);
	RUN_TEST(test_a_signal_that_was_renamed_has_what_its_old_name_left);
	RUN_TEST(test_a_new_signal_has_nothing_of_one_that_is_still_there);
	RUN_TEST(test_of_two_that_may_have_been_renamed_none_is_taken);
	RUN_TEST(test_a_command_does_not_fall_to_the_next_controller_of_the_index);
	RUN_TEST(test_a_kill_at_any_moment_leaves_the_old_or_the_new_command);
	RUN_TEST(test_what_another_boot_left_is_not_in_force);
	RUN_TEST(test_a_file_of_another_size_or_kind_is_refused);
	RUN_TEST(test_a_damaged_file_is_refused_or_changes_nothing);
	RUN_TEST(test_ten_thousand_signals_are_found_in_the_steps_of_a_sort);
	return UNITY_END();
}
