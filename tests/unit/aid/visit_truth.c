/* SPDX-License-Identifier: MIT */
/*
 * No trouble on the wire makes a false value good: each property of a chip is read with each
 * command lost, each bit turned over and each presence pulse lost in turn. The answer is the truth
 * or an error.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "tests/unit/aid/visit_truth.h"

static char truth[4096 + 1];
static uint32_t truth_len;
static unsigned false_values;

static bool is_true(const struct visit *visit, const struct bus_answer *answer)
{
	double more = answer->number - strtod(truth, NULL);

	if (visit->slack > 0)
		return more >= 0 && more <= visit->slack;
	return answer->len == truth_len && memcmp(data[answer->id], truth, truth_len) == 0;
}

static void one(const struct visit *visit, const struct trouble *what)
{
	char text[300];
	const struct bus_answer *answer = answer_to(visit_go(visit, what));

	if (answer->err || is_true(visit, answer))
		return;
	snprintf(text, sizeof(text), "%s: '%.40s' for '%.40s'", visit_says(visit, what),
	         (char *)data[answer->id], truth);
	TEST_MESSAGE(text);
	false_values++;
}

static void look(const struct visit *visit)
{
	visit_begin(visit);
	const struct bus_answer *answer = answer_to(
		visit_go(visit, &(struct trouble){.kind = TROUBLE_NONE}));

	TEST_ASSERT_EQUAL_INT_MESSAGE(0, answer->err, visit->property);
	truth_len = answer->len;
	memcpy(truth, data[answer->id], truth_len);
	truth[truth_len] = '\0';
	visit_end();
	visit_each(visit, one);
}

static void look_untroubled_first(struct visit *visit, const struct property *property)
{
	(void)property;
	visit_begin(visit);
	int err = answer_to(visit_go(visit, &(struct trouble){.kind = TROUBLE_NONE}))->err;
	visit->stride = trouble.slots > 15000  ? 211
	                : trouble.slots > 4000 ? 13
	                : trouble.slots > 2500 ? 5
	                                       : 1;
	visit_end();
	if (!err)
		look(visit);
}

void visit_truth(const char *chip, bool parasite)
{
	const struct sim_input *inputs = sim_family_find(chip, 0)->inputs;

	false_values = 0;
	visit_properties(chip, parasite, false, look_untroubled_first);
	if (inputs && inputs[0].pin)
		visit_properties(chip, parasite, true, look_untroubled_first);
	TEST_ASSERT_EQUAL_UINT_MESSAGE(0, false_values, chip);
}
