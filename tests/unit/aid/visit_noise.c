/* SPDX-License-Identifier: MIT */
/*
 * A wire on which one bit in a thousand is turned over, with one chip of each name.
 * What they have is read again and again: the answer is the truth, which was read before without
 * noise, or an error. What changes by itself meanwhile, as a clock does, is not read.
 */
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "hal/chips/find.h"
#include "tests/unit/aid/visit.h"
#include "tests/unit/aid/visit_noise.h"

#define READINGS (2500 / visit_stride()) /* in all */
#define NOISE 0.001
#define CHIPS_MAX 24
#define READS_MAX 200
#define TEXT_MAX 512 /* longer ones are not read */

static struct {
	struct sim_slave *slave;
	char property[80];
	uint8_t truth[TEXT_MAX];
	uint32_t len;
} reads[READS_MAX];
static unsigned count;
static struct sim_slave *slave;

static void add(struct visit *visit, const struct property *property)
{
	const struct family *family = family_of(slave->rom[0]);
	const struct area *area = family->areas ? family->areas[property->field.area] : NULL;

	/* Eight bits of checksum for a page let one in 256 through of those that are disturbed. */
	if (count == READS_MAX || property->size > TEXT_MAX ||
	    (area && area->check == AREA_CRC8_PAGES))
		return;
	reads[count].slave = slave;
	snprintf(reads[count].property, sizeof(reads[count].property), "%s", visit->property);
	count++;
}

static const struct bus_answer *read_one(unsigned n)
{
	return answer_to(
		ask(BUS_READ, BUS_INPUT, true, of(reads[n].slave, reads[n].property), NULL));
}

/* Does it say the same again, a minute and a restart of the searches later? */
static void learn(void)
{
	unsigned kept = 0;

	for (unsigned i = 0; i < count; i++, forget()) {
		const struct bus_answer *answer = read_one(i);

		reads[i].len = answer->err || answer->len > TEXT_MAX ? UINT32_MAX : answer->len;
		if (reads[i].len != UINT32_MAX)
			memcpy(reads[i].truth, data[answer->id], answer->len);
	}
	host_run(&host, bus, host.now + 70 * HOST_S);
	for (unsigned i = 0; i < count; i++, forget()) {
		const struct bus_answer *answer = read_one(i);

		if (!answer->err && answer->len == reads[i].len &&
		    memcmp(reads[i].truth, data[answer->id], answer->len) == 0)
			reads[kept++] = reads[i];
	}
	count = kept;
}

static bool is_true(unsigned n, const struct bus_answer *answer)
{
	return answer->len == reads[n].len &&
	       memcmp(reads[n].truth, data[answer->id], answer->len) == 0;
}

/* Noise can change the chip itself: of some a command that reads is a bit from one that writes. */
static bool has_changed(unsigned n, const struct bus_answer *said)
{
	trouble.kind = TROUBLE_NONE;
	const struct bus_answer *now = read_one(n);
	bool changed = !now->err && now->len == said->len &&
	               memcmp(data[now->id], data[said->id], now->len) == 0;

	if (changed) {
		reads[n].len = now->len;
		memcpy(reads[n].truth, data[now->id], now->len);
	}
	trouble.kind = TROUBLE_NOISE;
	return changed;
}

static unsigned listen(unsigned *good)
{
	unsigned wrong = 0;
	char text[300];

	for (unsigned i = 0; i < count; i++, forget()) {
		const struct bus_answer *answer = read_one(i);

		*good += !answer->err;
		if (answer->err || is_true(i, answer) || has_changed(i, answer))
			continue;
		snprintf(text, sizeof(text), "%s %s: '%.40s' for '%.40s'",
		         reads[i].slave->family->name, reads[i].property, (char *)data[answer->id],
		         (char *)reads[i].truth);
		TEST_MESSAGE(text);
		wrong++;
	}
	return wrong;
}

void visit_noise(const char *const *chips)
{
	unsigned good = 0, wrong = 0, n = 0;

	native_begin();
	wire_init(&host, 1, 1);
	wire_net.trouble = &trouble;
	trouble_none(&trouble);
	trouble.random = 20251;
	count = 0;
	for (; chips[n]; n++) {
		TEST_ASSERT_LESS_THAN_UINT(CHIPS_MAX, n);
		slave = wire_add(0, chips[n], n + 1);
		visit_change(slave, n % 2, false);
		visit_properties(chips[n], false, false, add);
	}
	start();
	learn();
	TEST_ASSERT_GREATER_THAN_UINT(0, count);
	trouble.kind = TROUBLE_NOISE;
	trouble.probability = NOISE;
	trouble.deaf = false;
	for (unsigned round = 0; round < READINGS / count; round++) {
		wrong += listen(&good);
		host_run(&host, bus, host.now + HOST_S);
		host.events = 0;
	}
	visit_end();
	TEST_ASSERT_EQUAL_UINT(0, wrong);
	TEST_ASSERT_GREATER_THAN_UINT(READINGS / 10, good);
}
