/* SPDX-License-Identifier: MIT */
/*
 * The limit alarms of one signal: conditions, their delays, their rank, and the state of the alarm.
 */
#include "src/daemon/engine/limits/limit.h"

#define BIT(kind) ((uint16_t)(1u << (kind)))

/* Highest rank first. */
static const uint8_t ranks[] = {
	OWS_ALARM_BAD, OWS_ALARM_STALE, OWS_ALARM_HH, OWS_ALARM_LL, OWS_ALARM_H, OWS_ALARM_L,
};
#define RANKS (sizeof(ranks) / sizeof(ranks[0]))

static const uint8_t kinds[CONFIG_LIMITS] = {
	[CONFIG_LIMIT_LL] = OWS_ALARM_LL,
	[CONFIG_LIMIT_L] = OWS_ALARM_L,
	[CONFIG_LIMIT_H] = OWS_ALARM_H,
	[CONFIG_LIMIT_HH] = OWS_ALARM_HH,
};

enum ows_limit_state limit_next(enum ows_limit_state state, enum limit_event event)
{
	switch (event) {
	case LIMIT_RAISE:
		return OWS_LIMIT_UNACKNOWLEDGED;
	case LIMIT_RETURN:
		return state == OWS_LIMIT_UNACKNOWLEDGED || state == OWS_LIMIT_RETURNED
		               ? OWS_LIMIT_RETURNED
		               : OWS_LIMIT_NORMAL;
	case LIMIT_ACKNOWLEDGE:
		return state == OWS_LIMIT_UNACKNOWLEDGED || state == OWS_LIMIT_ACKNOWLEDGED
		               ? OWS_LIMIT_ACKNOWLEDGED
		               : OWS_LIMIT_NORMAL;
	}
	return state;
}

static uint8_t highest(uint16_t conditions)
{
	for (unsigned i = 0; i < RANKS; i++)
		if (conditions & BIT(ranks[i]))
			return ranks[i];
	return 0;
}

/* Is the value beyond a limit? An alarm that stands is left only by more than the hysteresis. */
static bool is_beyond_limit(const struct config_limits *limits, int i, double value, bool stands)
{
	double limit = limits->limit[i], room = stands ? limits->hysteresis : 0;

	if (i == CONFIG_LIMIT_H || i == CONFIG_LIMIT_HH)
		return value >= limit - room;
	return value <= limit + room;
}

static uint16_t conditions_in(const struct limit *limit, const struct config_limits *limits,
                              const struct limit_reading *reading)
{
	uint16_t in = (uint16_t)((reading->bad ? BIT(OWS_ALARM_BAD) : 0) |
	                         (reading->stale ? BIT(OWS_ALARM_STALE) : 0));
	bool known = !reading->bad && !reading->stale && !reading->unknown;

	for (int i = 0; i < CONFIG_LIMITS; i++) {
		bool stands = limit->active & BIT(kinds[i]);

		if (limits->has[i] &&
		    (known ? is_beyond_limit(limits, i, reading->value, stands) : stands))
			in |= BIT(kinds[i]);
	}
	return in;
}

/* A condition that was in, or out, for its delay becomes, or ends to be, active. */
static int64_t run_delays(struct limit *limit, const struct config_limits *limits, uint16_t in,
                          int64_t now_ns)
{
	int64_t next = INT64_MAX;

	for (unsigned i = 0; i < RANKS; i++) {
		uint8_t kind = ranks[i];
		bool is_in = in & BIT(kind);
		int64_t end;

		if (((limit->in ^ in) & BIT(kind)) != 0)
			limit->since_ns[kind] = now_ns;
		if (is_in == ((limit->active & BIT(kind)) != 0))
			continue;
		end = limit->since_ns[kind] + (is_in ? limits->on_delay_ns : limits->off_delay_ns);
		if (end <= now_ns)
			limit->active ^= BIT(kind);
		else if (end < next)
			next = end;
	}
	limit->in = in;
	return next;
}

int64_t limit_evaluate(struct limit *limit, const struct config_limits *limits,
                       const struct limit_reading *reading, int64_t now_ns, struct limit_news *news)
{
	uint16_t before = limit->active, begun;
	uint8_t stood = highest(before);
	int64_t next = run_delays(limit, limits, conditions_in(limit, limits, reading), now_ns);

	*news = (struct limit_news){0};
	if (limit->shelved) {
		limit->kind = highest(limit->active);
		return next;
	}
	begun = limit->active & (uint16_t)~before;
	if (stood && !(limit->active & BIT(stood)))
		news->returned = stood;
	news->raised = highest(begun);
	if (begun)
		limit->state = limit_next(limit->state, LIMIT_RAISE);
	else if (before && !limit->active)
		limit->state = limit_next(limit->state, LIMIT_RETURN);
	if (limit->active)
		limit->kind = highest(limit->active);
	else if (limit->state == OWS_LIMIT_NORMAL)
		limit->kind = 0;
	return next;
}

uint8_t limit_acknowledge(struct limit *limit)
{
	enum ows_limit_state before = limit->state;
	uint8_t kind = limit->kind;

	if (limit->shelved)
		return 0;
	limit->state = limit_next(before, LIMIT_ACKNOWLEDGE);
	if (limit->state == OWS_LIMIT_NORMAL)
		limit->kind = 0;
	return limit->state != before ? kind : 0;
}

void limit_shelve(struct limit *limit)
{
	limit->shelved = true;
	limit->state = OWS_LIMIT_NORMAL;
	limit->kind = highest(limit->active);
}

uint8_t limit_unshelve(struct limit *limit)
{
	if (!limit->shelved)
		return 0;
	limit->shelved = false;
	if (limit->active)
		limit->state = limit_next(limit->state, LIMIT_RAISE);
	return limit->kind;
}
