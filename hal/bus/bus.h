/* SPDX-License-Identifier: MIT */
/*
 * The bus contract: a bus answers dir, read and write on the OWFS paths of one target.
 *
 * A backend is one `struct bus_ops`. The simple tier writes exec(), which blocks and does one
 * request at a time. The overlapping tier writes submit() and step(). Callers never see which it
 * is: they use bus_submit() and bus_step() below, which make the second out of the first.
 *
 * Times are nanoseconds of env->now() (CLOCK_BOOTTIME in production, a virtual clock in tests).
 * Errors are negative errno. A bus is used by one thread at a time, except where said.
 *
 * Room hal/bus: the bus contract, its worker threads, the list of backends.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum bus_op {
	BUS_READ,
	BUS_WRITE,
	BUS_DIR,   /* answer: full paths, each ended by '\n'. A bus that searches also takes
	              "/alarm/29,12": only these families, which is quicker */
	BUS_PROBE, /* cheapest proof that the path's device is there; no data */
};

/* What a request is for; where a bus has a choice, the lower goes first. */
enum bus_prio {
	BUS_ALARM,
	BUS_OUTPUT,
	BUS_INPUT,
	BUS_GUEST,
};

enum bus_kind {
	BUS_TEXT,   /* OWFS text in data, as owserver prints it (numbers may be blank padded) */
	BUS_NUMBER, /* the exact number; data has its text, or nothing where the request says so */
	BUS_BYTES,  /* raw bytes in data */
};

enum bus_news {
	BUS_UP,       /* requests can be served from now on */
	BUS_DOWN,     /* the target is lost: err and text say why; sent once per loss, and again
	                 when one that was gone is there and cannot be opened */
	BUS_FOUND,    /* the device rom appeared (buses that search) */
	BUS_LOST,     /* the device rom disappeared */
	BUS_POR,      /* the device rom was seen to have restarted */
	BUS_NOTE,     /* text for the log, nothing changes */
	BUS_TROUBLE,  /* it is up: what disturbs the target from now on, in text; "": nothing */
	BUS_RELEASED, /* the bus was asked to suspend and has released its hardware */
	BUS_BACK,     /* the suspended bus sees that its target is back, without touching the wire;
	                 sent once per change */
};

/*
 * A request. The bus owns it from bus_submit() until its answer; the caller does not touch it
 * meanwhile, and neither frees nor reuses it before the answer.
 */
struct bus_req {
	uint32_t id;  /* caller's, echoed in the answer */
	uint8_t op;   /* enum bus_op */
	uint8_t prio; /* enum bus_prio */
	bool fresh;   /* read past every cache */
	bool whole;   /* DIR of alarms: to be listed is an alarm by itself, so no id is guessed from
	                its first bits */
	/*
	 * READ: where the answer is a number, its text is not needed. WRITE: `value` is written,
	 * and data is room for BUS_NUMBER_TEXT bytes, where a bus may put its text.
	 */
	bool number;
	bool single; /* `value` is a float: the shortest text that reads back so is meant */
	double value;
	int64_t deadline_ns; /* not begun by then: answered -ETIME without effect.
	                        Begun: finished or failed by then, never undone. A READ may be
	                        as much later as the host kept the bus from its work */
	const char *path;    /* "/28.551DDF030000/temperature12", without /uncached; immutable */
	uint32_t len;        /* WRITE: bytes in data, of a number 0; READ and DIR: room in data */
	uint32_t offset; /* WRITE: of data in the value. Bytes beyond the value's end are ignored.
	                    A value that is no bytes cannot be written in parts: -EINVAL */
	uint8_t *data;
	/*
	 * Not 0 as soon as the answer is not wanted any more; any thread may set it while the bus
	 * has the request. What is not begun of it is left out then, at once or at the end of the
	 * part that is under way, and the answer is -ECANCELED. A WRITE goes on to its end, and a
	 * bus may do so with all. NULL: the answer is wanted.
	 */
	const uint32_t *unwanted;
	/*
	 * For a target that is a server of the same protocol: the servers that the request came
	 * through, this process last, BUS_TOKEN bytes for each. A server that finds its own token
	 * has been asked in a circle. NULL: the target cannot lead back to this process.
	 */
	const uint8_t *tokens;
	uint32_t token_count; /* up to BUS_TOKENS_MAX */
};

/* May it end without having been done? */
static inline bool bus_req_unwanted(const struct bus_req *req)
{
	return req->op != BUS_WRITE && req->unwanted &&
	       __atomic_load_n(req->unwanted, __ATOMIC_RELAXED);
}

