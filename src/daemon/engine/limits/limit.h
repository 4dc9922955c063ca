/* SPDX-License-Identifier: MIT */
/*
 * Limit alarms of one signal: a pure function of what is known of it and of the time, with the
 * alarm states of ISA-18.2.
 *
 * Each condition (HH, H, L, LL, stale, bad) is in when the value says so, and is active once it was
 * in for OnDelay, until it was out for OffDelay. The active condition of the highest rank is the
 * alarm's kind: bad, stale, then the value's, the outer before the inner. Every condition that
 * becomes active raises the alarm anew, also one that was acknowledged; it has returned when no
 * condition is active any more. While the value is not known (stale or bad) the conditions of the
 * value stay as they are and no delay of theirs runs.
 *
 * While the alarm is shelved its conditions and delays go on, and its state is normal. It is raised
 * when it is no longer shelved and a condition is active.
 */
#pragma once

#include "src/config/read/config.h"

enum limit_event {
	LIMIT_RAISE,       /* a condition became active */
	LIMIT_RETURN,      /* the last one ended */
	LIMIT_ACKNOWLEDGE, /* a person has seen it */
};

/* The state after an event. */
enum ows_limit_state limit_next(enum ows_limit_state state, enum limit_event event);

/* Bits of conditions: 1 << kind. */
struct limit {
	enum ows_limit_state state;
	uint8_t kind; /* enum ows_alarm_kind that stands, or returned unacknowledged; 0 none */
	bool shelved; /* state is normal; kind is that of the active condition */
	uint16_t in, active;
	int64_t since_ns[OWS_ALARM_BAD + 1]; /* when in changed last */
};

/* What is known of the signal. */
struct limit_reading {
	double value; /* if neither stale nor bad */
	bool stale, bad;
	bool unknown; /* never read: no value, but not bad */
};

/* What an evaluation found, for the journal: kinds (enum ows_alarm_kind), 0 none. */
struct limit_news {
	uint8_t returned, raised; /* in this order */
};

/*
 * Bring the alarms to now_ns. Returns when a delay runs out and this has to be called again even
 * if nothing new is known; INT64_MAX: none runs.
 */
int64_t limit_evaluate(struct limit *limit, const struct config_limits *limits,
                       const struct limit_reading *reading, int64_t now_ns,
                       struct limit_news *news);
/* Returns the kind that was acknowledged, 0 if nothing was unacknowledged. */
uint8_t limit_acknowledge(struct limit *limit);
void limit_shelve(struct limit *limit);
/* Returns the kind that is raised now, 0: no condition is active. */
uint8_t limit_unshelve(struct limit *limit);
