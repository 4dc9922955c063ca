/* SPDX-License-Identifier: MIT */
/*
 * The state of a native bus, and of each request that it has: the files of this room work on it.
 * All of it belongs to the thread of the bus; any thread may read the counters.
 */
#pragma once

#include "hal/chips/bridges/sensor.h"
#include "hal/chips/family.h"
#include "hal/native/cache.h"
#include "hal/native/limits.h"
#include "hal/owfs/path.h"
#include "hal/wire/coupler.h"
#include "hal/wire/device.h"
#include "hal/wire/link.h"
#include "hal/wire/search.h"
#include "hal/wire/txn.h"

#define NATIVE_IDLE_TIMEOUTS 8

/* What a bus counts, and the counter's name. */
#define NATIVE_COUNTS(X) \
	X(RETRIES, "retries") /* transactions made again after an error of the adapter */ \
	X(BUS_RESETS, "recover_bus_reset")     /* resets of a wire after link errors */ \
	X(CHIP_RESETS, "recover_chip_reset")   /* resets of the bridge chip */ \
	X(POWER_CYCLES, "recover_power_cycle") /* the supply was switched off and on */ \
	X(REOPENS, "recover_reopen")           /* adapter and chips were opened again */ \
	X(CHECKSUMS, "checksum_errors")        /* answers with a wrong checksum */ \
	X(SHORTS, "shorts")                    /* times that data was at ground */ \
	X(LINK_ERRORS, "link_errors")          /* errors of the adapter or its chip */ \
	X(CONVERSIONS, "conversions")          /* conversions of thermometers and voltages */ \
	X(SEARCHES, "search_passes")           /* passes of the search for devices */ \
	X(TRANSACTIONS, "wire_transactions")   /* resets of the wire with what follows */ \
	X(READS, "reads")                      /* properties read */ \
	X(WRITES, "writes")                    /* properties written */ \
	X(DIRECTORIES, "directories")          /* lists of devices and properties */ \
	X(CACHE_HITS, "cache_hits")            /* readings that needed no wire */ \
	X(POWER_FAULTS, "power_faults")        /* readings of a sensor without power, refused */ \
	X(FOUND, "devices_found")              /* devices that are new, or back */ \
	X(LOST, "devices_lost")                /* devices that are gone */ \
	X(RESTARTED, "devices_restarted")      /* devices that lost their power meanwhile */ \
	X(WIRE_US, "wire_us")                  /* time in which the wire was busy */ \
	X(I2C_TRANSFERS, "i2c_transfers")      /* calls of the adapter */ \
	X(SYSCALLS, "syscalls")                /* calls of the kernel for the adapter */ \
	X(WIRES, "wires")                      /* wires of the target */ \
	NATIVE_WIRE_COUNTS(X, 0) \
	NATIVE_WIRE_COUNTS(X, 1) \
	NATIVE_WIRE_COUNTS(X, 2) \
	NATIVE_WIRE_COUNTS(X, 3) \
	NATIVE_WIRE_COUNTS(X, 4) \
	NATIVE_WIRE_COUNTS(X, 5) \
	NATIVE_WIRE_COUNTS(X, 6) \
	NATIVE_WIRE_COUNTS(X, 7)
