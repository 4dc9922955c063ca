/* SPDX-License-Identifier: MIT */
/*
 * The native bus: the OWFS namespace over the links of one master. The parts:
 *
 *   native.c   the bus contract: create, submit, step, suspend
 *   master.c   open, lost, opened again; the recovery ladder
 *   resolve.c  what a path means
 *   job.c      one request on its way: what it waits for, its next step, what follows a failure
 *   exchange.c properties read and written
 *   answer.c   answers, and the cache
 *   convert.c  who converts when: one Convert T for all thermometers due on a channel
 *   simultaneous.c  writes to /simultaneous
 *   hunt.c     searches: background, directories, alarms; devices lost and found
 *   listing.c  directories
 *   virtual.c  the directories that belong to no device: simultaneous, interface, system
 *   settings.c /settings
 *   statistics.c  /statistics, and how requests are counted for it
 *   structure.c  /structure
 *
 * All of it runs on the bus's thread; but the counters, which any thread may read.
 */
#ifndef HAL_NATIVE_H
#define HAL_NATIVE_H

#include "hal/chips/family.h"
#include "hal/native/cache.h"
#include "hal/owfs/path.h"
#include "hal/wire/device.h"
#include "hal/wire/link.h"
#include "hal/wire/search.h"

#define NATIVE_DEPTH 400
#define NATIVE_CHANNELS 64
#define NATIVE_IDLE_TIMEOUTS 8
#define NATIVE_S INT64_C(1000000000)

enum native_count {
	COUNT_RETRIES,
	COUNT_BUS_RESETS,
	COUNT_CHIP_RESETS,
	COUNT_POWER_CYCLES,
	COUNT_REOPENS,
	COUNT_CHECKSUMS,
	COUNT_SHORTS,
	COUNT_LINK_ERRORS,
	COUNT_CONVERSIONS,
	COUNT_SEARCHES,
	COUNT_TRANSACTIONS,
	COUNT_READS,
	COUNT_WRITES,
	COUNT_DIRECTORIES,
	COUNT_CACHE_HITS,
	COUNT_POWER_FAULTS,
	COUNT_FOUND,
	COUNT_LOST,
	COUNT_RESTARTED,
	COUNT_WIRE_US,
	COUNT_I2C_TRANSFERS,
	COUNT_SYSCALLS,
	COUNTS,
};

enum job_kind {
	JOB_NONE,      /* a free slot */
	JOB_PROPERTY,  /* read or write of a property */
	JOB_PROBE,     /* is the device there? */
	JOB_SCAN,      /* a fresh list of devices */
	JOB_ALARM,     /* a list of the devices in alarm */
	JOB_LISTING,   /* a list that needs no wire */
	JOB_STRUCTURE, /* read in /structure */
	JOB_CONVERT,   /* write to /simultaneous/temperature or voltage */
};

enum job_state {
	JOB_NEW,        /* not looked at */
	JOB_QUEUED,     /* not begun, or to be begun again */
	JOB_LOCATE,     /* the device is not in the table: look for it channel by channel */
	JOB_PREPARE,    /* thermometer: power supply and resolution */
	JOB_DUE,        /* thermometer: waits for the next Convert T */
	JOB_CONVERTING, /* ... which is under way until ready_ns */
	JOB_RUN,        /* transactions */
};

