/* SPDX-License-Identifier: MIT */
/* Thermometers that are asked for without pause, and whose answers are judged. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "tests/unit/aid/fleet.h"

#define CLIMB_S 60 /* from -20 to 40 degrees, and again */
#define LAST_OF_ALL 0xffff
#define STEP (1 / 16.0) /* of 12 bits, to the nearest; more than that is cut off */

struct fleet fleet;

double fleet_slope;

static struct bus_req requests[FLEET_MAX + 8];
static char paths[FLEET_MAX + 8][100];
static uint8_t texts[FLEET_MAX + 8][4096];
static int64_t asked[FLEET_MAX + 8];
static int64_t due[FLEET_MAX];
static struct bus_answer last[FLEET_MAX]; /* good ones */
static int64_t took, renewed;
static uint32_t awaited;
static int error;
static unsigned extra;

static double slope(void)
{
	return fleet_slope > 0 ? fleet_slope : 1;
}

/* A saw: its jumps are rare, and a value near one is not judged. */
static double temperature(unsigned i, int64_t t)
{
	double s = (double)(t % (CLIMB_S * HOST_S)) / 1e9;

	return -20 + s * slope() + i % 7 * 0.5;
}

static void climb(unsigned i, int64_t t)
{
	int64_t start = t - t % (CLIMB_S * HOST_S);

	fleet.slave[i]->input[0] = (struct sim_curve){
		.shape = SIM_RAMP,
		.a = temperature(i, start),
		.b = temperature(i, start) + CLIMB_S * slope(),
		.start_ns = start,
		.span_ns = CLIMB_S * HOST_S,
	};
}

static void renew(void)
{
	int64_t start = host.now - host.now % (CLIMB_S * HOST_S);

	if (start == renewed)
		return;
	renewed = start;
	for (unsigned i = 0; i < fleet.count; i++)
		climb(i, host.now);
}

void fleet_add_to(unsigned channel, const char *chip, unsigned count)
{
	for (; count--; fleet.count++) {
		TEST_ASSERT_LESS_THAN_UINT(FLEET_MAX, fleet.count);
		fleet.slave[fleet.count] = wire_add(channel, chip, fleet.count + 1);
		climb(fleet.count, host.now);
	}
}

void fleet_add(const char *chip, unsigned count)
{
	fleet_add_to(0, chip, count);
}

void fleet_forget(void)
{
	fleet.good = fleet.failed = fleet.older = fleet.newer = fleet.wrong = fleet.halves = 0;
	memset(fleet.each, 0, sizeof(fleet.each));
}

static int64_t patience(uint32_t id)
{
	return id < FLEET_MAX && fleet.patience_ns[id] ? fleet.patience_ns[id] : 20 * HOST_S;
}

static void submit(uint32_t id, enum bus_op op, enum bus_prio prio, size_t len)
{
	asked[id] = host.now;
	requests[id] = (struct bus_req){.id = id,
	                                .op = (uint8_t)op,
	                                .prio = (uint8_t)prio,
	                                .fresh = true,
	                                .path = paths[id],
	                                .data = texts[id],
	                                .len = (uint32_t)len,
	                                .deadline_ns = host.now + patience(id)};
	TEST_ASSERT_EQUAL_INT(0, bus_submit(bus, &requests[id]));
}

/* Near the saw's jump a value may be of either side. */
static bool is_near_jump(int64_t t)
{
	int64_t in = t % (CLIMB_S * HOST_S);

	return in < 3 * HOST_S || in > (CLIMB_S - 3) * HOST_S;
}

/* Another value, of the same moment as the one before. */
static bool states_it_again(unsigned i, const struct bus_answer *answer)
{
	bool same = last[i].measured_ns == answer->measured_ns && last[i].number != answer->number;

	last[i] = *answer;
	return same;
}

static void judge(unsigned i, const struct bus_answer *answer)
{
	double is = temperature(i, answer->measured_ns),
	       least = temperature(i, answer->measured_ns - fleet.early_ns) - fleet.step - STEP;
	char text[200];

	fleet.failed += answer->err != 0;
	if (answer->err)
		return;
	bool again = states_it_again(i, answer);
	if (is_near_jump(host.now))
		return;
	fleet.good++;
	fleet.each[i]++;
	fleet.older += fleet_slope <= 0 && answer->number <= temperature(i, asked[i]) - fleet.step;
	fleet.newer += answer->number >= is + STEP;
	if (answer->number < temperature(i, host.now) + STEP && answer->number > least &&
	    answer->measured_ns <= host.now && !again)
		return;
	fleet.wrong++;
	fleet.halves += answer->number * 2 == (int)(answer->number * 2);
	snprintf(text, sizeof(text), "%u at %.3f s says %g: asked for at %.3f s (%g), stamp %.3f s",
	         i, (double)host.now / 1e9, answer->number, (double)asked[i] / 1e9,
	         temperature(i, asked[i]), (double)answer->measured_ns / 1e9);
	TEST_MESSAGE(text);
}

