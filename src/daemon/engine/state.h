/* SPDX-License-Identifier: MIT */
/*
 * The state of an engine, for the files of this folder alone: structures, and nothing that acts on
 * them. Above each group of members stands the file that changes them; others only read.
 */
#pragma once

#include "hal/base/time.h"
#include "hal/bus/bus.h"
#include "src/daemon/engine/alarm/alarm_item.h"
#include "src/daemon/engine/due.h"
#include "src/daemon/engine/port.h"
#include "src/daemon/engine/routing/route.h"
#include "src/daemon/engine/table.h"
#include "src/ground/text/log.h"
#include "src/memory/shm/controller.h"
#include "src/memory/shm/force.h"
#include "src/memory/shm/image.h"

struct engine;
struct engine_guest;
struct engine_last;
struct engine_guests;

/* Room for one answer or one value to be written. */
#define LANE_DATA (TABLE_TEXT_CAP + 64)
/* Room for the path of a request; the longest is one of the alarm machine. */
#define LANE_PATH (2 * ALARM_TEXT + 16)
/* How long after its deadline a request is given up that the bus did not answer at all. */
#define LANE_GRACE_NS (250 * NS_PER_MS)

/* --- A request ------------------------------------------------------------------------------- */

enum purpose { FOR_READ, FOR_WRITE, FOR_ALARM, FOR_PROBE, FOR_RESTART, FOR_WATCH, FOR_GUEST };

/*
 * A request and its room. Its id is slot | generation << 16, so that a late answer does not fit a
 * new request.
 */
struct slot {
	/* lane.c */
	struct bus_req req;
	bool lent; /* the bus has it */
	uint16_t generation;
	int64_t begun_ns;
	uint64_t begun; /* in this period */

	/* lane_answer.c */
	bool given_up; /* its time is over; a late answer only frees the slot */
	/* lane.c, move.c */
	bool moved; /* another lane serves its signal now; an answer only frees the slot */
	bool kept;  /* while a reload goes on: a reading that was in flight before it */

	/* ask.c, guests.c and the others that ask */
	enum purpose purpose;
	uint32_t row;                /* of the table; of FOR_PROBE, _RESTART, _WATCH a device */
	int64_t value;               /* of a write */
	uint32_t stamp;              /* of the command written, 0: owsd's */
	uint32_t controller, serial; /* that gave it */
	bool one_shot;               /* that of _WriteOneShot or _ReadOneShot */
	bool as_input;               /* a guest that goes with the priority of an input */
	bool shown;                  /* a reading: the image has it that it is in work */
	struct engine_guest *guest;  /* owns path and data of the request */
	uint8_t data[LANE_DATA];
	char path[LANE_PATH]; /* of req: what is lent stands for itself, also over a reload */
};

/* --- A lane: the engine's side of one bus ---------------------------------------------------- */

#define LANE_COUNTERS(X) \
	X(requests)        /* requests given to the bus */ \
	X(reads)           /* successful reads */ \
	X(writes)          /* successful writes */ \
	X(item_errors)     /* requests that failed for their device or path */ \
	X(target_failures) /* times the target went down */ \
	X(reconnects)      /* times the target came up again */ \
	X(given_up)        /* requests not answered in time */ \
	X(late_answers)    /* answers to requests given up */ \
	X(unknown_answers) /* answers to no request, or a second time */ \
	X(power_faults)    /* readings of 85 and 127.94, refused */ \
	X(out_of_range)    /* values that the chip cannot measure, refused */ \
	X(held_back)       /* jumps beyond MaxStep, not published */ \
	X(device_returns)  /* devices that came back */ \
	X(alarm_lists)     /* readings of /alarm */ \
	X(alarms)          /* alarms of devices */ \
	X(power_on_resets) /* restarts of devices that PorAlarm showed */ \
	X(moves_in)        /* signals that came from another target */ \
	X(moves_out)       /* signals that went to another target */ \
	X(probes)          /* looks for a device that another target lacks */ \
	X(watches)         /* looks for a device that is seldom read */ \
	X(not_released)    /* the next way was opened before this one had let go */ \
	X(guests)          /* requests of served clients */ \
	X(guest_errors)    /* requests of served clients that failed */

/* What is to be said of the target, and since when; "": nothing. */
struct lane_note {
	char text[BUS_EVENT_TEXT];
	int64_t since_ns;
};

/* How the target is; a reload carries it over. */
struct lane_state {
	/* lane_state.c */
	bool up, was_up, stuck;
	int fell; /* the target failed with this: routing.c has to act on it */
	/* routing.c */
	bool open; /* the lane is the one way of its group that is open */
	/* lane_state.c; heard_ns: lane_answer.c too */
	bool reported_up; /* the last report of the bus was BUS_UP */
	int down_err; /* of its last BUS_DOWN; the log of a way that is tried again has a new one */
	struct lane_note why_down, trouble; /* shown while it is down; while it is up */
	int64_t heard_ns;                   /* last answer or event of the bus */
};

