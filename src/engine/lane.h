/* SPDX-License-Identifier: MIT */
/*
 * A lane: the engine's side of one bus. It decides what is asked next, keeps what is lent, and
 * turns answers into changes of the table. Private to the engine.
 */
#ifndef ENGINE_LANE_H
#define ENGINE_LANE_H

#include "alarm.h"
#include "due.h"
#include "engine.h"
#include "guest.h"
#include "route.h"
#include "structure.h"
#include "table.h"

/* Room for one answer or one value to be written. */
#define LANE_DATA (TABLE_TEXT_CAP + 64)
/* Room for the path of a request; the longest is one of the alarm machine. */
#define LANE_PATH (2 * ALARM_TEXT + 16)
/* How long after its deadline a request is given up that the bus did not answer at all. */
#define LANE_GRACE_NS 250000000LL

enum purpose { FOR_READ, FOR_WRITE, FOR_STRUCTURE, FOR_ALARM, FOR_PROBE, FOR_GUEST };

/* A request and its room. Its id is slot | turn << 16, so that a late answer is told apart. */
struct slot {
	struct bus_req req;
	bool lent;     /* the bus has it */
	bool given_up; /* its time is over; a late answer only frees the slot */
	bool moved;    /* another lane serves its signal now; likewise */
	bool kept;     /* while a reload goes on: a reading that was in flight before it */
	enum purpose purpose;
	uint32_t row;  /* of the table, of structure.checks (FOR_STRUCTURE), a device (FOR_PROBE) */
	uint16_t turn;
	int64_t begun_ns;
	uint64_t begun; /* in this period */
	int64_t value;  /* of a write */
	uint32_t stamp; /* of the command written */
	bool one_shot;  /* the write was that of _WriteOneShot */
	bool pressing;  /* a guest that goes as an input */
	struct engine_guest *guest; /* path and data are his */
	uint8_t data[LANE_DATA];
	char path[LANE_PATH]; /* of req: what is lent stands for itself, also over a reload */
};

#define LANE_COUNTERS(X)                                                                           \
	X(requests)       /* given to the bus */                                                   \
	X(reads)          /* ended with success */                                                 \
	X(writes)         /* ended with success */                                                 \
	X(item_errors)                                                                             \
	X(target_failures)                                                                         \
	X(reconnects)                                                                              \
	X(given_up)       /* the bus did not answer in time */                                     \
	X(late_answers)   /* came after that */                                                    \
	X(unknown_answers) /* nobody asked, or a second time */                                    \
	X(power_faults)   /* 85 and 127.94 refused */                                              \
	X(out_of_range)   /* values that the chip cannot have measured, refused */                 \
	X(device_returns) /* devices that came back */                                             \
	X(alarm_lists)    /* readings of /alarm */                                                 \
	X(alarms)         /* occurrences */                                                        \
	X(power_on_resets)                                                                         \
	X(moves_in)       /* signals that came from another target */                              \
	X(moves_out)      /* signals that went to another target */                                \
	X(probes)         /* looks for a device that another target does not have */               \
	X(not_released)   /* the next way was opened before this one had let go */                 \
	X(guests)         /* requests of clients of the served protocol, given to the bus */       \
	X(guest_errors)

struct lane {
	struct engine *engine;
	const struct engine_port *port;
	unsigned index;
	bool up, was_up, stuck;
	bool open;          /* it is the one way of its group that is open */
	bool said_up;       /* what the bus said last, asked or not */
	int64_t heard_ns; /* last answer or event of the bus */

	struct slot *slots;
	uint16_t *free;     /* slots that are not lent */
	unsigned free_count;
	int64_t look_ns;    /* no request's time is over before */
	unsigned depth, lent, writes_in_work;

	struct due_set inputs, outputs; /* rows to read, rows to write */
	uint32_t writers;       /* rows whose writing is enabled */
	uint32_t writes_in_row; /* since the last read was begun */
	struct due_set checks; /* of the engine's structure: to be asked here */

