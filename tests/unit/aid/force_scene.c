/* SPDX-License-Identifier: MIT */
/* A scene with one output of each kind that starts and is lost in its own way. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "tests/unit/aid/force_scene.h"

struct scene s;

static const char *const paths[OUTPUTS] = {
	"/29.000000000001/PIO.0", "/29.000000000001/PIO.1", "/29.000000000001/PIO.2",
	"/29.000000000001/PIO.3", "/29.000000000001/PIO.4", "/29.000000000001/PIO.5",
	"/29.000000000001/PIO.6", "/29.000000000001/PIO.7",
};

static void outputs(void)
{
	static const char *const names[OUTPUTS] = {"plain", "init",      "safe",      "both",
	                                           "last",  "last_init", "last_safe", "last_both"};

	for (unsigned i = 0; i < OUTPUTS; i++) {
		struct config_item *item = scene_output(&s, names[i], paths[i], OWS_BYTE);

		item->has_init = i & 1;
		item->init_value = INIT;
		item->has_safe = i & 2;
		item->safe_value = SAFE;
		item->starts_last = i & 4;
		scene_put(&s, paths[i], "0", 0);
	}
}

void start_outputs(void)
{
	outputs();
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, SCENE_S);
}

void set_all(unsigned seat, int64_t value)
{
	for (unsigned i = 1; i <= OUTPUTS; i++)
		scene_set_by(&s, seat, i, value);
	scene_run(&s, 200 * SCENE_MS);
}

/* The last value that the trace has for this output. */
static int written(unsigned output)
{
	const char *at = s.trace, *found = NULL;
	char line[64];

	snprintf(line, sizeof(line), "W %s=", paths[output]);
	while ((at = strstr(at, line)) != NULL)
		found = at += strlen(line);
	return found ? atoi(found) : NOTHING;
}

static unsigned writes(unsigned output)
{
	unsigned n = 0;
	char line[64];

	snprintf(line, sizeof(line), "W %s=", paths[output]);
	for (const char *at = s.trace; (at = strstr(at, line)) != NULL; at++)
		n++;
	return n;
}

void expect_outputs(struct row row)
{
	const int want[OUTPUTS] = {row.plain, row.init,      row.safe,      row.both,
	                           row.last,  row.last_init, row.last_safe, row.last_both};
	char what[64];

	for (unsigned i = 0; i < OUTPUTS; i++) {
		snprintf(what, sizeof(what), "%s", s.items[i].name);
		TEST_ASSERT_EQUAL_INT_MESSAGE(want[i], written(i), what);
		TEST_ASSERT_LESS_OR_EQUAL_UINT_MESSAGE(1, writes(i), what);
	}
}

const struct row nothing = {NOTHING, NOTHING, NOTHING, NOTHING, NOTHING, NOTHING, NOTHING, NOTHING};
const struct row command = {NEXT, NEXT, NEXT, NEXT, NEXT, NEXT, NEXT, NEXT};
/* Nobody comes back: InitValue once, else nothing; last. */
const struct row ended = {NOTHING, INIT, NOTHING, INIT, NEXT, NEXT, NEXT, NEXT};
/* The controller is lost over a restart. */
const struct row lost = {NOTHING, INIT, SAFE, SAFE, NEXT, NEXT, SAFE, SAFE};
/* The controller is lost while owsd runs. */
const struct row lost_running = {NOTHING, NOTHING, SAFE, SAFE, NOTHING, NOTHING, SAFE, SAFE};

/* A controller at seat 1 with token 2 has set all. */
void controller_set_all(bool beats)
{
	start_outputs();
	scene_clear_trace(&s);
	scene_join(&s, 1, 2);
	if (beats)
		giving_beat(&s.controllers[1], BEAT_MS);
	set_all(1, NEXT);
	expect_outputs(command);
	scene_clear_trace(&s);
}

/* owsd is killed, or ends in order: for the next one that is the same. */
void restart_owsd(void)
{
	scene_restart(&s);
	scene_up(&s);
}

/* The controller connects again by its token, and beats, as ows_reopen() does. */
void come_back(void)
{
	s.controllers[1].stamp = 100; /* its stamps go on */
	scene_join(&s, 1, 2);
	giving_beat(&s.controllers[1], BEAT_MS);
}

void beat_on(int64_t ns)
{
	for (int64_t t = 0; t < ns; t += 100 * SCENE_MS) {
		giving_beat(&s.controllers[1], BEAT_MS);
		scene_run(&s, 100 * SCENE_MS);
	}
}
