/* SPDX-License-Identifier: MIT */
/* The rules of docs/semantics.md, "Several targets", laid beside the functions that follow them. */
#include <stdio.h>

#include "unity.h"

#include "src/daemon/engine/routing/route.h"

#define S 1000000000LL
#define NOW (1000 * S)

void setUp(void)
{
}
void tearDown(void)
{
}

/* --- A comma --------------------------------------------------------------------------------- */

static struct known_presence known[3];
static struct route_group groups[3];

/* "P?F-": presence on each group, "UD.": state of each, since long ago. */
static void facts(const char *presence, const char *state)
{
	for (unsigned g = 0; g < 3 && presence[g]; g++) {
		known[g].presence = presence[g] == 'P'   ? ROUTE_PRESENT
		                    : presence[g] == 'F' ? ROUTE_FAILING
		                    : presence[g] == '-' ? ROUTE_ABSENT
		                                         : ROUTE_UNKNOWN;
		known[g].since_ns = NOW - 100 * S;
		groups[g].state = state[g] == 'U'   ? ROUTE_UP
		                  : state[g] == 'D' ? ROUTE_DOWN
		                                    : ROUTE_OPENING;
		groups[g].since_ns = NOW - 100 * S;
	}
}

static unsigned choice(unsigned count, unsigned current)
{
	return route_device(known, groups, count, current, NOW - 100 * S, NOW).group;
}

static void test_the_rules_of_a_comma(void)
{
	static const struct {
		const char *presence, *state;
		unsigned current, then;
	} rows[] = {
		/* unknown counts as present until the first try */
		{"???", "UUU", 0, 0},
		{"?P?", "UUU", 0, 0},
		{"???", "...", 0, 0},
		/* absent: the next that may have it */
		{"-??", "UUU", 0, 1},
		{"-?P", "UUU", 0, 1},
		{"--P", "UUU", 0, 2},
		{"-??", "UDU", 0, 2},
		{"-P?", "U.U", 0, 2},
		{"--?", "UUU", 1, 2},
		{"?--", "UUU", 2, 0},
		{"P--", "DUU", 2, 1},
		/* absent everywhere: the first that is up */
		{"---", "UUU", 2, 0},
		{"---", "DUU", 2, 1},
		{"---", "DDU", 2, 2},
		{"---", "UUU", 0, 0},
		{"-??", "UDD", 0, 0},
		/* its target is down: stays, unless nothing is known of it there */
		{"P??", "DUU", 0, 0},
		{"PP?", "DUU", 0, 0},
		{"???", "DUU", 0, 1},
		{"?-P", "DUU", 0, 2},
		{"?--", "DUU", 0, 0},
		{"?P?", ".UU", 0, 0},
		/* failing: to one that has it too, and only then */
		{"FP?", "UUU", 0, 1},
		{"F?P", "UUU", 0, 2},
		{"F??", "UUU", 0, 0},
		{"F--", "UUU", 0, 0},
		{"FP?", "UDU", 0, 0},
		{"FFF", "UUU", 1, 1},
		{"FFP", "UUU", 1, 2},
		{"FP?", "UUU", 1, 1},
		/* failing is better than absent, and than down where nothing was good */
		{"F--", "UUU", 2, 0},
		{"F-?", "UUU", 1, 2},
		{"F?-", "DUU", 0, 1},
		{"FF-", "DUU", 0, 1},
		{"F?P", "U.D", 0, 0},
		/* back to an earlier one: by evidence only */
		{"?P?", "UUU", 1, 1},
		{"PP?", "UUU", 1, 0},
		{"PP?", "DUU", 1, 1},
		{"-P?", "UUU", 1, 1},
		{"P?P", "UUU", 2, 0},
		{"?PP", "UUU", 2, 1},
		{"PPP", "UUU", 0, 0},
	};

	for (unsigned i = 0; i < sizeof(rows) / sizeof(rows[0]); i++) {
		char message[64];

		facts(rows[i].presence, rows[i].state);
		snprintf(message, sizeof(message), "%s %s at %u", rows[i].presence, rows[i].state,
		         rows[i].current);
		TEST_ASSERT_EQUAL_UINT_MESSAGE(rows[i].then, choice(3, rows[i].current), message);
	}
}

static void spell(unsigned code, char presence[4], char state[4])
{
	for (unsigned g = 0; g < 3; g++, code /= 12) {
		presence[g] = "?PF-"[code % 4];
		state[g] = ".UD"[code / 4 % 3];
	}
	presence[3] = state[3] = '\0';
}

