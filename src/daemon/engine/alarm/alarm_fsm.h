/* SPDX-License-Identifier: MIT */
/*
 * The alarm machine of section 3.2 of the manual: a pure function over the table below, which can
 * be laid beside Table 3.1 row by row. Names of states are the manual's. docs/semantics.md has the
 * rulings; rows marked so in alarm_fsm.c are ours.
 */
#pragma once

#include <stddef.h>
#include <stdint.h>

/* In the manual's order; NOT_USED has the number -1 there. */
#define ALARM_STATE_LIST(X) \
	X(NOT_USED) \
	X(INIT) \
	X(ALARM_DIR) \
	X(ALARM_PROCESS) \
	X(ALARM_POR_READ) \
	X(ALARM_POR_READ_WAIT) \
	X(ALARM_SET) \
	X(ALARM_SET_WAIT) \
	X(ALARM_INIT_WRITE_WAIT) \
	X(ALARM_POR_RESET) \
	X(ALARM_POR_RESET_WAIT) \
	X(ALARM_LATCH) \
	X(ALARM_LATCH_WAIT) \
	X(ALARM_SENSED) \
	X(ALARM_SENSED_WAIT) \
	X(ALARM_LATCH_RESET) \
	X(ALARM_LATCH_RESET_WAIT) \
	X(SENSED) \
	X(SENSED_WAIT) \
	X(ALARM_BYPASS)

enum alarm_state {
	ALARM_BEFORE_ALL = -2,
#define X(name) name,
	ALARM_STATE_LIST(X)
#undef X
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

/* The first row of the state, top to bottom, with facts that hold; NULL: stay. */
const struct alarm_row *alarm_next(enum alarm_state state, uint32_t facts);
const char *alarm_state_name(enum alarm_state state);
