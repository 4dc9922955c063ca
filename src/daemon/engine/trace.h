/* SPDX-License-Identifier: MIT */
/* The trace of requests (`owsd -v -v -v`), at the one place that all of them pass. */
#pragma once

#include "hal/base/time.h"
#include "hal/bus/bus.h"
#include "src/ground/text/log.h"

/* At most so many lines a window of requests that succeed, and as many of those that fail. */
#define TRACE_PER_WINDOW 100u
#define TRACE_WINDOW_NS NS_PER_S

struct lane;
struct slot;

static inline bool trace_is_on(const struct log *log)
{
	return log && log_level(log) >= LOG_LEVEL_TRACE;
}

/* The request of the slot has ended, or its time is over. Only where trace_is_on(). */
void trace_answer(const struct lane *lane, const struct slot *slot,
                  const struct bus_answer *answer);