/* All 64 * 27 facts of three groups, from each: what no choice may do. */
static void test_no_choice_breaks_a_promise(void)
{
	for (unsigned code = 0; code < 1728; code++)
		for (unsigned current = 0; current < 3; current++) {
			char presence[4], state[4], message[64];
			unsigned then;

			spell(code, presence, state);
			facts(presence, state);
			then = choice(3, current);
			snprintf(message, sizeof(message), "%s %s from %u to %u", presence, state,
			         current, then);
			/* it settles: the same facts do not move it again */
			TEST_ASSERT_EQUAL_UINT_MESSAGE(then, choice(3, then), message);
			if (then == current)
				continue;
			TEST_ASSERT_EQUAL_CHAR_MESSAGE('U', state[then], message);
			/* a device that is or may be where it is leaves for good evidence only */
			if (presence[current] == 'P' ||
			    (presence[current] == '?' && state[current] != 'D'))
				TEST_ASSERT_TRUE_MESSAGE(then < current && presence[then] == 'P',
				                         message);
			/* one that fails leaves a target that is up for a claim alone */
			if (presence[current] == 'F' && state[current] != 'D')
				TEST_ASSERT_TRUE_MESSAGE(presence[then] == 'P', message);
			/*
			 * nowhere is it taken to a target where it fails, but for want of another
			 */
			for (unsigned g = 0; presence[then] == 'F' && g < 3; g++)
				TEST_ASSERT_FALSE_MESSAGE(
					g != current && state[g] == 'U' &&
						(presence[g] == 'P' || presence[g] == '?'),
					message);
			/* and to where it is absent only if it is so everywhere */
			for (unsigned g = 0; presence[then] == '-' && g < 3; g++)
				TEST_ASSERT_FALSE_MESSAGE(state[g] == 'U' && presence[g] != '-',
				                          message);
		}
}

static void test_a_return_waits_for_the_latest_of_three(void)
{
	facts("PPP", "UUU");
	known[0].since_ns = NOW - 3 * S;
	TEST_ASSERT_EQUAL_INT64(NOW + 7 * S, route_device(known, groups, 2, 1, 0, NOW).again_ns);
	groups[0].since_ns = NOW - 2 * S;
	TEST_ASSERT_EQUAL_INT64(NOW + 8 * S, route_device(known, groups, 2, 1, 0, NOW).again_ns);
	TEST_ASSERT_EQUAL_INT64(NOW + 9 * S,
	                        route_device(known, groups, 2, 1, NOW - S, NOW).again_ns);
	TEST_ASSERT_EQUAL_UINT(1, route_device(known, groups, 2, 1, NOW - S, NOW).group);
	TEST_ASSERT_EQUAL_UINT(0, route_device(known, groups, 2, 1, NOW - S, NOW + 9 * S).group);
	TEST_ASSERT_EQUAL_INT64(INT64_MAX, route_device(known, groups, 2, 0, 0, NOW).again_ns);
}

static void test_a_path_without_a_device_follows_the_targets_alone(void)
{
	facts("???", "UUU");
	TEST_ASSERT_EQUAL_UINT(0, route_path(groups, 3, 0, NOW).group);
	TEST_ASSERT_EQUAL_UINT(0, route_path(groups, 3, 2, NOW).group);
	facts("???", "D.U");
	TEST_ASSERT_EQUAL_UINT(2, route_path(groups, 3, 0, NOW).group);
	facts("???", ".UU");
	TEST_ASSERT_EQUAL_UINT(0, route_path(groups, 3, 0, NOW).group);
	facts("???", "DDD");
	TEST_ASSERT_EQUAL_UINT(1, route_path(groups, 3, 1, NOW).group);
	facts("???", "UUU");
	groups[0].since_ns = NOW - 4 * S;
	TEST_ASSERT_EQUAL_UINT(1, route_path(groups, 2, 1, NOW).group);
	TEST_ASSERT_EQUAL_INT64(NOW + 6 * S, route_path(groups, 2, 1, NOW).again_ns);
}