	struct due_set probes; /* devices to be looked for here */
	bool probing;          /* one of them is with the bus */
	int64_t probe_ns;      /* earliest time of the next */

	struct alarm_machine alarm;
	struct alarm_request alarm_request; /* the next, or that of alarm_slot */
	struct slot *alarm_slot;
	char *list; /* ALARM_LIST bytes: lent with a request for the list of /alarm */

	struct {
		struct engine_guest *first, *last; /* who wait */
		unsigned lent;
		unsigned passed; /* requests of the table since one of them */
		unsigned pressing; /* of those lent, who go as inputs */
	} guests;

	struct {
#define X(name) uint64_t name;
		LANE_COUNTERS(X)
#undef X
	} counters;
};

int lane_init(struct lane *lane, struct engine *engine, const struct engine_port *port,
              unsigned index);
void lane_free(struct lane *lane);

/* The row is served here from now on, no longer: rows that are due, writers, checks of its type. */
void lane_take_row(struct lane *lane, uint32_t row);
void lane_drop_row(struct lane *lane, uint32_t row);
/*
 * A reload: this lane, which was never filled, goes on where `before` of another engine stands. What
 * is lent comes over and counts for nothing but its slots, and for outputs that it may still reach,
 * until readings are resumed: successors[row] is that row here, TABLE_NO_ROW: it has none.
 */
void lane_adopt(struct lane *lane, struct lane *before, const uint32_t *successors);
/*
 * The readings that are in flight when a reload begins (keep, before all is disowned); those whose
 * signals stay in this lane go on here (resume, when its signals are known).
 */
void lane_keep_reads(struct lane *lane);
void lane_resume_reads(struct lane *lane);
/*
 * Requests in flight whose signals another lane serves now (all: every one of them) count for
 * nothing but their slots any more.
 */
void lane_disown(struct lane *lane, bool all);
/* Likewise the request of the alarm machine, which begins anew. */
void lane_disown_alarm(struct lane *lane);
/* A write of the write step, or of InitValue by the alarm machine. */
bool lane_writes_output(const struct lane *lane, const struct slot *slot);
/* A write whose signal another lane serves, and which may still reach the device. */
bool lane_in_doubt(const struct lane *lane, const struct slot *slot);
void lane_forget_probes(struct lane *lane);
/* The target of an open lane went up; the bus said so now or before. */
void lane_up(struct lane *lane, const char *text, int64_t now_ns);

/* Submit as much as the order of the lane and the depth of its bus allow. */
void lane_fill(struct lane *lane, int64_t now_ns);
/* Give the slot's request to the bus; false: it takes none now. */
bool lane_lend(struct lane *lane, struct slot *slot, int64_t now_ns);
/* When it wants to be filled again though nothing ended; INT64_MAX: not before. */
int64_t lane_wake(const struct lane *lane);
void lane_answer(struct lane *lane, const struct bus_answer *answer, int64_t now_ns);
void lane_event(struct lane *lane, const struct bus_event *event, int64_t now_ns);
/* Give requests up whose time is over; returns when the next one's is. */
int64_t lane_timeouts(struct lane *lane, int64_t now_ns);
/* No answer at all; answers again. */
void lane_stuck(struct lane *lane, int64_t now_ns);
void lane_unstuck(struct lane *lane, int64_t now_ns);

/*
 * guest.c. Is it a guest's turn, where the table has something to ask too (others), or not? Ask for
 * the first. A request of the table went before them.
 */
bool guest_turn(const struct lane *lane, bool others);
bool guest_ask(struct lane *lane, struct slot *slot, int64_t now_ns);
void guest_passed(struct lane *lane);
/*
 * A reload: who waits, or has something lent, goes on in a lane that has taken the slots over; is
 * told that its target is down; gets back what it had lent to buses that have ended.
 */
void guests_adopt(struct lane *lane, struct lane *before);
void guests_refuse(struct lane *lane);
void guests_release(struct lane *lane);

#endif