#define BUS_NUMBER_TEXT 32
#define BUS_TOKEN 16
#define BUS_TOKENS_MAX 8

/* How a device gets its power. */
enum bus_supply {
	BUS_SUPPLY_UNKNOWN,
	BUS_SUPPLY_PARASITE, /* from the data line */
	BUS_SUPPLY_EXTERNAL,
};

/* What err of an answer may be, beside 0. */
/* clang-format off */
#define BUS_ERRORS(ERROR) \
	ERROR(ENODEV)       /* no such device on this target */ \
	ERROR(ENXIO)        /* the device was not found, and a part of the target does not \
	                       answer: one of several bridge chips, which may be the one that \
	                       has it */ \
	ERROR(ENOENT)       /* the device has no such property */ \
	ERROR(EACCES)       /* the property cannot be read, or cannot be written, by any \
	                       process */ \
	ERROR(EPERM)        /* no permission: for the file of the kernel, or from a server \
	                       that refuses writes */ \
	ERROR(EISDIR)       /* READ or WRITE of a directory */ \
	ERROR(ENOTDIR)      /* DIR of a property */ \
	ERROR(EINVAL)       /* the target refused the value that was written */ \
	ERROR(EBADMSG)      /* a checksum was wrong */ \
	ERROR(ENOMSG)       /* the device is there, and its answer was nothing but ones, or \
	                       zeros */ \
	ERROR(EBADE)        /* nothing shows that the answer is right, and no checksum was \
	                       wrong */ \
	ERROR(ECOMM)        /* the wire is short */ \
	ERROR(ERANGE)       /* a reading that means power fault (85, 127.94) */ \
	ERROR(ENODATA)      /* the device answers whole that it has no value: an open sensor, \
	                       no supply, a result that a restart has taken */ \
	ERROR(EDOM)         /* a reading that the chip cannot have measured; number has it */ \
	ERROR(EBUSY)        /* another process has it (a GPIO line) */ \
	ERROR(EMEDIUMTYPE)  /* the id names no known version of the chip: what its codes mean \
	                       is not known */ \
	ERROR(EIO)          /* any other device error */ \
	ERROR(EMSGSIZE)     /* the answer is longer than the room */ \
	ERROR(EOPNOTSUPP)   /* this bus has no such operation (DIR of /alarm on some) */ \
	ERROR(ETIME)        /* not begun before its deadline, no effect */ \
	ERROR(EINPROGRESS)  /* the target lives but had no answer by the deadline; a write is \
	                       in doubt */ \
	ERROR(ECANCELED)    /* the host shuts down, or the answer is not wanted \
	                       (bus_req.unwanted) */ \
	ERROR(ENOTCONN)     /* the target is down; nothing was sent */ \
	ERROR(ETIMEDOUT)    /* the target fell silent; a BUS_DOWN follows; a write is in \
	                       doubt */ \
	ERROR(ECONNRESET)   /* the target was lost on the way; a BUS_DOWN follows; a write is \
	                       in doubt */ \
	ERROR(EPROTO)       /* the target answered garbage; a BUS_DOWN follows; a write is in \
	                       doubt */
/* clang-format on */

/*
 * Exactly one for each request that was accepted. In a BUS_DOWN alone, err may be -ECONNREFUSED:
 * nobody listens at the target's address.
 */
struct bus_answer {
	uint32_t id;
	int32_t err;         /* 0: done; else a negative one of BUS_ERRORS */
	uint8_t kind;        /* enum bus_kind */
	uint8_t detail;      /* BUS_DETAIL_* */
	uint8_t retries;     /* how often the bus did it again after an error; at most 255 */
	uint8_t supply;      /* enum bus_supply, of the path's device */
	uint32_t len;        /* READ and DIR: bytes in req->data; WRITE: bytes taken, of the text */
	int64_t measured_ns; /* when the chip latched the value, else when the answer came */
	double number;       /* if kind is BUS_NUMBER; of -EDOM */
	/*
	 * What a bus knows besides: nothing is asked of a device for it. Which chip the path's
	 * device is by its behaviour ("DS18B20 clone, family B1"), a text that lives as long as the
	 * program; NULL: not known. And the time that the request took of the wire, in microseconds
	 * of its slots, without what served several requests; 0: not known.
	 */
	const char *identity;
	uint32_t wire_us;
	uint8_t wire; /* N + 1 of the bus.N on which that device is; 0: not known */
};

#define BUS_DETAIL_SIMULATED 0x01 /* the device is not real */
#define BUS_DETAIL_CACHED 0x02    /* from a cache: measured_ns is older than the answer */