static void test_a_lost_device_is_looked_for_on_the_other_targets_in_turn(void)
{
	facts("---", "UUU");
	TEST_ASSERT_EQUAL_INT(1, route_probe(known, groups, 3, 0, 0));
	TEST_ASSERT_EQUAL_INT(2, route_probe(known, groups, 3, 0, 1));
	TEST_ASSERT_EQUAL_INT(1, route_probe(known, groups, 3, 0, 2));
	facts("---", "UDU");
	TEST_ASSERT_EQUAL_INT(2, route_probe(known, groups, 3, 0, 2));
	facts("---", "UDD");
	TEST_ASSERT_EQUAL_INT(-1, route_probe(known, groups, 3, 0, 2));
	/* one that fails too */
	facts("F?-", "UUU");
	TEST_ASSERT_EQUAL_INT(1, route_probe(known, groups, 3, 0, 0));
	TEST_ASSERT_EQUAL_INT(2, route_probe(known, groups, 3, 0, 1));
	facts("FP-", "UUU");
	TEST_ASSERT_EQUAL_INT(-1, route_probe(known, groups, 3, 1, 0));
	/* one that is served is asked for only where an earlier target was never tried */
	facts("P?-", "UUU");
	TEST_ASSERT_EQUAL_INT(-1, route_probe(known, groups, 3, 0, 0));
	facts("?-P", "UUU");
	TEST_ASSERT_EQUAL_INT(0, route_probe(known, groups, 3, 2, 0));
	facts("--P", "UUU");
	TEST_ASSERT_EQUAL_INT(-1, route_probe(known, groups, 3, 2, 0));
	/* nor one whose target is only out of reach */
	facts("P--", "DUU");
	TEST_ASSERT_EQUAL_INT(-1, route_probe(known, groups, 3, 0, 0));
}

/* --- A bar ----------------------------------------------------------------------------------- */

static struct route_bar bar;
static struct route_way ways[3];
static int64_t now;

static void bar_of(unsigned count)
{
	now = NOW;
	route_bar_init(&bar, count, 20 * S, now);
	for (unsigned w = 0; w < 3; w++)
		ways[w] = (struct route_way){.released = w > 0};
}

/* What the engine does with a step, where each way lets go after `turn` and then is up or not. */
static struct route_step take(void)
{
	struct route_step step = route_bar(&bar, ways, now);
	unsigned leaving = bar.open;

	route_bar_took(&bar, ways, &step, now);
	if (step.act == ROUTE_LEAVE)
		ways[leaving] = (struct route_way){.released = false};
	if (step.act == ROUTE_OPEN)
		ways[step.way] = (struct route_way){.released = false};
	return step;
}

static void up(unsigned way)
{
	ways[way].up = true;
	ways[way].failed = false;
	ways[way].up_ns = now;
}

static void down(unsigned way)
{
	ways[way].up = false;
	ways[way].failed = true;
	ways[way].failed_ns = now;
}

static void back(unsigned way)
{
	ways[way].back = true;
	ways[way].back_ns = now;
}

/* To the next way, all done. */
static void change_to(unsigned way)
{
	struct route_step step = take();

	TEST_ASSERT_EQUAL_INT(ROUTE_LEAVE, step.act);
	TEST_ASSERT_EQUAL_UINT(way, step.way);
	TEST_ASSERT_NOT_NULL(step.why);
	ways[bar.leaving].released = true;
	TEST_ASSERT_EQUAL_INT(ROUTE_OPEN, take().act);
	TEST_ASSERT_EQUAL_UINT(way, bar.open);
}

static void stays(void)
{
	TEST_ASSERT_EQUAL_INT(ROUTE_STAY, take().act);
}

static void test_a_way_that_works_stays_open(void)
{
	bar_of(3);
	TEST_ASSERT_EQUAL_INT(ROUTE_OPENING, route_bar_state(&bar, ways, now));
	TEST_ASSERT_EQUAL_INT64(NOW + 20 * S, route_bar(&bar, ways, now).again_ns);
	up(0);
	stays();
	now += 100000 * S;
	back(1);
	back(2);
	stays();
	TEST_ASSERT_EQUAL_INT64(INT64_MAX, route_bar(&bar, ways, now).again_ns);
	TEST_ASSERT_EQUAL_INT(ROUTE_UP, route_bar_state(&bar, ways, now));
}

static void test_the_next_way_is_opened_when_the_one_before_has_let_go(void)
{
	bar_of(2);
	up(0);
	down(0);
	TEST_ASSERT_EQUAL_INT(ROUTE_DOWN, route_bar_state(&bar, ways, now));
	TEST_ASSERT_EQUAL_INT(ROUTE_LEAVE, take().act);
	TEST_ASSERT_EQUAL_INT(ROUTE_OPENING, route_bar_state(&bar, ways, now));
	now += 4 * S;
	stays();
	TEST_ASSERT_EQUAL_INT64(now + S, route_bar(&bar, ways, now).again_ns);
	ways[0].released = true;
	TEST_ASSERT_EQUAL_INT(ROUTE_OPEN, take().act);
	/* or when its time is over */
	bar_of(2);
	down(0);
	take();
	now += 5 * S;
	TEST_ASSERT_EQUAL_INT(ROUTE_OPEN, take().act);
}

