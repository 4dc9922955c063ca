/* SPDX-License-Identifier: MIT */
/*
 * The alarm items of the table, and what the alarm machine of a lane knows and holds of them.
 * Nothing here asks a bus or touches a signal.
 */
#pragma once

#include "hal/bus/bus.h"
#include "src/daemon/engine/alarm/alarm_fsm.h"
#include "src/daemon/engine/alarm/alarm_text.h"
#include "src/daemon/engine/retry.h"
#include "src/daemon/engine/table.h"

/* Room for the list of /alarm, bytes. */
#define ALARM_LIST (64 * 1024)

/* The working strings of section 3.2; text NULL: not defined, "": empty. */
struct alarm_strings {
	char path[ALARM_TEXT];   /* sPath: "/29.066418000000" */
	char sensed[ALARM_TEXT]; /* sSensed */
	const char *por, *latch; /* sAlarmPor, sLatch: the item's own */
	char set_text[ALARM_TEXT], reset_text[ALARM_TEXT];
	const char *set, *set_value;     /* sSet, sSetVal: into set_text */
	const char *reset, *reset_value; /* sLatchRes, sLatchResVal: into reset_text */
};

/* The string at that offset in the strings. */
static inline const char *alarm_string(const struct alarm_strings *s, size_t at)
{
	const void *member = (const char *)s + at;

	return member == s->sensed ? s->sensed : *(const char *const *)member;
}

/* What the machine does for an item, and not twice in a cycle for one device. */
enum alarm_deed {
	ALARM_POR_WAS_READ,
	ALARM_POR_WAS_RESET,
	ALARM_LATCH_WAS_READ,
	ALARM_LATCH_WAS_RESET,
	ALARM_WAS_SET,
	ALARM_INIT_WAS_WRITTEN,
	ALARM_WAS_COLLECTED,
	ALARM_VALUE_WAS_READ, /* never kept: it is read for each item */
	ALARM_DEEDS
};

/* An occurrence, from the latch that was read; a reload carries it over. */
struct alarm_occurrence {
	bool stands;      /* its latch was not reset yet; shown is one that may be set again too */
	uint32_t entered; /* channels that the journal has, and no return of them yet */
	uint32_t journal; /* number of the entry that waits for the value after */
	bool wants_after;
	char latch_text[24];
};

/* A restart of the device, by its por; a reload carries it over. */
struct alarm_restart {
	bool seen;  /* owsd has looked at the device: a list was without it, or its por was read */
	bool known; /* por was not 0, and not 0 since */
	bool differs; /* since then an output changed by itself: the device has restarted again */
};

/* SetAlarm compared with the chip; a reload carries it over. */
struct alarm_arming {
	bool wanted;
	uint32_t cycle;     /* of the last list before that: the next may find that por is set */
	struct retry retry; /* of that, and of ending the restart */
	int64_t not_before_ns;
};

/* Its requests in a visit, but for arming and the value; a reload carries it over. */
struct alarm_visit {
	struct retry retry;
	int64_t not_before_ns;
	uint8_t refused; /* which the retries are of, as enum ows_unarmed; 0: none */
};

struct alarm_item {
	uint32_t row, device;
	struct alarm_strings strings;
	bool listed;   /* its device stands in the list of /alarm */
	bool asks_por; /* the device left the list after a restart: is its por 0 now? */
	struct alarm_occurrence occurrence;
	struct alarm_restart restart;
	struct alarm_arming arming;
	struct alarm_visit visit;
	uint32_t cycle_of[ALARM_DEEDS]; /* the last cycle in which that was done for it; 0: none */
	bool set[ALARM_DEEDS];          /* of a deed that reads a flag: what it read */
};

/* What counts for no row of the table. */
#define TABLE_NO_ROW UINT32_MAX

/* What is known of the lists of a target; a reload carries it over. */
struct alarm_listing {
	uint32_t cycle;     /* lists so far */
	bool polls;         /* the bus has no alarm search */
	bool logged;        /* the log has a line about that */
	int64_t next_ns;    /* earliest time of the next list */
	int64_t wait_ns;    /* doubles while lists fail */
	unsigned strangers; /* listed devices without alarm item that were logged */
	uint8_t stranger[16][8];
};

struct alarm_machine {
	enum alarm_state state;
	struct alarm_item **items; /* which this lane serves now, in the order of the table */
	uint32_t count;
	struct alarm_listing list;
	bool searches;             /* the list can be kept to families */
	bool whole;                /* to be listed is the alarm of a device that has a latch */
	int64_t position;          /* iAlarmPos */
	int64_t init_position;     /* iAlarmInitPos */
	unsigned in_a_row;         /* nCons */
	bool in_work;              /* a request of the machine is with the bus */
	bool passed;               /* since BYPASS was entered */
	bool anew;                 /* no list was asked for since the target is up */
	uint32_t yielded;          /* writes that went before the list, or before SetAlarm */
	int64_t bypass_ns;         /* when it ends at the latest; 0: just entered */
	struct alarm_item *arming; /* its SetAlarm is compared; NULL: that of none */
	bool arm_writes;
	struct alarm_item *collecting; /* its latch is read ahead of a reset; NULL: that of none */
	bool proving;                  /* 0 was written to por, which is read back */
	uint32_t held;                 /* the facts that wait for the end of that */
	char list_path[128];           /* "/alarm", or "/alarm/29,12"; if named */
	bool named;
	uint8_t families[32];
	unsigned family_count;
};

/* All alarm items of the table; the caller frees them. 0 or -ENOMEM. */
int alarm_items_init(const struct table *table, struct alarm_item **items, uint32_t *count);
/* Has the item a SetAlarm that can be compared with the chip? */
bool alarm_arms(const struct alarm_item *item);

/* Room for that many items; the machine has none yet. 0 or -ENOMEM. */
int alarm_init(struct alarm_machine *m, uint32_t room, bool searches);
void alarm_free(struct alarm_machine *m);
/* The lane serves the item from now on: it starts at ALARM_POR_READ, its SetAlarm is compared. */
void alarm_take_item(struct alarm_machine *m, struct alarm_item *item, int64_t now_ns);
/*
 * The lane does not serve the item any more: if the machine worked on it, the machine goes on with
 * the next alarm. True: the answer to what the machine asked last is of no interest any more.
 */
bool alarm_drop_item(struct alarm_machine *m, struct alarm_item *item);
/* Make list_path of the families of its items, and whole. */
void alarm_name_list(struct alarm_machine *m, const struct table *table);

/* The target was lost: from the beginning when it is back. */
void alarm_restart(struct alarm_machine *m);
/* Are the items read by alarms (and now and then), not in every period? */
bool alarm_serves(const struct alarm_machine *m);
/* An output of the device has changed though nothing was written to it. */
void alarm_output_differs(struct alarm_machine *m, uint32_t device);