struct job {
	struct bus_req *req;
	uint8_t kind, state;
	bool begun, fresh, verified, locks;
	bool again;                 /* its conversion was unproven, and is made a second time */
	bool waits;                 /* PREPARE: until another job has read its resolution */
	unsigned element;           /* of a separate array, when all of it is asked for */
	uint8_t tries;              /* transactions that failed in a row */
	uint8_t faults;             /* power-fault readings in a row */
	uint8_t failures;           /* how often it was begun again after an error */
	uint8_t channel;            /* which one is being searched */
	int bus;                    /* N of /bus.N, -1: all */
	const struct family *table; /* of a path without device */
	struct path path;
	uint32_t order; /* lower came earlier */
	int64_t since_ns;
	const struct property *property;
	int extension;
	int64_t ready_ns;    /* CONVERTING */
	size_t out;          /* bytes of the answer so far */
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

struct channel {
	struct link *link;
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
	int64_t search_ns; /* next pass of the background search */
	uint32_t round;    /* number of the background search */
	int64_t round_ns;  /* when it began */
	bool searching, dirty;
	struct search search;
	uint64_t errors, shorts, checksums, transactions;
};

/* What /statistics tells of the requests of one kind. */
enum tally_kind { TALLY_READ, TALLY_WRITE, TALLY_DIRECTORY, TALLY_OVERALL, TALLIES };

struct tally {
	uint64_t calls, success, bytes;
	uint64_t tries[3];             /* taken up a first, a second, a third time */
	uint64_t now, max, sum;        /* under way; the most; summed up at each call */
	uint64_t entries[2], lists[2]; /* DIR: of the root and its like, of devices */
};

#define NATIVE_WHERE_MAX 128

struct native {
	struct bus bus;
	struct link_master *master;
	bool up, told;
	int down_err; /* why it is down; 0: it was not opened, or let go of in order */
	bool failed;  /* suspended: it failed with what is to be seen of it at that time */
	uint64_t failed_mark;
	unsigned hunter; /* the channel whose turn to be searched is next */
	unsigned channels;
	struct channel channel[NATIVE_CHANNELS];
	int64_t hold_ns[NATIVE_CHANNELS]; /* by chip: its strong pull-up is on until then */
	struct job *holder[NATIVE_CHANNELS];
	int64_t follow_ns; /* until then an alarm's next request is waited for; 0: it is not */
	int64_t hunt_ns, pass_ns; /* background search: its next pass; what the last took */
	int64_t open_ns;          /* next try to open */
	int64_t pause_ns;         /* between tries */
	int64_t up_ns;
	int64_t grow_ns; /* next look for chips that were missing; INT64_MAX: none was */
	bool grow_told;
	uint32_t order;
	struct device_table table;
	struct cache cache;
	struct job *jobs; /* NATIVE_DEPTH */
	unsigned lent;
	char where[NATIVE_WHERE_MAX];
	int64_t volatile_ns, stable_ns; /* how long cached values live */
	int64_t presence_ns; /* how long a device that answered is present without being asked */
	bool uncached;       /* no request is answered from what is kept */
	bool unaliased;      /* listings show ids, not aliases */
	struct tally tally[TALLIES];
	int64_t delay_ns;                             /* the longest that a request took */
	uint32_t idle_timeouts[NATIVE_IDLE_TIMEOUTS]; /* settings without effect */
	char temperature_scale;
	char pressure_scale[8];
	uint64_t wire_ns,
		wire_seen_ns[NATIVE_CHANNELS]; /* of all links so far; what each said last */
	uint64_t count[COUNTS];                /* written by one thread, whole for any */
	struct bus_counter counters[COUNTS];
};

/*
 * For a scheme's bus_ops.create: a native bus over this kind of master. All errors as
 * bus_ops.create. The other slots are NATIVE_BUS_SLOTS.
 */
int native_create(const struct bus_ops *ops, const struct link_master_ops *master,
                  const char *where, const struct bus_env *env, struct bus **bus, char *why,
                  size_t why_size);
void native_destroy(struct bus *bus);
/* bus_ops.option: what the link master has. */
int native_option(struct bus *bus, const char *key, const char *text, char *why, size_t why_size);
int native_submit(struct bus *bus, struct bus_req *req);
int64_t native_step(struct bus *bus, int64_t now);
void native_suspend(struct bus *bus, bool yes);
int native_there(struct bus *bus);
const struct bus_counter *native_counters(struct bus *bus, size_t *n);
#define NATIVE_BUS_SLOTS \
	.depth = NATIVE_DEPTH, .searches = true, .destroy = native_destroy, \
	.option = native_option, .submit = native_submit, .step = native_step, \
	.suspend = native_suspend, .there = native_there, .counters = native_counters

/* --- Shared between the parts --- */
int64_t native_now(const struct native *native);
void native_count(struct native *native, enum native_count what);
void native_event(struct native *native, enum bus_news news, const uint8_t rom[8], int err,
                  const char *text);
bool native_held(const struct native *native, unsigned channel, const struct job *job, int64_t now);

/* settings.c: as they are at the start */
void native_settings(struct native *native);

/* master.c */
int64_t master_step(struct native *native, int64_t now); /* opens; when to try again */
void master_down(struct native *native, int err, const char *why);
/* After a link's error: one rung. False: the target is down now. */
bool master_recover(struct native *native, unsigned channel, int err);
void master_good(struct native *native, unsigned channel);
/* Now and then: take chips that were missing. *next as elsewhere. */
void master_grow(struct native *native, int64_t now, int64_t *next);

/* resolve.c: fills the job from its path. 0 or the error to answer. */
int resolve(struct native *native, struct job *job);

/* answer.c */
void job_answer(struct native *native, struct job *job, int err);
void job_answer_cached(struct native *native, struct job *job, const struct cache_entry *entry);
void job_keep(struct native *native, struct job *job);
/* How long a value of the property is true enough for a request that takes a cached one. */
int64_t property_life_ns(const struct native *native, const struct property *property);
/* Let go of device and pull-up. */
void job_unlock(struct native *native, struct job *job);
void job_restart(struct native *native, struct job *job);
/* Begin again with what its conversion left. */
void job_reread(struct native *native, struct job *job);

/* exchange.c */
/* Make the txn ready for the next element, from its beginning. */
void job_txn(struct native *native, struct job *job);
void job_run_property(struct native *native, struct job *job, int64_t now);
/* A transaction of the job has ended with err (0: well): what it showed of link and device. */
void job_saw(struct native *native, struct job *job, int err, int64_t now);

/* job.c */
/* One transaction or less. */
void job_step(struct native *native, struct job *job, int64_t now);
/* What the path means, and the answer, if it needs no wire. */
void job_look(struct native *native, struct job *job, int64_t now);
/* It failed: again, or answer. */
void job_failed(struct native *native, struct job *job, int err);
/* May it do its next transaction now? If not, *next is lowered to when it may. */
bool job_ready(const struct native *native, const struct job *job, int64_t now, int64_t *next);

/* convert.c */
void convert_begin(struct native *native, struct job *job, int64_t now);
/* Is the chip, as far as is known, at the resolution that the job asks for? */
bool convert_right(const struct job *job);
void convert_prepare(struct native *native, struct job *job, int64_t now);
/* Start a conversion where one is due. True: did a transaction. *next: when to look again. */
bool convert_step(struct native *native, int64_t now, int64_t *next);
/* Convert T to all; -EBADMSG if nobody begins. strong: with the pull-up, which holds it longest ns. */
int convert_broadcast(struct native *native, unsigned n, bool strong, int64_t longest);

/* simultaneous.c */
void convert_all(struct native *native, struct job *job, int64_t now);

/* hunt.c */
void hunt_lost(struct native *native, struct device *device);
void hunt_restarted(struct native *native, struct device *device);
void hunt_seen(struct device *device, int64_t now);
void hunt_reset(struct native *native, int64_t now);
/* One pass of a background search; true: did one. initial: at once, for the first list. */
bool hunt_step(struct native *native, int64_t now, bool idle, int64_t *next);
bool hunt_initial(const struct native *native);
void hunt_locate(struct native *native, struct job *job, int64_t now);
void hunt_scan(struct native *native, struct job *job, int64_t now);

/* listing.c */
/* A whole answer that needs no wire. 0 or the error. */
int listing(struct native *native, struct job *job);
/* One more device in an answer. */
int listing_add_device(struct native *native, struct job *job, const struct device *device);
/* What stands in / and /bus.N beside the devices. */
int listing_add_rest(struct native *native, struct job *job);

/* virtual.c: the table of names in /statistics and the like; NULL: none of that name. */
const struct family *virtual_family(const char *name, size_t len);
extern const struct family virtual_settings, virtual_statistics;

/* statistics.c: a request was taken, and is answered with so many bytes (those of a read cached). */
void tally_begin(struct native *native, struct job *job);
void tally_end(struct native *native, struct job *job, const struct bus_answer *answer);

/* structure.c: reading a path in /structure. The text's length or an error. */
int structure_read(const char *path, size_t len, char *text, size_t room);
const struct family *structure_family(const char *path, size_t len, size_t *used);

#endif