static void test_a_way_that_says_nothing_has_failed(void)
{
	bar_of(2);
	now += 20 * S - 1;
	stays();
	now++;
	TEST_ASSERT_EQUAL_INT(ROUTE_DOWN, route_bar_state(&bar, ways, now));
	change_to(1);
}

static void test_the_first_round_takes_no_time_and_the_next_ones_more_and_more(void)
{
	static const int64_t wait[] = {0, 0, 1, 1,  1,  2,  2,  2,  4,  4, 4,
	                               8, 8, 8, 16, 16, 16, 30, 30, 30, 30};

	bar_of(3);
	for (unsigned i = 0; i < sizeof(wait) / sizeof(wait[0]); i++) {
		down(bar.open);
		if (wait[i]) {
			now += wait[i] * S - 1;
			stays();
			now++;
		}
		change_to((bar.open + 1) % 3);
	}
}

static void test_a_target_that_is_seen_shortens_the_wait(void)
{
	bar_of(2);
	for (unsigned i = 0; i < 20; i++) {
		down(bar.open);
		now += 30 * S;
		change_to(1 - bar.open);
	}
	back(1 - bar.open);
	down(bar.open);
	now += 10 * S - 1;
	stays();
	now++;
	change_to(1 - bar.open);
}

static void test_a_way_that_cannot_let_go_is_not_opened_again(void)
{
	bar_of(3);
	down(0);
	take();
	now += 5 * S;
	take(); /* 1 is open, 0 hangs */
	down(1);
	change_to(2);
	down(2);
	now += S;
	change_to(1);
	ways[0].released = true;
	down(1);
	now += 30 * S;
	change_to(2);
	down(2);
	now += 30 * S;
	change_to(0);
}

static void test_nobody_left_means_waiting(void)
{
	bar_of(1);
	down(0);
	now += 1000 * S;
	stays();
	TEST_ASSERT_EQUAL_INT64(INT64_MAX, route_bar(&bar, ways, now).again_ns);
	bar_of(2);
	down(0);
	take();
	now += 5 * S;
	take();
	down(1);
	now += 1000 * S;
	stays();
}

static void test_a_return_waits_for_its_hold_and_for_evidence(void)
{
	bar_of(3);
	down(0);
	change_to(1);
	up(1);
	now += 100 * S;
	stays();
	back(0);
	now += 10 * S - 1;
	stays();
	TEST_ASSERT_EQUAL_INT64(now + 1, route_bar(&bar, ways, now).again_ns);
	now++;
	change_to(0);
	up(0);
	now += 100000 * S;
	stays();
	/* days later, the next in turn, not the one it came from */
	bar.from = 2;
	down(0);
	change_to(1);
}

static void test_a_return_that_fails_doubles_the_hold(void)
{
	int64_t hold = 10 * S;

	bar_of(3);
	down(0);
	change_to(1);
	down(1);
	change_to(2);
	up(2);
	for (unsigned i = 0; i < 10; i++) {
		back(0);
		now += hold - 1;
		stays();
		now++;
		change_to(0);
		down(0);
		change_to(2); /* at once, to the one that worked */
		up(2);
		hold = hold < 640 * S ? hold * 2 : 640 * S;
	}
	TEST_ASSERT_EQUAL_INT64(ROUTE_HOLD_MAX_NS, bar.hold_ns);
	/* until it was steady */
	back(0);
	now += hold;
	change_to(0);
	up(0);
	now += 60 * S;
	down(0);
	change_to(1);
	TEST_ASSERT_EQUAL_INT64(ROUTE_HOLD_NS, bar.hold_ns);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_the_rules_of_a_comma);
	RUN_TEST(test_no_choice_breaks_a_promise);
	RUN_TEST(test_a_return_waits_for_the_latest_of_three);
	RUN_TEST(test_a_path_without_a_device_follows_the_targets_alone);
	RUN_TEST(test_a_lost_device_is_looked_for_on_the_other_targets_in_turn);
	RUN_TEST(test_a_way_that_works_stays_open);
	RUN_TEST(test_the_next_way_is_opened_when_the_one_before_has_let_go);
	RUN_TEST(test_a_way_that_says_nothing_has_failed);
	RUN_TEST(test_the_first_round_takes_no_time_and_the_next_ones_more_and_more);
	RUN_TEST(test_a_target_that_is_seen_shortens_the_wait);
	RUN_TEST(test_a_way_that_cannot_let_go_is_not_opened_again);
	RUN_TEST(test_nobody_left_means_waiting);
	RUN_TEST(test_a_return_waits_for_its_hold_and_for_evidence);
	RUN_TEST(test_a_return_that_fails_doubles_the_hold);
	return UNITY_END();
}