/* What the bus has, and room for it; a reload carries it over. */
struct lane_lent {
	/* lane.c */
	struct slot *slots;
	uint16_t *free; /* slots that are not lent */
	unsigned free_count, count;
	int64_t look_ns; /* no request's time is over before */
	char *list;      /* ALARM_LIST bytes: lent with a request for the list of /alarm */
	/* ask.c, lane_answer.c */
	unsigned writes;
	struct slot *alarm; /* the request of the alarm machine */
	/* ask.c */
	bool unshown; /* a reading was begun that the image does not show as in work */
};

struct lane {
	struct engine *engine;
	const struct engine_port *port;
	unsigned index;

	unsigned depth; /* slots */
	struct lane_state state;
	struct lane_lent lent;

	/* schedule.c, and ask.c takes out what it asks */
	struct due_set inputs, outputs; /* rows to read, rows to write */
	/* ask.c */
	uint32_t writes_in_row; /* since the last read was begun */
	/* lane.c, intake.c */
	uint32_t writers; /* rows that are enabled for writing */
	/* read_back.c */
	struct due_set restarts; /* devices with a power-on flag that is to be read */

	/* known.c, and routing.c puts in what is to be looked for */
	struct due_set probes; /* devices to be looked for here */
	bool probing;          /* one of them is with the bus */
	int64_t probe_ns;      /* earliest time of the next */

	/* presence.c */
	struct due_set watch; /* devices to be looked for */
	bool watching;        /* one of them is with the bus */
	int64_t watch_ns;     /* earliest time of the next */

	/* alarm.c and the files below it */
	struct alarm_machine alarm;

	/* guests.c */
	struct {
		struct engine_guest *first, *last; /* those that wait */
		unsigned lent;
		unsigned passed;    /* requests of the table since one of them */
		unsigned as_inputs; /* of those lent, how many go as inputs */
	} guests;

	struct {
#define X(name) uint64_t name;
		LANE_COUNTERS(X)
#undef X
	} counters;
};

/* --- The engine ------------------------------------------------------------------------------ */

#define ENGINE_COUNTERS(X) \
	X(periods)           /* periods since owsd started */ \
	X(late_periods)      /* periods that began more than a period late */ \
	X(steps)             /* rounds of the engine */ \
	X(commands)          /* values taken from controllers */ \
	X(refused_commands)  /* values that no program should have put there */ \
	X(deferred_commands) /* commands that came too fast, left for 10 ms */ \
	X(lost_controllers)  /* controllers that stopped beating */ \
	X(safe_outputs)      /* outputs put to SafeValue */ \
	X(reloads)           /* changed configurations taken over */

/* What the engine knows of a controller; below OWS_CONTROLLERS the index is its seat. */
struct known_controller {
	/* controllers.c */
	enum controller_is {
		CONTROLLER_FREE,
		CONTROLLER_CONNECTED,
		CONTROLLER_HUNG_UP, /* it promised a beat, and said no goodbye */
		CONTROLLER_AWAITED, /* it commanded before owsd's start */
	} is;
	struct joining_controller as; /* with a memory only while it is connected */
	bool late, may_set;
	uint32_t shown; /* commands and refused that the image has */
	int64_t joined_ns;
	int64_t left_ns; /* in awake time (engine_awake_ns()), like the next, and heard_ns */
	int64_t lose_ns; /* not before does another of its outputs go to SafeValue */

	/* in_force.c */
	uint32_t beat;
	uint32_t period_ms; /* promised; 0: none, or it said goodbye */
	int64_t heard_ns;
	uint32_t rows; /* signals with a command in force that is its own */

	/* intake.c */
	uint32_t commands, refused;
	/*
	 * Of the looks at marked slots: how many are left, since when, where the next begins,
	 * whether one has to go on, and not sooner than when.
	 */
	uint32_t looks, look_from;
	int64_t looks_ns, defer_ns;
	bool more;
	/* a text that was being written when it was looked at */
	uint32_t busy; /* record; 0: none */
	int64_t busy_ns;
};
#define ENGINE_CONTROLLERS FORCE_CONTROLLERS

/* Which way of a group is open; a reload carries it over. */
struct group_state {
	struct route_bar bar;
	bool quiet; /* all ways have failed in turn, again: one line for all, now and then */
	struct log_rate rounds;
};

/* The ways to one wire; lanes[first ..] in the order in which they are written. */
struct group {
	unsigned first;
	/* lane_state.c: a fact of its ways changed, and routing.c has to act on it */
	bool asks;
	struct route_way *ways;
	struct group_state state;
};

/* Time as the engine counts it; a reload carries it over. */
struct engine_time {
	/* schedule.c, adopt.c */
	int64_t start_ns;       /* of period first: since then all were of the same length */
	uint64_t period, first; /* boundaries since owsd's start */
	uint64_t ticked;        /* the last period that engine_tick() went on to */
	int64_t now_ns;         /* of the call in work */
	int64_t gap_ns;         /* end of the last long time without a call; 0: none */
	int64_t resumed_ns;     /* likewise, also of a shorter one */
	int64_t paused_ns;      /* sum of all such times */
	/* engine.c */
	int64_t next_ns; /* when engine_step() asked to be called again */
};