/* Of the first wires, those of a DS2482-800, each by itself. */
#define NATIVE_WIRE_COUNTS(X, n) \
	X(WIRE_##n##_US, "wire_" #n "_us")         /* time in which wire N (0 to 7) was busy */ \
	X(WIRE_##n##_ERRORS, "wire_" #n "_errors") /* checksums, shorts and errors of wire N */
enum native_count {
#define X(count, name) COUNT_##count,
	NATIVE_COUNTS(X)
#undef X
		COUNTS,
};
#define NATIVE_COUNTED ((COUNTS - COUNT_WIRE_0_US) / 2)

enum job_kind {
	JOB_NONE,      /* a free slot */
	JOB_PROPERTY,  /* read or write of a property */
	JOB_PROBE,     /* is the device there? */
	JOB_SCAN,      /* a fresh list of devices */
	JOB_ALARM,     /* a list of the devices in alarm */
	JOB_LISTING,   /* a list that needs no wire, but for what chip it is of */
	JOB_STRUCTURE, /* read in /structure */
	JOB_CONVERT,   /* write to /simultaneous/temperature or voltage */
};

enum job_state {
	JOB_NEW,        /* not looked at */
	JOB_QUEUED,     /* not begun, or to be begun again */
	JOB_LOCATE,     /* the device did not answer, or (!verified) was never found */
	JOB_PREPARE,    /* thermometer: power supply and resolution */
	JOB_DUE,        /* thermometer: waits for the next Convert T */
	JOB_CONVERTING, /* ... which is under way until ready_ns */
	JOB_RUN,        /* transactions */
};

/* Its conversion is made again (thermometer_proof.h): nothing proved that the chip made it. */
enum job_again {
	AGAIN_NO,
	AGAIN_MARK,   /* at few bits, so that the next result differs */
	AGAIN_MARKED, /* ... and that has been read */
	AGAIN_LAST,   /* for the last time */
};

/* What the chip has sent could be the idle wire: it is read between two searches for its id. */
enum job_prove {
	PROVE_NOT,
	PROVE_BEFORE, /* the search before the second reading comes next */
	PROVE_READ,   /* ... that reading */
	PROVE_AFTER,  /* ... the search after it */
};

/* Of a job of a thermometer, while wires are searched for the first time (first.h). */
enum job_first {
	FIRST_NO,
	FIRST_TAKES_PART, /* in the conversion for all of its wire */
	FIRST_LEFT,       /* to the search: it did not answer */
};

struct job {
	struct bus_req *req;
	uint8_t kind, state;
	bool begun, fresh, verified, locks;
	uint8_t again;              /* enum job_again */
	uint8_t prove;              /* enum job_prove */
	bool offered;               /* a function of the property can answer it */
	bool soon;                  /* its device failed lately: it goes ahead of its rank */
	bool alone;                 /* its next transaction is made with no others (together.h) */
	bool sought;                /* LOCATE: the look under way has not decided it yet */
	uint8_t first;              /* enum job_first */
	uint64_t likely;            /* ... wires on which some id begins as its own (guess.h) */
	bool waits;                 /* PREPARE: until another job has read its resolution */
	bool rests;                 /* PREPARE: until the chip does not convert */
	unsigned element;           /* of a separate array, when all of it is asked for */
	uint8_t tries;              /* transactions that failed in a row */
	uint8_t faults;             /* power-fault readings in a row */
	uint8_t failures;           /* how often a transaction of it failed */
	uint8_t retries;            /* how often it was begun again after an error */
	uint8_t channel;            /* which one is being searched, or converts */
	int bus;                    /* N of /bus.N, the channel of a branch, -1: all */
	bool inside;                /* the directory of a branch */
	const struct family *table; /* of a path without device */
	struct path path;
	uint32_t order; /* lower came earlier, or has waited longer for its next part */
	uint8_t steps;  /* transactions since then */
	int64_t since_ns;
	uint64_t wire_ns;  /* slots of its own transactions (cost_of_job) */
	int64_t locate_ns; /* LOCATE: since then */
	int64_t late_ns;   /* native's, when the request came */
	const struct property *property;
	int extension;
	int64_t ready_ns;    /* CONVERTING */
	size_t out;          /* bytes of the answer so far */
	uint32_t changes;    /* the device's, when the first part of a long answer was read */
	size_t taken;        /* WRITE: bytes used */
	uint8_t families[8]; /* ALARM: only these; 0 behind the last */
	uint8_t family_i;
	bool merged; /* WRITE of one element: the others have been read */
	bool searching;
	bool heard;  /* SCAN and ALARM: a channel answered */
	size_t mark; /* ... bytes of the answer before this channel */
	struct search search;
	struct txn txn;
};

enum native_simultaneous { SIMULTANEOUS_TEMPERATURE, SIMULTANEOUS_VOLTAGE, SIMULTANEOUS };

/* Of a channel: the search for keys. */
struct touch {
	struct search search;
	bool searching;
	uint8_t family;   /* which of those that are searched for */
	uint8_t spoiled;  /* searches in a row that a checksum ended */
	bool holds;       /* a key was there when the last round ended */
	bool used;        /* of a branch: others have had it on since then, or it has news */
	int64_t ended_ns; /* ... when that was */
	int64_t begun_ns; /* the search of this family */
	int64_t round_ns; /* ... of the first one */
	int64_t whole_ns; /* ... of the first one of the last round that was right to its end */
	int64_t next_ns;  /* when to search again */
	int64_t turn_ns;  /* ... of a branch without a reason */
};

/* Of a wire: the conversions that begin before its first search has ended (first.h). */
struct first {
	bool guessing, guessed; /* the search for what is asked for (guess.h): begun, at its end */
	bool likely;            /* ... it met one */
	bool tried;
	bool refused;     /* the last start of them failed: there are no more */
	int64_t ready_ns; /* 0: there are none */
};

/* Of a wire: the end of its last Convert T for all (ending.h). */
struct ending {
	bool asks;        /* by read slots */
	uint64_t resets;  /* of the link since then; after another reset no chip would answer */
	int64_t begun_ns; /* Convert T */
	int64_t next_ns;  /* next question */
	int64_t took_ns;  /* the conversion before, as seen; 0: not known */
};

struct channel {
	struct link *link;
	struct trunk *trunk;    /* of a wire with couplers: its link */
	uint8_t wire;           /* itself, or on which the coupler of a branch is */
	bool gone;              /* of a branch: its coupler is lost */
	uint8_t rung;           /* the next of the recovery ladder */
	uint8_t alarm_searches; /* since a list of the alarms was empty */
	bool listed;            /* its devices have been searched for once */
	bool power_asked;       /* all thermometers were asked for their supply at once */
	bool all_external;      /* ... and none is parasitic */
	bool is_short;
	int64_t due_ns;    /* when the first thermometer became due; 0: none */
	int64_t single_ns; /* when those due are asked one by one next; 0: not known yet */
	/* End of the last conversion of all; 0: none. */
	int64_t simultaneous_ns[SIMULTANEOUS];
	int64_t search_ns;     /* next pass of the background search */
	uint32_t round;        /* number of the background search */
	uint32_t passes;       /* counts those of a round, from its number on */
	int64_t whole_ns;      /* when the last one began that was right to its end; 0: none was */
	int64_t looked_ns;     /* ... look for those that requests name (locate.h) */
	int64_t missed_ns;     /* when the last device was missed by all looks to verify it */
	uint8_t missed;        /* so many in a row, as far as counting them matters */
	uint32_t asleep_round; /* the last that found a bridge without id (DS28E18); 0: none */
	int64_t round_ns;      /* when it began */
	bool searching, dirty;
	bool cuts;       /* passes of this round end soon after a known device is alone */
	uint8_t spoiled; /* passes in a row that a checksum ended */
	struct search search;
	struct touch touch;
	struct first first;
	struct search guess; /* first.guessing */
	struct ending ending;
	uint64_t errors, shorts, checksums, transactions;
};

/* Which way of converting is faster (schedule.h). */
enum schedule_work {
	SCHEDULE_READ,  /* a result was read */
	SCHEDULE_START, /* one chip was made to convert */
	SCHEDULE_OTHER, /* a transaction of another request */
	SCHEDULE_FREE,  /* what gives way to all else: searches, Convert T for all */
};

/* The kind of job that is next, ahead of another start. */
enum schedule_debt {
	OWES_NOTHING,
	OWES_OTHER, /* chips convert, in turn or with the pull-up: one that reads no thermometer */
	OWES_ANY,   /* a start was tried in vain: whoever is ready */
};

/* What is known of a bus; zero: nothing yet. */
struct schedule {
	enum schedule_work doing;   /* what the present step of the bus does */
	int64_t took_ns[2];         /* SCHEDULE_READ and SCHEDULE_START, mean; 0: not known */
	int64_t window_ns;          /* when the present window of `others` began */
	int64_t others_ns, last_ns; /* SCHEDULE_OTHER in this window and in the last */
	uint8_t owes;               /* enum schedule_debt */
};

/* Looks for devices that no search has found (locate.h). */
struct locate {
	bool waits, urgent; /* a request waits for one; ... of an alarm or an output */
	bool looking;       /* a look at `channel` is under way */
	unsigned channel;   /* the last one that was looked at */
	uint8_t tries;      /* errors of this look */
	int64_t begun_ns;   /* this look */
	int64_t credit_ns;  /* wire that looks may take; less than 0: they took more */
	int64_t counted_ns; /* ... as of then */
	int64_t idle_ns;    /* when no other job needs the wire: the next one */
	int64_t took_ns;    /* the last transaction */
	uint64_t found;     /* COUNT_FOUND when the requests were looked at last */
	uint8_t in_row;     /* looks that found one, without a turn of others */
};

#define NATIVE_WHERE_MAX 128

/* The file that writes a member stands before it; all may read. */
struct native {
	/* native.c */
	struct bus bus;
	struct link_master *master;
	bool failed; /* suspended: it failed with what is to be seen of it at that time */
	uint64_t failed_mark;
	struct job *jobs; /* NATIVE_DEPTH */
	bool soon_ran;    /* the last step was that of a job that goes soon */
	bool early;       /* the search had its turn, a request is next; before all were searched */
	unsigned failed_jobs; /* jobs of devices that failed lately, as of the last step */
	struct job *all;      /* the JOB_CONVERT that waits longest; it may be over */
	int64_t due_ns;       /* the next step; 0: there was none */
	int64_t late_ns;      /* so long the host has kept the thread from the processor in all */
	uint32_t order;       /* of the next job */
	char where[NATIVE_WHERE_MAX];
	struct bus_counter counters[COUNTS];

	/* state.c */
	uint64_t wire_ns,
		wire_seen_ns[NATIVE_CHANNELS], /* of all links so far; what each said last */
		wire_each_ns[NATIVE_CHANNELS]; /* of each so far */

	/* master.c; native.c, when it suspends the bus or lets it go on */
	bool up;
	struct bus_loss loss;
	int down_err;          /* why it is down; 0: it was not opened, or let go of in order */
	int64_t open_ns;       /* next try to open */
	int64_t pause_ns;      /* between tries */
	int64_t up_ns;         /* when it was opened */
	int64_t grow_ns;       /* next look for chips that were missing; INT64_MAX: none was */
	int64_t grow_pause_ns; /* until the one after that */
	bool grow_told;        /* one is missing, and the log says so */
	int64_t trouble_ns;    /* next look whether it has gone; INT64_MAX: there is none */
	char trouble[BUS_EVENT_TEXT]; /* as it was reported */
	unsigned channels;

	/* Every file that works on a channel: `channels` wires; branches from NATIVE_CHANNELS on */
	struct channel channel[NATIVE_ALL];

	/* branches.c; native.c switches them off */
	struct trunk trunk[NATIVE_COUPLERS];
	struct coupler coupler[NATIVE_COUPLERS];
	int64_t rest_ns; /* after an error: when to switch off again */

	/* native_hold(); answer.c lets go */
	int64_t hold_ns[NATIVE_CHANNELS]; /* by chip: its strong pull-up is on until then */
	struct job *holder[NATIVE_CHANNELS];

	/* schedule.c; convert.c and native.c say what a step does */
	struct schedule schedule;

	/* answer.c; native.c takes jobs, and ends the wait */
	unsigned lent;     /* jobs that are taken */
	int64_t follow_ns; /* until then an alarm's next request is waited for; 0: it is not */

	/* hunt.c */
	unsigned hunter;          /* the channel that is searched next */
	int64_t hunt_ns, pass_ns; /* background search: its next pass; what the last took */

	/* locate.c; native.c counts the waiting jobs */
	struct locate locate;
	/* first.c */
	bool first_turn; /* a reading has had its turn, another thing is next; native.c, too */
	bool first_left; /* a wire's first conversions have begun, and not all is done */

	/* native.c: keys are searched for; touch.c: the channel that has its turn */
	bool touch;
	bool touched; /* a search was made, or a look: a request goes first now. Also locate.c */
	unsigned toucher;         /* the channel of the last round; it may not have ended */
	unsigned next_touch[2];   /* the wire, the branch to begin with */
	int64_t touch_ns;         /* next branch at all */
	int64_t touch_in_turn_ns; /* next branch without a reason */

	/* presence.c: which devices there are; the families: what is known of each */
	struct device_table table;
	struct sensor_table sensors; /* behind bridges: set before the first step */

	/* answer.c */
	struct cache cache;

	/* tables.c */
	int64_t volatile_ns, stable_ns; /* how long cached values live */
	int64_t presence_ns; /* how long a device that answered is present without being asked */
	bool uncached;       /* no request is answered from what is kept */
	bool unaliased;      /* listings show ids, not aliases */
	int64_t idle_ns[NATIVE_IDLE_TIMEOUTS]; /* settings without effect */
	char temperature_scale;
	char pressure_scale[8];

	/* native_count(), and native.c what the links count themselves: whole for any thread */
	uint64_t count[COUNTS];
};

int64_t native_now(const struct native *native);
void native_count(struct native *native, enum native_count what);
void native_event(struct native *native, enum bus_news news, const uint8_t rom[8], int err,
                  const char *text);
bool native_has(const struct native *native, unsigned channel);
/* A channel begins anew, with what it has counted so far and the couplers of its wire. */
void native_open_channel(struct native *native, unsigned channel, struct link *link, unsigned wire);
/* The first channel from n on, a wire or a branch; NATIVE_ALL: there is none. */
unsigned native_next(const struct native *native, unsigned n);
/*
 * The first request, or the next one; and so the devices of a channel that are there, and its
 * thermometers. NULL: no more.
 */
struct job *native_job(const struct native *native, const struct job *after);
struct device *native_device(const struct native *native, unsigned channel,
                             const struct device *after);
struct device *native_thermometer(const struct native *native, unsigned channel,
                                  const struct device *after);
/* The link of a channel, if it takes part in transactions at the same time (link_ops.run_many). */
struct link *native_abreast(const struct native *native, unsigned channel);
/* Has some channel not been searched yet since the bus came up? */
bool native_initial(const struct native *native);
/* A chip of the channel is at work, and no command for all may cut that off. */
bool native_at_work(const struct native *native, unsigned channel);
/* A strong pull-up is on at the chip of this channel until then, and not for this job. 0: none. */
int64_t native_held(const struct native *native, unsigned channel, const struct job *job,
                    int64_t now);
/* ... it is on until then, for this job or (NULL) for several. */
void native_hold(struct native *native, unsigned channel, struct job *job, int64_t until_ns);
/*
 * What the job's wire did since it was looked at last was a transaction of this job. For what
 * serves several devices (searches, Convert T for all) this function is not called.
 */
void cost_of_job(struct native *native, struct job *job);
/* At the end of a step: the counters have all that was done. */
void cost_take(struct native *native);
