/* SPDX-License-Identifier: MIT */
/*
 * No restart makes a false value good: each property of a chip is read while the chip loses its
 * power at each byte and in each wait of the visit, once, or there and then again and again. The
 * answer is the truth or an error.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "tests/unit/aid/visit_brownout.h"

#define PLACES 8192
#define BYTE_NS (8 * INT64_C(69250))

struct text {
	char bytes[4096 + 1];
	uint32_t len;
	bool known;
};

/* What an untroubled reading gives; and what it gives of a chip that has restarted. */
static struct text truth, fresh;
static int64_t place[PLACES], begun, last;
static unsigned places, false_values, good;
static bool in_parts; /* the property is a memory */

static void add(int64_t now)
{
	TEST_ASSERT_LESS_THAN_UINT(PLACES, places);
	place[places++] = now - begun;
}

/* A place at each byte, and two in each wait: in its middle and at its end. */
static void used(int64_t now)
{
	if (now - last < BYTE_NS && places)
		return;
	if (now - last > 2 * BYTE_NS && places)
		add(last + (now - last) / 2);
	add(now);
	last = now;
}

static int get(const struct visit *visit, struct text *text)
{
	const struct bus_answer *answer = answer_to(
		visit_go(visit, &(struct trouble){.kind = TROUBLE_NONE}));

	text->known = answer->err == 0;
	text->len = answer->len;
	if (text->known)
		memcpy(text->bytes, data[answer->id], answer->len);
	text->bytes[text->known ? text->len : 0] = '\0';
	return answer->err;
}

static bool is(const struct visit *visit, const struct bus_answer *answer, const struct text *text)
{
	double more = answer->number - strtod(text->bytes, NULL);

	if (!text->known)
		return false;
	if (visit->slack > 0)
		return more >= 0 && more <= visit->slack;
	return answer->len == text->len && memcmp(data[answer->id], text->bytes, text->len) == 0;
}

/*
 * A memory comes in parts, each of one moment: the restart may lie between two of them. Each part
 * is of before it or of after it.
 */
static bool is_of_parts(const struct bus_answer *answer)
{
	if (!truth.known || !fresh.known || answer->len != truth.len || answer->len != fresh.len)
		return false;
	for (uint32_t at = 0; at < answer->len; at += AREA_UNIT) {
		size_t n = answer->len - at < AREA_UNIT ? answer->len - at : AREA_UNIT;

		if (memcmp(data[answer->id] + at, truth.bytes + at, n) != 0 &&
		    memcmp(data[answer->id] + at, fresh.bytes + at, n) != 0)
			return false;
	}
	return true;
}

static void look_once(const struct visit *visit, int64_t at, int64_t every)
{
	char text[300];

	visit_begin(visit);
	trouble_none(&trouble);
	trouble.kind = TROUBLE_RESTART;
	trouble.restart_ns = host.now + (at ? at : 1);
	trouble.every_ns = every;
	const struct bus_answer *answer = answer_to(
		ask(BUS_READ, BUS_INPUT, true, of(visited, visit->property), NULL));

	good += answer->err == 0;
	if (!answer->err && !is(visit, answer, &truth) && !is(visit, answer, &fresh) &&
	    !(in_parts && is_of_parts(answer))) {
		snprintf(text, sizeof(text),
		         "%s %s: restart at %.2f ms, every %.0f: '%.40s' for '%.40s'", visit->chip,
		         visit->property, (double)at / 1e6, (double)every / 1e6,
		         (char *)data[answer->id], truth.bytes);
		TEST_MESSAGE(text);
		false_values++;
	}
	visit_end();
}

/*
 * One that is known without the wire has no place. measured: a register that a restart empties is
 * no measurement.
 */
static void look(const struct visit *visit, bool measured)
{
	visit_begin(visit);
	begun = host.now;
	places = 0;
	last = begun;
	wire_net.used = used;
	int err = get(visit, &truth);
	visit_end();
	if (err)
		return;
	visit_begin(visit);
	sim_slave_brownout(visited, wire_time());
	get(visit, &fresh);
	double number = strtod(fresh.bytes, NULL);
	fresh.known &= !measured || (number != 0 && number != 85);
	visit_end();
	unsigned n = places, stride = (n / 400 + 1) * visit_stride();

	for (unsigned i = 0; i < n; i += stride) {
		look_once(visit, place[i], 0);
		look_once(visit, place[i], 89 * HOST_MS);
		look_once(visit, place[i], 13 * HOST_MS + 7 * BYTE_NS);
	}
}

static void look_at_property(struct visit *visit, const struct property *property)
{
	in_parts = property->type == PROPERTY_BINARY;
	look(visit, property->life == LIFE_VOLATILE && (property->type == PROPERTY_FLOAT ||
	                                                property->type == PROPERTY_TEMPERATURE));
}

void visit_brownout(const char *chip, bool parasite)
{
	false_values = good = 0;
	visit_properties(chip, parasite, false, look_at_property);
	TEST_ASSERT_GREATER_THAN_UINT_MESSAGE(0, good, chip);
	TEST_ASSERT_EQUAL_UINT_MESSAGE(0, false_values, chip);
}
