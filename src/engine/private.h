/* SPDX-License-Identifier: MIT */
/* The engine's inside, shared by the files of this folder alone. */
#ifndef ENGINE_PRIVATE_H
#define ENGINE_PRIVATE_H

#include "lane.h"
#include "trace.h"

#define ENGINE_COUNTERS(X)                                                                         \
	X(periods)                                                                                 \
	X(late_periods)     /* boundaries that were more than a period late */                     \
	X(steps)                                                                                   \
	X(commands)         /* values taken from the command segment */                            \
	X(refused_commands) /* values no program should have put there */                          \
	X(deferred_commands) /* marks of commands that came too fast were left for 10 ms */         \
	X(lost_clients)     /* control programs that stopped beating */                            \
	X(safe_outputs)     /* outputs put to SafeValue */                                         \
	X(lost_commands)    /* command segments that were taken away and made again */            \
	X(reloads)          /* changed configurations that were taken over */

struct client {
	bool known;
	bool awaited; /* it beat before owsd's start, and did not since */
	uint32_t pid, beat;
	int64_t heard_ns;
};

/* The ways to one wire; lanes[first ..] in the order in which they are written. */
struct group {
	unsigned first;
	struct route_bar bar;
	struct route_way *ways;
	bool quiet; /* all ways have failed in turn, again: that is said now and then only */
	struct log_rate rounds;
};

struct engine {
	const struct config *config;
	struct image *image;
	struct commands *commands;
	struct log *log;
	int64_t start_ns; /* of period first: since then all were of the same length */
	uint64_t period, first; /* boundaries since owsd's start */
	struct table table;
	struct structure structure;
	struct alarm_item *alarm_items; /* all of the table, in its order */
	uint32_t alarm_count;
	struct lane *lanes;
	const struct engine_guests *guests; /* NULL: none */
	unsigned lane_count;
	struct group *groups;
	struct route_group *states; /* of the groups */
	unsigned group_count;
	struct route_way *ways;
	struct route_place *places; /* device * group_count + group; NULL: one group */
	struct due_set routes;      /* devices of which something became known, as in route_wheel */
	struct due_wheel wheel; /* row * 2: read, row * 2 + 1: write */
	struct due_wheel limit_wheel; /* rows whose limit alarms change by time alone */
	struct due_wheel route_wheel; /* devices to be routed again, the one of no device behind them */
	int64_t now_ns;         /* of the call in work */
	int64_t next_ns;        /* when engine_step() asked to be called again */
	int64_t gap_ns;         /* end of the last time in which nobody ran; 0: none */
	uint64_t transactions, reconnects;
	bool published;

	/* strings a consumer was writing when they were looked at */
	uint32_t busy_slot[8];
	int64_t busy_since_ns[8];
	unsigned busy_count;
	/* Of the looks at marked slots: how many are left, since when, where the next begins, not sooner. */
	uint32_t looks, look_from;
	int64_t looks_ns, defer_ns;

	struct client clients[OWS_CLIENTS];
	uint32_t driver_resets;
	struct log_rate refused;
	struct trace trace;
	struct {
#define X(name) uint64_t name;
		ENGINE_COUNTERS(X)
#undef X
	} counters;
};

static inline struct lane *engine_lane(struct engine *e, const struct signal *s)
{
	return &e->lanes[s->lane];
}
static inline uint32_t engine_row(const struct signal *s)
{
	return s->record - 1;
}
static inline uint64_t engine_periods(const struct engine *e, int64_t ns)
{
	return (uint64_t)((ns + e->config->period_ns - 1) / e->config->period_ns);
}
/* The first period that does not begin before that time, but for those before start_ns. */
static inline uint64_t engine_period_at(const struct engine *e, int64_t ns)
{
	return e->first + (ns > e->start_ns ? engine_periods(e, ns - e->start_ns) : 0);
}

/* schedule.c: when rows are read and written */
void engine_read_now(struct engine *e, struct signal *s);
void engine_read_at(struct engine *e, struct signal *s, uint64_t period);
void engine_read_never(struct engine *e, struct signal *s);
void engine_write_at(struct engine *e, struct signal *s, uint64_t period);
/* Put the row among those to be written, or take it away, by signal_changed(). */
void engine_write_check(struct engine *e, struct signal *s);
void engine_turn(struct engine *e, int64_t now_ns);

/* limits.c: bring the limit alarms of a signal to the present; acknowledge them */
void engine_limits(struct engine *e, struct signal *s);
void engine_limits_acknowledge(struct engine *e, struct signal *s);

/* publish.c; brings the limit alarms to the present too */
void engine_publish(struct engine *e, struct signal *s);
void engine_publish_driver(struct engine *e, int64_t now_ns);
void engine_publish_target(struct engine *e, const struct lane *lane);
void engine_publish_counters(struct engine *e);

/* intake.c: the command segment */
void engine_intake(struct engine *e, int64_t now_ns);
/*
 * The same, with as many looks as programs that mark slots without end may cost; the rest is left for
 * a later step. Returns when that is due, INT64_MAX: nothing is left.
 */
int64_t engine_intake_limited(struct engine *e, int64_t now_ns);
void engine_intake_signal(struct engine *e, struct signal *s, int64_t now_ns);
/* At start: everything that stands in it. */
void engine_intake_all(struct engine *e, int64_t now_ns);