#define BUS_EVENT_TEXT 200
struct bus_event {
	uint8_t news; /* enum bus_news */
	uint8_t rom[8];
	int32_t err;
	int64_t cache_ns; /* BUS_UP of a server: greatest age of a cached answer; 0: not known */
	char text[BUS_EVENT_TEXT];
};

struct tap;
/* What the host gives a backend: all that a backend may use to wait or to report. */
struct bus_env {
	void *ctx;
	/* Any thread. */
	int64_t (*now)(void *ctx);
	/*
	 * Wait for events (poll(2) bits) on fd, at most until until_ns, or for a moment more where
	 * the machine slept meanwhile; fd -1 waits for time alone.
	 * Returns 1 ready, 0 time is over, -ECANCELED the host shuts down. Every wait of a backend
	 * goes through here: that gives deadlines, prompt shutdown and virtual time.
	 */
	int (*wait)(void *ctx, int fd, short events, int64_t until_ns);
	/* Answers and events reach the host in the order in which they were given. */
	void (*answer)(void *ctx, const struct bus_answer *answer);
	void (*event)(void *ctx, const struct bus_event *event);
	struct tap *tap; /* hal/bus/tap.h; NULL: there is none */
};

static inline int64_t bus_now(const struct bus_env *env)
{
	return env->now(env->ctx);
}
void bus_report(const struct bus_env *env, enum bus_news news, int err, const char *text);

/* What was reported of a loss. All zero while the target is up, and when a bus is suspended. */
struct bus_loss {
	bool told, gone;
};

/*
 * Is this a BUS_DOWN to report? gone: it is not there. Of a target that is there again, and cannot
 * be opened, the reason is another.
 */
static inline bool bus_loss_news(struct bus_loss *loss, bool gone)
{
	if (loss->told && loss->gone == gone)
		return false;
	*loss = (struct bus_loss){.told = true, .gone = gone};
	return true;
}

/* A running total that `owsctl stats` shows; name is a literal such as "keepalives". */
struct bus_counter {
	const char *name;
	uint64_t value;
};

/* The bus's thread adds, any thread reads. */
static inline void bus_count(struct bus_counter *counter, uint64_t by)
{
	uint64_t value = __atomic_load_n(&counter->value, __ATOMIC_RELAXED);

	__atomic_store_n(&counter->value, value + by, __ATOMIC_RELAXED);
}

static inline uint64_t bus_counted(const struct bus_counter *counter)
{
	return __atomic_load_n(&counter->value, __ATOMIC_RELAXED);
}

struct bus;

/*
 * What a target names that this machine has or lacks: a GPIO chip, or a path: root and the name,
 * which follows `after` in the target without its scheme, begins so, and ends at a colon.
 */
struct bus_look {
	const char *after; /* NULL: "" */
	const char *begin; /* NULL: the end of the list */
	const char *root;
	bool gpio_chip;
	uint32_t type;      /* S_IFCHR, S_IFSOCK; 0: any */
	unsigned major;     /* of a device; 0: any */
	const char *wrong;  /* of another type: what it is not */
	const char *remedy; /* it is not there */
};

struct bus_ops {
	const char *scheme;  /* "owserver": what stands before the colon of a target */
	const char *summary; /* one line for --version and the manual */
	unsigned depth;      /* requests it takes before an answer; at least 1 */
	bool testing;        /* answers without devices: a user is not offered it */
	bool searches;       /* sends BUS_FOUND and BUS_LOST by itself */
	bool brief; /* a device that keeps failing costs the others no more than a good one */
	/*
	 * Facts of the scheme. A target that goes on so after its scheme has a cache of owsd's own,
	 * where a value has the age of the chip's; NULL: none has. board_advice: it needs what
	 * `owsd --board` looks for.
	 */
	const char *caches;
	bool board_advice;
	const struct bus_look *looks; /* NULL: nothing can be looked for */

	/*
	 * Allocate everything the bus will need; never touch hardware or network, never block.
	 * where is the target without scheme and colon. Returns 0 and the bus, or -EINVAL with the
	 * reason in why (size why_size), or -ENOMEM.
	 */
	int (*create)(const char *where, const struct bus_env *env, struct bus **bus, char *why,
	              size_t why_size);
	/* Release and free everything; requests that the bus still owns get no answer. */
	void (*destroy)(struct bus *bus);
	/*
	 * Set an option of the target's Bus block, before the first step; touches no hardware. 0;
	 * -ENOENT: this bus has no such option; -EINVAL with the reason in why; -ENOMEM. NULL: the
	 * backend has no options.
	 */
	int (*option)(struct bus *bus, const char *key, const char *text, char *why,
	              size_t why_size);

