/* SPDX-License-Identifier: MIT */
/*
 * What history consists of: values of signals, gaps, and events of owsd and of the recorder. Times
 * are boot times (CLOCK_BOOTTIME), which never step, in nanoseconds; the file has microseconds.
 *
 * Room src/history/file: the file of history, an SQLite database: schema, writer, roll-ups, place.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "src/public/ows.h"
#include "src/public/ows_history.h"

/* Bytes of texts, with NUL. */
#define HISTORY_NAME 128 /* of a signal */
#define HISTORY_IDENTITY 304
#define HISTORY_UNIT 32
#define HISTORY_WHO 32
/* Signals that one file may have, with those of earlier tables. */
#define HISTORY_SIGNALS 65535

#define HISTORY_REASONS (OWS_HISTORY_NOT_ASKED + 1)
/* A few words ("recorder stopped"); never NULL. */
const char *history_reason_text(uint8_t reason);

/* Who did something, as in struct ows_by. */
struct history_who {
	uint32_t serial, uid;
	int32_t pid;
	char name[HISTORY_WHO], person[HISTORY_WHO];
};

/* An entry of the journals of owsd. */
struct history_event {
	uint8_t kind;    /* OWS_HISTORY_COMMAND or OWS_HISTORY_ALARM */
	uint8_t type;    /* enum ows_type, of the signal */
	uint8_t quality; /* enum ows_quality */
	uint8_t reason;  /* COMMAND: enum ows_reason; ALARM: enum ows_alarm_kind */
	uint8_t event;   /* ALARM: enum ows_alarm_event */
	bool has_value, has_before;
	uint32_t signal; /* its number in the table */
	int64_t time_ns;
	int64_t value;  /* as in src/ground/signal/value.h: the bits of a double, or an integer */
	int64_t before; /* ALARM: likewise; value is the one after */
	char text[160];
	struct history_who who; /* serial 0: no program */
};

/* A line of the table of signals, as a recorder describes it. */
struct history_signal {
	const char *name, *unit;
	uint8_t type; /* enum ows_type */
	uint8_t output;
	int8_t decimals;      /* -1: not known */
	const char *identity; /* what it is known by over another name; NULL: its name */
};
static inline const char *history_identity(const struct history_signal *signal)
{
	return signal->identity ? signal->identity : signal->name;
}