/* What record 0 shows; a reload carries it over. */
struct engine_driver {
	uint64_t transactions, reconnects;
	/* publish.c */
	uint64_t shown; /* sum of both that the image has */
};

/* The requests that the trace has shown in its present window. */
struct trace {
	int64_t since_ns;  /* begin of this window */
	unsigned shown[2]; /* in it, by success and failure */
	unsigned hidden;
};

struct engine {
	/* engine.c */
	const struct config *config;
	struct image *image;
	struct force *force;            /* NULL: none */
	const struct engine_last *last; /* NULL: none */
	struct log *log;
	const struct engine_guests *guests; /* NULL: none */
	struct lane *lanes;
	unsigned lane_count;
	struct engine_time time;

	struct table table;
	struct alarm_item *alarm_items; /* all of the table, in its order */
	uint32_t alarm_count;

	/* schedule.c */
	struct due_wheel wheel; /* all that waits for a period: engine_row_wait(), _device_wait() */
	/* limits.c */
	struct {
		uint32_t done; /* requests to shelve; one a second is forgotten */
		int64_t since_ns;
	} shelvings;

	/* routing.c; facts in ways: lane_state.c */
	struct group *groups;
	struct route_group *states; /* of the groups */
	unsigned group_count;
	struct route_way *ways;
	unsigned asking; /* groups that ask */
	bool bars;       /* a group has several ways */
	/* routing.c: when time alone leads to a step of a group; 0: not known */
	int64_t group_step_ns;
	/* known.c, and routing.c takes the devices out that it routes */
	struct known_presence *known; /* device * group_count + group; NULL: one group */
	struct due_set routes; /* devices to be routed, and the one of no device behind them */

	/* device_facts.c */
	struct due_set facts; /* devices with facts that the image does not show yet */

	/* lane_answer.c, lane_state.c; intake.c resets it */
	struct engine_driver driver;
	/* publish.c, limits.c, alarm_effect.c */
	bool published;

	/* controllers.c, in_force.c, intake.c: the seats, and after them those that it awaits */
	struct known_controller controllers[ENGINE_CONTROLLERS];
	unsigned seat_end; /* one past the last seat that is taken; controllers.c */
	/* intake.c */
	unsigned greedy; /* controllers that have used up their looks */
	/*
	 * engine_look_controllers() has nothing to do: no controller has promised a beat, no text
	 * of one is half written, and none that has gone is awaited. That function sets it; the
	 * functions that change a controller clear it.
	 */
	bool controllers_quiet;
	struct log_rate refused, resets, held_back;
	/* in_force.c: what was last seen of engine_last, and how many rows wait for it */
	uint32_t stored;
	int store_err;
	uint32_t storing;

	/* trace.c */
	struct trace trace;
	struct {
#define X(name) uint64_t name;
		ENGINE_COUNTERS(X)
#undef X
	} counters;
};

/* --- Where things stand ---------------------------------------------------------------------- */

static inline struct lane *engine_lane(struct engine *e, const struct signal *s)
{
	return &e->lanes[s->lane];
}

static inline uint32_t engine_row(const struct signal *s)
{
	return s->record - 1;
}

/* What waits in the wheel: four entries for each row, and two behind them for each device. */
enum row_wait {
	WAIT_READ,
	WAIT_WRITE,
	WAIT_TIME,    /* it changes by time alone: limit alarms, StaleAfter */
	WAIT_JOURNAL, /* the journal gets the last command */
	ROW_WAITS
};
enum device_wait { WAIT_WATCH, WAIT_ROUTE, DEVICE_WAITS };

static inline uint32_t engine_row_wait(const struct signal *s, enum row_wait wait)
{
	return engine_row(s) * ROW_WAITS + wait;
}

static inline uint32_t engine_device_wait(const struct engine *e, uint32_t device,
                                          enum device_wait wait)
{
	return e->table.count * ROW_WAITS + device * DEVICE_WAITS + wait;
}

static inline uint64_t engine_periods(const struct engine *e, int64_t ns)
{
	return (uint64_t)((ns + e->config->period_ns - 1) / e->config->period_ns);
}

/* The first period that does not begin before that time, but for those before start_ns. */
static inline uint64_t engine_period_at(const struct engine *e, int64_t ns)
{
	return e->time.first +
	       (ns > e->time.start_ns ? engine_periods(e, ns - e->time.start_ns) : 0);
}

static inline struct group *engine_group(struct engine *e, const struct lane *lane)
{
	return &e->groups[lane->port->group];
}

static inline struct route_way *engine_way(struct engine *e, const struct lane *lane)
{
	return &e->ways[lane->index];
}

/* A clock that stands still while the engine does not run: no controller is late for that time. */
static inline int64_t engine_awake_ns(const struct engine *e)
{
	return e->time.now_ns - e->time.paused_ns;
}

/* The lane that is open, or will be. */
static inline struct lane *engine_open_lane(struct engine *e, unsigned group)
{
	return &e->lanes[e->groups[group].first + e->groups[group].state.bar.open];
}

/* What is known of the device, one for each group. */
static inline struct known_presence *engine_presences(struct engine *e, uint32_t device)
{
	return &e->known[(size_t)device * e->group_count];
}