static void take_answers(void)
{
	for (unsigned i = 0; i < host.answers; i++) {
		const struct bus_answer *answer = &host.answer[i];

		if (answer->id < FLEET_MAX) {
			judge(answer->id, answer);
			asked[answer->id] = 0;
			due[answer->id] = host.now + fleet.pause_ns[answer->id];
		} else if (answer->id == awaited) {
			took = host.now - asked[answer->id];
			error = answer->err;
			awaited = LAST_OF_ALL;
		}
	}
	host.answers = 0;
}

/* Step by step: what is answered is asked for again before the next. */
static void run(int64_t until_ns, bool until_answered)
{
	while (host.now < until_ns && !(until_answered && awaited == LAST_OF_ALL)) {
		renew();
		for (unsigned i = 0; i < fleet.count && !fleet.stopped; i++) {
			if (asked[i] || host.now < due[i])
				continue;
			snprintf(paths[i], sizeof(paths[i]), "%s",
			         of(fleet.slave[i],
			            fleet.property ? fleet.property : "temperature"));
			submit(i, BUS_READ, BUS_INPUT, sizeof(texts[i]));
		}
		int64_t next = bus_step(bus, host.now);
		next = next > until_ns ? until_ns : next;
		for (unsigned i = 0; i < fleet.count; i++)
			next = !asked[i] && due[i] > host.now && due[i] < next ? due[i] : next;
		if (!host.answers && next > host.now)
			host.now = next;
		take_answers();
	}
}

void fleet_run(int64_t until_ns)
{
	run(until_ns, false);
}

static uint32_t ask_besides(enum bus_prio prio, enum bus_op op, const char *path, size_t len)
{
	uint32_t id = FLEET_MAX + extra++ % 8;

	snprintf(paths[id], sizeof(paths[id]), "%s", path);
	submit(id, op, prio, len);
	awaited = id;
	return id;
}

uint32_t fleet_ask(enum bus_prio prio, enum bus_op op, const char *path)
{
	return ask_besides(prio, op, path, sizeof(texts[0]));
}

uint32_t fleet_write(enum bus_prio prio, const char *path, const char *text)
{
	size_t len = strlen(text);

	memcpy(texts[FLEET_MAX + extra % 8], text, len);
	return ask_besides(prio, BUS_WRITE, path, len);
}

int64_t fleet_answered(uint32_t id, int *err)
{
	awaited = id;
	run(host.now + 20 * HOST_S, true);
	TEST_ASSERT_EQUAL_UINT32(LAST_OF_ALL, awaited);
	*err = error;
	return took;
}

void fleet_begin(void)
{
	memset(&fleet, 0, sizeof(fleet));
	memset(asked, 0, sizeof(asked));
	memset(due, 0, sizeof(due));
	memset(last, 0, sizeof(last));
	fleet_slope = 0;
	renewed = 0;
}

void fleet_again(void)
{
	native_end();
	native_begin();
	fleet_begin();
}

unsigned fleet_restarts(void (*set_out)(unsigned count, const char *chip), unsigned count,
                        const char *chip, int64_t settled, unsigned most_ms, unsigned step_ms)
{
	static struct trouble trouble;
	unsigned good = 0;

	for (unsigned ms = step_ms; ms < most_ms; ms += step_ms) {
		fleet_again();
		set_out(count, chip);
		wire_net.trouble = &trouble;
		trouble_none(&trouble);
		start();
		fleet_run(host.now + settled);
		fleet_forget();
		trouble.kind = TROUBLE_RESTART;
		trouble.restart_ns = host.now + ms * HOST_MS;
		fleet_run(host.now + 6 * HOST_S);
		TEST_ASSERT_EQUAL_UINT_MESSAGE(0, fleet.wrong, chip);
		good += fleet.good;
	}
	return good;
}

unsigned fleet_troubles(struct trouble *trouble, void (*begin)(void), void (*go_on)(int64_t ns),
                        int64_t round_ns, uint32_t *slots)
{
	static const struct {
		enum trouble_kind kind;
		uint8_t mask;
	} kinds[] = {
		{TROUBLE_TURN, 1},   {TROUBLE_TURN, 0xff}, {TROUBLE_DEAF, 1},
		{TROUBLE_ABSENT, 1}, {TROUBLE_FALSE, 1},
	};
	unsigned wrong = 0, good = 0;

	begin();
	go_on(round_ns);
	*slots = trouble->slots;
	uint32_t resets = trouble->resets;
	for (unsigned k = 0; k < sizeof(kinds) / sizeof(kinds[0]); k++) {
		bool of_resets = kinds[k].kind == TROUBLE_ABSENT || kinds[k].kind == TROUBLE_FALSE;

		for (uint32_t at = 0; at < (of_resets ? resets : *slots); at++) {
			begin();
			trouble->kind = kinds[k].kind;
			trouble->mask = kinds[k].mask;
			trouble->at = at;
			go_on(4 * HOST_S);
			wrong += fleet.wrong;
			good += fleet.good;
		}
	}
	TEST_ASSERT_EQUAL_UINT(0, wrong);
	return good;
}
