/* SPDX-License-Identifier: MIT */
/*
 * The alarm machine of section 3.2 of the manual: a pure function over the table below, which can
 * be laid beside Table 3.1 row by row. Names of states are the manual's. docs/semantics.md has the
 * rulings; rows marked so in alarm_fsm.c are ours.
 */
#pragma once

#include <stddef.h>
#include <stdint.h>

enum alarm_state {
	NOT_USED = -1,
	INIT = 0,
	ALARM_DIR,
	ALARM_PROCESS,
	ALARM_POR_READ,
	ALARM_POR_READ_WAIT,
	ALARM_SET,
	ALARM_SET_WAIT,
	ALARM_INIT_WRITE_WAIT,
	ALARM_POR_RESET,
	ALARM_POR_RESET_WAIT,
	ALARM_LATCH,
	ALARM_LATCH_WAIT,
	ALARM_SENSED,
	ALARM_SENSED_WAIT,
	ALARM_LATCH_RESET,
	ALARM_LATCH_RESET_WAIT,
	SENSED,
	SENSED_WAIT,
	ALARM_BYPASS,
};
#define ALARM_STATES 20

/* What can be true when a state is left; a set of bits. */
enum alarm_fact {
	FACT_ITEMS = 1 << 0,     /* there is an alarm item */
	FACT_STARTED = 1 << 1,   /* the request of the state was given to the bus */
	FACT_DONE = 1 << 2,      /* the request in work ended well */
	FACT_FAILED = 1 << 3,    /* it failed, or its answer cannot be used */
	FACT_MAX_CONS = 1 << 4,  /* MaxConsAlarms items were begun since the last bypass */
	FACT_NEXT_ITEM = 1 << 5, /* another listed alarm item follows; iAlarmPos is it now */
	FACT_CYCLE_END = 1 << 6, /* none follows; iAlarmPos is -1 now */
	FACT_ND = 1 << 7,        /* the state's string is not defined */
	FACT_EMPTY = 1 << 8,     /* it is empty */
	FACT_NON_ZERO = 1 << 9,  /* what was read is not zero */
	FACT_INIT_OUTPUT =
		1 << 10,         /* another output below the device: its InitValue is on the way */
	FACT_INIT_POS = 1 << 11, /* iAlarmInitPos >= 0 */
	FACT_POS = 1 << 12,      /* iAlarmPos >= 0 */
	FACT_KNOWN = 1 << 13,    /* done for this device in this cycle: no request is needed */
	FACT_PASSED = 1 << 14,   /* one write or read went through, or none was pending */
};

struct alarm_row {
	enum alarm_state state;
	uint32_t all;  /* facts that must hold */
	uint32_t none; /* facts that must not */
	enum alarm_state next;
	const char *text; /* the manual's condition, or the ruling's */
};
extern const struct alarm_row alarm_table[];
extern const size_t alarm_table_rows;

/* The first row of the state, top to bottom, whose facts hold; NULL: stay. */
const struct alarm_row *alarm_next(enum alarm_state state, uint32_t facts);
const char *alarm_state_name(enum alarm_state state);
