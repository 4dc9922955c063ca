/* SPDX-License-Identifier: MIT */
/*
 * What a failure means: a pure function from the errors in a row to what to do next (section 3 of
 * docs/semantics.md, "What can fail").
 */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "hal/base/time.h"

enum failure {
	FAILURE_NONE,
	FAILURE_ITEM, /* of this path: device absent, no such property, refused, not convertible */
	FAILURE_TARGET, /* of the whole target: down, silent, garbage */
	FAILURE_VOID,   /* the request was not begun: nothing is known */
};
/* The kind of a bus_answer's err. */
enum failure failure_of(int err);
/*
 * Has the device answered whole, and said that it has no value or no supply? That is in force at
 * once. Any other item error may be of a disturbed answer, and asking again may bring the value.
 */
bool failure_is_verdict(int err);
/* The quality that an error gives a signal, as enum ows_quality. */
uint8_t failure_quality(int err);

struct retry {
	uint16_t failures; /* in a row; 0: the last request succeeded */
	uint8_t doublings; /* of the back-off */
};
#define RETRY_FIRST_NS NS_PER_S
#define RETRY_MAX_NS (60 * NS_PER_S)

/*
 * Count one item error. Returns true when quality goes bad (or stays so); *wait_ns is then the
 * back-off, else 0: again in its next turn.
 */
bool retry_fail(struct retry *retry, unsigned max_retries, int64_t *wait_ns);
void retry_clear(struct retry *retry);
