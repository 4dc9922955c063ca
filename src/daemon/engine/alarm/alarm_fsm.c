/* SPDX-License-Identifier: MIT */
/* The table of the alarm machine, row by row as the manual has it, and the walk through it. */
#include "src/daemon/engine/alarm/alarm_fsm.h"

#define RULING "ruling: "

const struct alarm_row alarm_table[] = {
	{NOT_USED, FACT_ITEMS, 0, INIT, "at least one alarm was found when the driver was opened"},

	{INIT, FACT_MAX_CONS, 0, ALARM_BYPASS, RULING "nMaxConsAlarms were armed in a row"},
	{INIT, FACT_STARTED, 0, ALARM_DIR, "reading of /alarm was started"},

	{ALARM_DIR, FACT_FAILED, 0, ALARM_BYPASS, RULING "reading failed; iAlarmPos = -1"},
	{ALARM_DIR, FACT_DONE, 0, ALARM_PROCESS, "the end of /alarm was reached"},

	{ALARM_PROCESS, FACT_MAX_CONS, 0, ALARM_BYPASS, "nMaxConsAlarms were read in a row"},
	{ALARM_PROCESS, FACT_NEXT_ITEM, 0, ALARM_POR_READ, "fewer than nMaxConsAlarms were read"},
	{ALARM_PROCESS, FACT_CYCLE_END, 0, ALARM_BYPASS, "end of the cycle; iAlarmPos = -1"},

	{ALARM_POR_READ, FACT_ND, 0, ALARM_PROCESS, "sAlarmPor is not defined: next alarm"},
	{ALARM_POR_READ, FACT_EMPTY, 0, ALARM_LATCH, "sAlarmPor is empty"},
	{ALARM_POR_READ, FACT_KNOWN | FACT_NON_ZERO, 0, ALARM_SET,
         RULING "read for this device before"},
	{ALARM_POR_READ, FACT_KNOWN, 0, ALARM_LATCH, RULING "read for this device before"},
	{ALARM_POR_READ, FACT_STARTED, 0, ALARM_POR_READ_WAIT, "reading of sAlarmPor was started"},

	{ALARM_POR_READ_WAIT, FACT_FAILED, 0, ALARM_PROCESS, RULING "failed: next alarm"},
	{ALARM_POR_READ_WAIT, FACT_DONE | FACT_NON_ZERO, 0, ALARM_SET, "por is not zero"},
	{ALARM_POR_READ_WAIT, FACT_DONE, 0, ALARM_LATCH, "por is zero"},

	{ALARM_SET, FACT_ND, 0, ALARM_PROCESS, "sSet or sSetVal is not defined: next alarm"},
	{ALARM_SET, FACT_EMPTY, 0, ALARM_POR_RESET, "sSet or sSetVal is empty"},
	{ALARM_SET, FACT_KNOWN, 0, ALARM_POR_RESET, RULING "written for this device before"},
	{ALARM_SET, FACT_STARTED, 0, ALARM_SET_WAIT, "iAlarmInitPos = -1; writing was started"},

	{ALARM_SET_WAIT, FACT_FAILED, 0, ALARM_PROCESS, RULING "failed: next alarm"},
	{ALARM_SET_WAIT, FACT_DONE | FACT_INIT_OUTPUT, 0, ALARM_INIT_WRITE_WAIT,
         "another output below sPath: its InitValue"},
	{ALARM_SET_WAIT, FACT_DONE, 0, ALARM_POR_RESET, "no further output; iAlarmInitPos = -1"},

	{ALARM_INIT_WRITE_WAIT, FACT_DONE, FACT_INIT_POS, ALARM_POR_RESET, "iAlarmInitPos < 0"},
	{ALARM_INIT_WRITE_WAIT, FACT_DONE | FACT_INIT_POS, 0, ALARM_SET_WAIT, "else"},
	{ALARM_INIT_WRITE_WAIT, FACT_FAILED, 0, ALARM_SET_WAIT,
         RULING "failed: the output stays changed and is the write step's"},

	{ALARM_POR_RESET, FACT_ND, 0, ALARM_PROCESS, "sAlarmPor is not defined: next alarm"},
	{ALARM_POR_RESET, FACT_EMPTY, 0, ALARM_LATCH, "sAlarmPor is empty"},
	{ALARM_POR_RESET, FACT_KNOWN, 0, ALARM_LATCH, RULING "reset for this device before"},
	{ALARM_POR_RESET, FACT_STARTED, 0, ALARM_POR_RESET_WAIT, "writing 0 was started"},

	{ALARM_POR_RESET_WAIT, FACT_FAILED, 0, ALARM_PROCESS, RULING "failed: next alarm"},
	{ALARM_POR_RESET_WAIT, FACT_DONE, 0, ALARM_LATCH, "the request ended"},

	{ALARM_LATCH, FACT_ND, 0, ALARM_PROCESS, "sLatch is not defined: next alarm"},
	{ALARM_LATCH, FACT_EMPTY, 0, ALARM_PROCESS, "sLatch is empty: next alarm"},
	{ALARM_LATCH, FACT_KNOWN | FACT_NON_ZERO, 0, ALARM_SENSED,
         RULING "read for this device before"},
	{ALARM_LATCH, FACT_KNOWN, 0, ALARM_PROCESS, RULING "read for this device before"},
	{ALARM_LATCH, FACT_STARTED, 0, ALARM_LATCH_WAIT, "reading of sLatch was started"},

	{ALARM_LATCH_WAIT, FACT_FAILED, 0, ALARM_PROCESS, RULING "failed: next alarm"},
	{ALARM_LATCH_WAIT, FACT_DONE | FACT_NON_ZERO, 0, ALARM_SENSED, "latch is not zero"},
	{ALARM_LATCH_WAIT, FACT_DONE, 0, ALARM_PROCESS, "else next alarm"},

	{ALARM_SENSED, FACT_ND, 0, ALARM_PROCESS, "sSensed is not defined: next alarm"},
	{ALARM_SENSED, FACT_EMPTY, 0, ALARM_LATCH_RESET, "sSensed is empty"},
	{ALARM_SENSED, FACT_STARTED, 0, ALARM_SENSED_WAIT, "reading under /alarm was started"},

	{ALARM_SENSED_WAIT, FACT_FAILED, 0, ALARM_PROCESS,
         RULING "failed: next alarm, the latch is not reset"},
	{ALARM_SENSED_WAIT, FACT_DONE, 0, ALARM_LATCH_RESET, "the request ended"},

	{ALARM_LATCH_RESET, FACT_ND, 0, ALARM_PROCESS,
         "sLatchRes or sLatchResVal is not defined: next alarm"},
	{ALARM_LATCH_RESET, FACT_EMPTY, 0, SENSED, "sLatchRes or sLatchResVal is empty"},
	{ALARM_LATCH_RESET, FACT_KNOWN, 0, SENSED, RULING "reset for this device before"},
	{ALARM_LATCH_RESET, FACT_STARTED, 0, ALARM_LATCH_RESET_WAIT, "writing was started"},

	{ALARM_LATCH_RESET_WAIT, FACT_FAILED, 0, ALARM_PROCESS, RULING "failed: next alarm"},
	{ALARM_LATCH_RESET_WAIT, FACT_DONE, 0, SENSED, "the request ended"},

	{SENSED, FACT_ND, 0, ALARM_PROCESS, "sSensed is not defined: next alarm"},
	{SENSED, FACT_EMPTY, 0, ALARM_PROCESS, "sSensed is empty: next alarm"},
	{SENSED, FACT_STARTED, 0, SENSED_WAIT, "reading was started"},

	{SENSED_WAIT, FACT_FAILED, 0, ALARM_PROCESS,
         RULING "failed: next alarm, the item is due in the cycle of inputs"},
	{SENSED_WAIT, FACT_DONE, 0, ALARM_PROCESS, "the request ended: next alarm"},

	{ALARM_BYPASS, FACT_PASSED | FACT_POS, 0, ALARM_PROCESS, "iAlarmPos >= 0: next alarm"},
	{ALARM_BYPASS, FACT_PASSED, 0, INIT, "else from the beginning"},
};
const size_t alarm_table_rows = sizeof(alarm_table) / sizeof(alarm_table[0]);

const struct alarm_row *alarm_next(enum alarm_state state, uint32_t facts)
{
	for (size_t i = 0; i < alarm_table_rows; i++) {
		const struct alarm_row *row = &alarm_table[i];

		if (row->state == state && (facts & row->all) == row->all && !(facts & row->none))
			return row;
	}
	return NULL;
}

const char *alarm_state_name(enum alarm_state state)
{
	static const char *const names[ALARM_STATES] = {
#define X(name) #name,
		ALARM_STATE_LIST(X)
#undef X
	};

	return names[state + 1];
}
