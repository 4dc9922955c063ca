/* SPDX-License-Identifier: MIT */
/*
 * A chip that leaves the wire while others stay, or a wire that becomes short, at each place of a
 * visit: no value of it is good any more, and when it is back the second reading at the latest is
 * right. Every family is visited, by every property that is read in a way of its own.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "hal/chips/find.h"
#include "tests/unit/aid/visit.h"

#define PLACES 12 /* of a visit */

struct text {
	char bytes[4096 + 1];
	uint32_t len;
};

/* What the chip said before it left, and what it says when it has come back. */
static struct text truth, fresh, again;
static bool moves; /* it is another one each time */
static unsigned wrong;

void setUp(void)
{
}

void tearDown(void)
{
	if (bus)
		visit_end();
}

static int get(const struct visit *visit, struct text *text)
{
	forget();
	const struct bus_answer *answer = answer_to(
		ask(BUS_READ, BUS_INPUT, true, of(visited, visit->property), NULL));

	if (!answer->err) {
		memcpy(text->bytes, data[answer->id], answer->len);
		text->bytes[text->len = answer->len] = '\0';
	}
	return answer->err;
}

static bool is(const struct visit *visit, const struct text *a, const struct text *b)
{
	double more = strtod(a->bytes, NULL) - strtod(b->bytes, NULL);

	if (visit->slack > 0)
		return more >= -60 && more <= 120;
	return a->len == b->len && memcmp(a->bytes, b->bytes, a->len) == 0;
}

static void says(const struct visit *visit, const struct trouble *what, const char *when,
                 const struct text *text)
{
	char line[300];

	snprintf(line, sizeof(line), "%s: %s '%.40s' for '%.40s' or '%.40s'",
	         visit_says(visit, what), when, text->bytes, truth.bytes, fresh.bytes);
	TEST_MESSAGE(line);
	wrong++;
}

static void put_back(void)
{
	trouble.kind = TROUBLE_NONE;
	wire_net.wire[0].shorted = false;
	if (!visited->plugged)
		sim_wire_plug(&wire_net.wire[0], visited, true, wire_time());
}

static void try(const struct visit *visit, enum trouble_kind kind, uint32_t at)
{
	struct trouble what = {.kind = kind, .at = at};
	struct text text = {.len = 0};

	trouble_none(&trouble);
	trouble.kind = kind;
	trouble.at = at;
	if (!get(visit, &text) && !is(visit, &text, &truth) && !is(visit, &text, &fresh))
		says(visit, &what, "at first", &text);
	if (trouble.slots > at && !get(visit, &text))
		says(visit, &what, "away", &text);
	put_back();
	if (get(visit, &text) && get(visit, &text))
		says(visit, &what, "not back", &(struct text){.len = 0});
	else if (!moves && !is(visit, &text, &truth) && !is(visit, &text, &fresh) &&
	         (get(visit, &fresh) || !is(visit, &text, &fresh)))
		says(visit, &what, "back", &text);
}

/* All on one bus: after each the chip is there, and has restarted. */
static void look(struct visit *visit, const struct property *property)
{
	(void)property;
	visit_begin(visit);
	wire_add(0, "DS2401", 2);
	trouble_none(&trouble);
	int err = get(visit, &truth);
	uint32_t slots = trouble.slots;
	sim_wire_plug(&wire_net.wire[0], visited, false, wire_time());
	put_back();
	moves = !get(visit, &again) && !get(visit, &fresh) && !is(visit, &again, &fresh);
	if (!err && !get(visit, &fresh))
		for (unsigned i = 0; i < PLACES; i += visit_stride()) {
			uint32_t at = (uint32_t)((uint64_t)slots * (2 * i + 1) / (2 * PLACES));

			try(visit, TROUBLE_UNPLUG, at);
			try(visit, TROUBLE_SHORT, at);
		}
	visit_end();
}

#define LOOKS(name, chip, parasite) \
	static void test_a_##name##_that_is_away_has_no_value(void) \
	{ \
		wrong = 0; \
		visit_properties(chip, parasite, false, look); \
		TEST_ASSERT_EQUAL_UINT_MESSAGE(0, wrong, chip); \
	}

VISIT_ALL(LOOKS)

/* One that says nothing could be added without a thought of what is read of an idle wire. */
static void test_each_family_says_what_proves_its_answers(void)
{
	const struct family *family;

	for (unsigned n = 0; (family = family_nth(n)); n++)
		TEST_ASSERT_TRUE_MESSAGE(family->proof != PROOF_UNSAID || family->is_virtual,
		                         family->type);
}

/* Of such a one erased bytes are an answer. */
static void test_a_checksum_proves_no_family_with_bytes_that_have_none(void)
{
	const struct family *family;

	for (unsigned n = 0; (family = family_nth(n)); n++)
		for (unsigned i = 1; family->proof == PROOF_CHECKSUM && i < family->area_count; i++)
			TEST_ASSERT_TRUE_MESSAGE(family->areas[i]->check != AREA_UNCHECKED ||
			                                 family->areas[i]->load,
			                         family->type);
}

#define RUN(name, chip, parasite) RUN_TEST(test_a_##name##_that_is_away_has_no_value);

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_each_family_says_what_proves_its_answers);
	RUN_TEST(test_a_checksum_proves_no_family_with_bytes_that_have_none);
	VISIT_ALL(RUN)
	return UNITY_END();
}