/* clients.c: the heartbeats of control programs, and which commands are in force */
void engine_clients(struct engine *e, int64_t now_ns);
/* At start: what becomes of a command that the owsd before has left. */
void engine_resume(struct engine *e, struct signal *s, const struct command *c, int64_t now_ns);
/* Its giver did not come back, or the command is lost: SafeValue, else InitValue, else nothing. */
void engine_give_up(struct engine *e, struct signal *s);

/* completion.c: what an answer changes */
void engine_read_done(struct engine *e, struct lane *lane, const struct slot *slot,
                      const struct bus_answer *answer, int64_t now_ns);
void engine_write_done(struct engine *e, struct lane *lane, const struct slot *slot,
                       const struct bus_answer *answer, int64_t now_ns);
void engine_structure_done(struct engine *e, struct lane *lane, const struct slot *slot,
                           const struct bus_answer *answer);
/* The value of a read into the table; 0, or why it cannot be one (counted as item error). */
int engine_take_reading(struct engine *e, struct lane *lane, struct signal *s,
                        const struct slot *slot, const struct bus_answer *answer, int64_t now_ns,
                        int64_t *wait_ns);

/* alarm_effect.c: what the alarm machine changes in the table */
void engine_alarm_raised(struct engine *e, struct lane *lane, struct alarm_item *item,
                         int64_t now_ns);
/* Its latch was reset. */
void engine_alarm_ended(struct engine *e, struct alarm_item *item);
/* Its latch was read 0, or its device is not listed: the journal has the return. */
void engine_alarm_rests(struct engine *e, struct alarm_item *item, int64_t now_ns);
/* The value read under an alarm; 0 or the item error. */
int engine_alarm_value(struct engine *e, struct lane *lane, struct alarm_item *item,
                       const struct slot *slot, const struct bus_answer *answer, int64_t now_ns);
/* A request for this item failed. */
void engine_alarm_failed(struct engine *e, struct lane *lane, const struct alarm_item *item,
                         int err);
/* The device's por was read non-zero: its outputs are not what was written. */
void engine_power_on_reset(struct engine *e, struct lane *lane, const struct alarm_item *item,
                           int64_t now_ns);
/* The bus has no alarm search: the items are ordinary inputs. */
void engine_alarm_polls(struct engine *e, struct alarm_machine *m);

/* group.c: which way of a group is open */
int engine_groups_init(struct engine *e, const struct engine_setup *setup); /* 0 or -ENOMEM */
void engine_groups_free(struct engine *e);
/* A fact of the lane changed: take the steps that follow. */
void engine_group_check(struct engine *e, unsigned group, int64_t now_ns);
/* The same for all, by time; returns when to be called again. */
int64_t engine_groups_turn(struct engine *e, int64_t now_ns);
static inline struct group *engine_group(struct engine *e, const struct lane *lane)
{
	return &e->groups[lane->port->group];
}
static inline struct route_way *engine_way(struct engine *e, const struct lane *lane)
{
	return &e->ways[lane->index];
}
/* The lane that is open, or will be. */
static inline struct lane *engine_open_lane(struct engine *e, unsigned group)
{
	return &e->lanes[e->groups[group].first + e->groups[group].bar.open];
}

/* place.c: which group serves a device */
int engine_places_init(struct engine *e);
void engine_places_free(struct engine *e);
/* What an answer or the search of a bus says of a device; TABLE_NO_DEVICE is ignored. */
void engine_place(struct engine *e, const struct lane *lane, uint32_t device,
                  enum route_presence presence);
/* Somebody says that it is there, which is less than a good value of it. */
void engine_place_claimed(struct engine *e, const struct lane *lane, uint32_t device);
/* A bus has found the device: what is known of it elsewhere is old. */
void engine_place_found(struct engine *e, const struct lane *lane, uint32_t device);
/* A group has gone up or down: every device may be concerned. */
void engine_places_check(struct engine *e);
/* Route the devices of which something became known. Not from inside an answer's work. */
void engine_places_turn(struct engine *e, int64_t now_ns);
/* The next device to be looked for on this lane goes into the slot's request; false: none. */
bool engine_probe_next(struct engine *e, struct lane *lane, struct slot *slot, int64_t now_ns);
void engine_probe_done(struct engine *e, struct lane *lane, const struct slot *slot,
                       const struct bus_answer *answer, int64_t now_ns);

/* move.c: the only place where a signal's lane changes */
/* All signals of the device, TABLE_NO_DEVICE's too (devices[device_count]). */
void engine_move_device(struct engine *e, struct device *device, struct lane *to, const char *why,
                        int64_t now_ns);
/* All signals of the lane; it is not open any more. */
void engine_move_lane(struct engine *e, struct lane *from, struct lane *to, const char *why,
                      int64_t now_ns);
/* Writes in doubt ended, or their bus let go: who waits for that? */
void engine_doubts(struct engine *e);

/* guest.c: take those who wait in; an answer for one; what one who was given up had lent is back */
void engine_guests_take(struct engine *e, int64_t now_ns);
void engine_guest_done(struct engine *e, struct lane *lane, struct slot *slot,
                       const struct bus_answer *answer);
void engine_guest_gone(struct engine *e, struct slot *slot);

/* All signals of the lane: the target was lost, came back. */
void engine_lane_down(struct engine *e, struct lane *lane, int err, int64_t now_ns);
void engine_lane_up(struct engine *e, struct lane *lane, int64_t now_ns);
void engine_device_back(struct engine *e, struct lane *lane, struct device *device,
                        int64_t now_ns);

#endif