	/*
	 * Simple tier: do one request, blocking, ended by req->deadline_ns; fills answer but its
	 * id.
	 */
	void (*exec)(struct bus *bus, struct bus_req *req, struct bus_answer *answer);

	/* Overlapping tier. 0, or -EAGAIN when depth is reached; never blocks. */
	int (*submit)(struct bus *bus, struct bus_req *req);
	/*
	 * Do one bounded piece of work, connecting and searching included; step calls env->answer
	 * and env->event. Returns the time of its next call (INT64_MAX: at the next submit). A
	 * simple bus may have a step too, which then reports BUS_UP and BUS_DOWN: it is called
	 * before each exec and when there is no request. A simple bus without a step is up from the
	 * start.
	 */
	int64_t (*step)(struct bus *bus, int64_t now);
	/*
	 * true: release the hardware before returning; false: take it again, and the steps that
	 * follow report BUS_UP or BUS_DOWN. Meanwhile exec is not called, and submit and step of an
	 * overlapping bus answer -ENOTCONN. NULL, for a simple bus: the bus has no hardware to
	 * release.
	 */
	void (*suspend)(struct bus *bus, bool yes);
	/*
	 * Of a suspended bus: is the target present, as far as can be seen without touching the
	 * wire? 1, 0, or -EAGAIN: call again for the answer. As bounded as a step. A target that
	 * failed while it was visible counts as present again only after what is visible has
	 * changed. NULL: always.
	 */
	int (*visible)(struct bus *bus);
	/*
	 * While the bus waits for its next step: a descriptor that can be read, or has hung up,
	 * when there is something to do sooner; -1: none. The host sets `stirred` then, which the
	 * step takes back. NULL: none.
	 */
	int (*watch)(struct bus *bus);
	/* The running totals, to be read with bus_counted(); *n gets their count. NULL: none. */
	const struct bus_counter *(*counters)(struct bus *bus, size_t *n);
};

/* The part of a bus that all backends share: first member of the backend's own struct. */
#define BUS_MAX_DEPTH 512
struct bus {
	const struct bus_ops *ops;
	const struct bus_env *env;
	struct bus_req **queue; /* simple tier: requests not yet begun */
	unsigned head, count;
	bool told_up; /* simple tier without step: BUS_UP was reported at its first step */
	bool suspended;
	bool stirred;    /* what watch() returned can be read: for the next step */
	bool visible;    /* suspended: BUS_BACK was reported */
	int64_t look_ns; /* suspended: when to look for the target again */
};

/* The backends of this program, NULL at the end. */
extern const struct bus_ops *const bus_backends[];
#define BACKEND(name, automatic) extern const struct bus_ops name##_bus;
#include "hal/bus/schemes.h"
#undef BACKEND

/* As bus_ops.option, with a reason for each error. */
int bus_option(struct bus *bus, const char *key, const char *text, char *why, size_t why_size);
/* For create() of a backend: fill the shared part. Returns 0 or -ENOMEM. */
int bus_init(struct bus *bus, const struct bus_ops *ops, const struct bus_env *env);
void bus_destroy(struct bus *bus);
unsigned bus_depth(const struct bus *bus);

/*
 * submit and step for either tier. Of the waiting requests, a simple bus begins the one with the
 * lowest prio first, and the oldest of these.
 */
int bus_submit(struct bus *bus, struct bus_req *req);
int64_t bus_step(struct bus *bus, int64_t now);
/*
 * For a bus that takes texts: how many bytes in data a WRITE writes. A number's text is put there,
 * BUS_NUMBER_TEXT bytes at the most: the shortest that reads back equal.
 */
uint32_t bus_write_text(struct bus_req *req);
/* For one that takes 0 and 1: what a WRITE says; of texts also on, off, yes and no. 0 or -EINVAL */
int bus_write_switch(const struct bus_req *req, bool *on);
/*
 * true: release the hardware, and report BUS_RELEASED before returning. From then on requests are
 * answered -ENOTCONN and nothing touches the wire; bus_step() looks for the target every few
 * seconds and reports BUS_BACK once when it is back. false: take the hardware again; BUS_UP or
 * BUS_DOWN follows.
 */
void bus_suspend(struct bus *bus, bool yes);
/* As bus_ops.watch; -1 for a suspended bus, too. */
int bus_watch(struct bus *bus);
const struct bus_counter *bus_counters(struct bus *bus, size_t *n);
