/* SPDX-License-Identifier: MIT */
/*
 * libows: read and set the signals of owsd from a control program.
 *
 * Reading a value takes no system call and no lock and never waits, even when owsd dies in the
 * middle of a write. Only while owsd's heart stands still, a call checks once a second whether the
 * names in /dev/shm lead to the segments of another owsd (lstat()); then the call returns -ESTALE.
 * A handle belongs to one thread at a time. C11, C++11 and later.
 *
 *     struct ows *h;
 *     if (ows_open("OWS", OWS_READ, &h) == 0) {
 *             int room = ows_find(h, "room1");
 *             struct ows_value v;
 *             if (ows_get(h, room, ows_now(), &v) == 0 && ows_good(v.quality))
 *                     printf("%g\n", v.number);
 *     }
 *
 * All functions return 0 (or the count or id that is stated) or a negative errno; none sets errno.
 * Times are nanoseconds of CLOCK_BOOTTIME, which counts suspend.
 */
#ifndef OWS_H
#define OWS_H
/* The columns are laid out for the reader of the installed file. */
/* clang-format off */

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
/* ows_info, ows_command, ows_daemon, ows_target and the like are a struct and a function each */
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wshadow"
#endif

/* The types of signals: REXYGEN's type codes, as in the low nibble of IOType. */
enum ows_type {
	OWS_BOOL = 1,
	OWS_BYTE = 2,   /* unsigned 8 bit */
	OWS_SHORT = 3,  /* signed 16 bit */
	OWS_LONG = 4,   /* signed 32 bit */
	OWS_WORD = 5,   /* unsigned 16 bit */
	OWS_DWORD = 6,  /* unsigned 32 bit */
	OWS_FLOAT = 7,
	OWS_DOUBLE = 8,
	OWS_LARGE = 10, /* signed 64 bit */
	OWS_STRING = 12,
};

/* The OPC quality byte QQSSSSLL. Good means that the two upper bits are set. */
enum ows_quality {
	OWS_Q_NO_PROPERTY = 0x04, /* the device has no such property */
	OWS_Q_TYPE = 0x05,        /* the signal's type does not fit the property */
	OWS_Q_ACCESS = 0x06,      /* the property cannot be read, or written, or not by owsd */
	OWS_Q_NO_DEVICE = 0x08,   /* the device is absent */
	OWS_Q_DEVICE = 0x0c,      /* device error: checksum, refused */
	OWS_Q_SENSOR = 0x10,      /* power-fault reading of a thermometer (85, 127.94) */
	OWS_Q_STALE = 0x14,       /* older than StaleAfter */
	OWS_Q_TARGET = 0x18,      /* target down or timed out; owsd dead */
	OWS_Q_SHORT = 0x19,       /* the wire is short */
	OWS_Q_INITIAL = 0x20,     /* never read or written */
	OWS_Q_LAST_USABLE = 0x44, /* moved to another target, which has not answered yet */
	OWS_Q_DISABLED = 0x44,    /* disabled by _ReadEnable: likewise the last usable value */
	OWS_Q_RANGE = 0x54,       /* out of range */
	OWS_Q_LOW = 0x55,         /* held at the type's lower limit */
	OWS_Q_HIGH = 0x56,        /* held at the type's upper limit */
	OWS_Q_CUT = 0x58,         /* text cut to the room in the layout */
	OWS_Q_GOOD = 0xc0,
};
static inline int ows_good(uint8_t quality)
{
	return (quality & 0xc0) == 0xc0;
}
/* A few words on a quality ("good", "device absent"); never NULL. */
const char *ows_quality_text(uint8_t quality);

/* Bits of ows_value.detail. */
#define OWS_DETAIL_SIMULATED 0x01 /* the value comes from a simulated target */
#define OWS_DETAIL_CACHED    0x02 /* the target answered from a cache */

struct ows;

struct ows_value {
	double number;       /* the value; an integer beyond 2^53 is rounded here, not in integer */
	int64_t integer;     /* the value if type is not float, double or string */
	int64_t measured_ns; /* time of measurement; 0: never */
	int64_t tried_ns;    /* time of the last attempt; 0: never */
	int64_t age_ns;      /* now - measured; before the first value: since owsd started */
	int32_t err;         /* 0 or negative errno: of the last read, else of the last write */
	uint32_t count;      /* updates since owsd started */
	uint32_t applied;    /* outputs: stamp (see ows_set) of the last confirmed command */
	uint32_t len;        /* strings: bytes */
	uint8_t type;        /* enum ows_type */
	uint8_t quality;     /* enum ows_quality, lowered by age and by a dead owsd */
	uint8_t detail;      /* OWS_DETAIL_ bits */
	uint8_t target;      /* index of the target that served it */
};

enum ows_mode {
	OWS_READ,    /* map the image only */
	OWS_CONTROL, /* the command segment too: may set outputs */
};

/*
 * Open the instance (NULL: "OWS"). System calls, allocates. Free with ows_close().
 * -ENOENT: no owsd of that name has run; -EACCES: no permission (group owsd may read, group
 * owsd-control may set); -EPROTO: not a segment of owsd, or of another layout; -EPERM: the segment
 * belongs to a user who is neither root, nor owsd, nor the caller; -EINVAL: no instance can have
 * that name.
 *
 * A user who may command may also truncate the command segment; touching it then raises SIGBUS. If
 * the process has no SIGBUS handler of its own when it opens a handle with OWS_CONTROL, libows
 * installs a handler until the last such handle is closed, for up to four handles: sets then return
 * -ESTALE. A SIGBUS from elsewhere acts as it did before.
 */
int ows_open(const char *instance, enum ows_mode mode, struct ows **h);
void ows_close(struct ows *h);

/* The present time, by the clock of all times here. */
int64_t ows_now(void);

/*
 * Look a name up: a signal ("room1", "OWS__room1"), a driver signal ("_TRANSACTIONS") or an
 * attribute ("room1_Age"). Returns an id >= 0, which stays right for the life of the handle, also
 * over ows_reopen(), or -ENOENT. Allocates at the first use of a name.
 */
int ows_find(struct ows *h, const char *name);

/*
 * Get a value. No system call (but the check above), no lock, bounded. now_ns: ows_now(), once per
 * cycle is enough; a now_ns older than two seconds is too old, and values newer than it are bad.
 * -ESTALE: owsd was restarted or reloaded, call ows_reopen(); *value is filled all the same, and
 * its quality is good only while the last heartbeat in the old image is younger than two seconds,
 * or three periods. -EAGAIN: no whole sample in 64 attempts (does not happen while owsd works as it
 * should). -ENOENT: the id's name is not in the image any more. -EACCES: write-only name.
 */
int ows_get(struct ows *h, int id, int64_t now_ns, struct ows_value *value);
/*
 * The same with the text of the value, NUL-terminated, at most size bytes with the NUL.
 * Numbers are printed as owsctl prints them. -ENOSPC: the text was cut.
 */
int ows_get_text(struct ows *h, int id, int64_t now_ns, struct ows_value *value, char *text,
                 size_t size);

/*
 * Command an output (or a writable attribute). The value goes out at the signal's next write
 * turn, if it changed. At most one system call (none while the engine is awake).
 * Returns 0; -ERANGE: the type cannot hold the value; -EINVAL: NaN or infinity; -EACCES: not
 * writable, or the handle is OWS_READ; -EROFS: an input whose Writable is off in the configuration
 * (also for its _WriteEnable); -EBUSY: another program is writing this string at the moment;
 * -ESTALE: set it again after ows_reopen(). stamp, if not NULL, gets the number that `applied`
 * will reach (0 for attributes). The flags _DGNRESET and _WriteOneShot act when this handle sets
 * them from 0 to another value. After an orderly end of owsd sets return -ESTALE until its next
 * start; a set that returned 0 just before an end may be lost: `applied` says what was written.
 */
int ows_set(struct ows *h, int id, double value, uint32_t *stamp);
int ows_set_integer(struct ows *h, int id, int64_t value, uint32_t *stamp);
int ows_set_text(struct ows *h, int id, const char *text, uint32_t *stamp);
/* n values with one ring. Stops at the first error; returns how many were set, or the error. */
int ows_set_many(struct ows *h, const int *ids, const double *values, int n);

/* The command that owsd has for an output; ows_get() has the value last written or read back. */
struct ows_command {
	double number;   /* as in ows_value */
	int64_t integer; /* likewise */
	uint8_t given;   /* 1: there is a command; 0: none, or a string */
	uint8_t pending; /* 1: not yet confirmed on the bus */
	uint8_t safe;    /* 1: it is SafeValue: the client that set the output stopped beating */
};
/*
 * Of the signal of an id of ows_find(). Errors as ows_get(); *command is filled with -ESTALE too.
 */
int ows_command(struct ows *h, int id, struct ows_command *command);

/*
 * Report that this control program lives, and promise the next call within period_ms. Without it,
 * the outputs that this program set last go to their SafeValue. No system call after the first
 * call. The commands of a program that beats outlive a restart of owsd: they are in force again
 * when the program beats, or calls ows_reopen(), within two seconds of the start, or within
 * period_ms if that is longer. -ENOSPC: the table of 32 clients is full. -ESTALE: as ows_set().
 */
int ows_beat(struct ows *h, uint32_t period_ms);

/*
 * Sleep until owsd publishes something newer than *news, at most timeout_ns (negative: no limit).
 * Start with *news = 0. Returns 1: news, 0: the time is over, -ESTALE as ows_get(), -EINTR. Wakes
 * once a second in between, for the check above.
 */
int ows_wait(struct ows *h, uint32_t *news, int64_t timeout_ns);

/*
 * Map the present segments after -ESTALE; ids stay right. System calls, allocates.
 * -ENOENT: they do not exist yet, try again in the next cycle (the old segments stay readable). An
 * owsd that was killed cannot report its end: its values turn bad by themselves, and when the next
 * owsd has started, every program that still maps the old image gets -ESTALE, even if that image
 * was removed.
 */
int ows_reopen(struct ows *h);

/*
 * How many signals there are: signals are 0 .. ows_count() - 1 in the order of the file; valid
 * until ows_reopen().
 */
int ows_count(const struct ows *h);

struct ows_info {
	const char *name;
	const char *path;   /* as configured, without /uncached */
	uint8_t type;       /* enum ows_type */
	uint8_t output;     /* 1 output, 0 input */
	uint8_t fresh;      /* 1 read past the cache */
	uint8_t alarm;      /* 1 alarm item */
	uint32_t per_factor;
	int64_t stale_after_ns; /* 0: no limit */
};
int ows_info(const struct ows *h, int signal, struct ows_info *info);
/* Get the value of a signal by its index (not an id of ows_find()); otherwise as ows_get(). */
int ows_get_signal(struct ows *h, int signal, int64_t now_ns, struct ows_value *value);
/*
 * Get the values of the first n signals; returns how many. Each value is whole in itself; the
 * values may be of different moments.
 */
int ows_snapshot(struct ows *h, int64_t now_ns, struct ows_value *values, int n);

/* owsd itself. */
struct ows_daemon {
	int32_t pid;
	uint32_t state;      /* 1 live, 2 retired, 3 stopped */
	uint32_t generation; /* changes at each start or reload */
	int64_t start_ns;
	int64_t beat_age_ns; /* since the last heartbeat */
	int64_t period_ns;
	int alive;           /* state live and heart beating */
};
int ows_daemon(struct ows *h, int64_t now_ns, struct ows_daemon *daemon);

/*
 * The target that reaches the owserver protocol which owsd serves, as "127.0.0.1:4304" or
 * "owserver:/run/owsd/OWS.sock"; NULL: owsd does not serve it. Valid until ows_reopen().
 */
const char *ows_served(const struct ows *h);

/* Targets and counters, for tools. Return -ENOENT past the end. */
struct ows_target {
	const char *name;
	uint32_t state; /* 0 down, 1 up, 2 suspended: owsd keeps this way to the wire closed */
	uint32_t reconnects;
	uint32_t group; /* ways to the same wire have the same group */
	uint32_t moves; /* signals that came from another target */
};
int ows_target(struct ows *h, int index, struct ows_target *target);
struct ows_counter {
	const char *name;
	int target; /* -1: of owsd itself */
	uint64_t value;
};
int ows_counter(struct ows *h, int index, struct ows_counter *counter);

/*
 * The journal of alarms since owsd started: entries count from 0; the last 256 are kept. The entry
 * of a device alarm has what the device's latch showed; that of a limit alarm names the limit of
 * the signal (owsd.rio(5)).
 */
enum ows_alarm_kind {
	OWS_ALARM_DEVICE = 1, /* the device's own alarm */
	OWS_ALARM_POR,        /* the device lost its power */
	OWS_ALARM_HH,         /* limits: above LimitHH */
	OWS_ALARM_H,
	OWS_ALARM_L,
	OWS_ALARM_LL,         /* below LimitLL */
	OWS_ALARM_STALE,
	OWS_ALARM_BAD,
};
enum ows_alarm_event {
	OWS_ALARM_RAISED = 1,
	OWS_ALARM_RETURNED,
	OWS_ALARM_ACKNOWLEDGED,
};
/* The words for a kind or an event ("high", "raised"); never NULL. */
const char *ows_alarm_kind_text(uint8_t kind);
const char *ows_alarm_event_text(uint8_t event);

struct ows_alarm {
	int signal;          /* as in ows_info() */
	int64_t occurred_ns;
	double before, after;             /* value before and after, if there is one */
	int64_t before_integer, after_integer; /* likewise, if type is not float or double */
	uint8_t type;        /* enum ows_type, of the signal */
	uint8_t has_before, has_after;
	uint8_t kind;        /* enum ows_alarm_kind */
	uint8_t event;       /* enum ows_alarm_event */
	uint8_t quality;     /* of the signal at that moment */
	char latch[24];      /* NUL-terminated; "" for other than device alarms */
};
/* States of a limit alarm, as in ISA-18.2. */
enum ows_limit_state {
	OWS_LIMIT_NORMAL = 0,
	OWS_LIMIT_UNACKNOWLEDGED = 1,
	OWS_LIMIT_ACKNOWLEDGED = 2,
	OWS_LIMIT_RETURNED = 3, /* to normal, not acknowledged */
};
const char *ows_limit_state_text(uint8_t state);

/* How the alarms of a signal stand now. */
struct ows_alarm_state {
	uint32_t occurrences; /* of the device's alarm, since owsd started */
	uint8_t item;         /* 1: an alarm item */
	uint8_t stands;       /* 1: the device's alarm stands */
	uint8_t polled;       /* 1: the bus has no alarm search, owsd reads the item as an input */
	uint8_t limits;       /* 1: the signal has limit alarms */
	uint8_t limit_state;  /* enum ows_limit_state */
	uint8_t limit_kind;   /* enum ows_alarm_kind of the limit alarm; 0: none */
	/* The device's alarm cannot be armed: 1 for its SetAlarm, 2 for PorAlarm; err says why. */
	uint8_t unarmed;
};
/* Of the signal of an id of ows_find(). Errors as ows_get(); *state is filled with -ESTALE too. */
int ows_alarm_state(struct ows *h, int id, struct ows_alarm_state *state);
/*
 * Acknowledge the limit alarm of a signal; does nothing if the signal has no unacknowledged alarm.
 * Errors as ows_set(); -EOPNOTSUPP: this owsd is of a version without limit alarms.
 */
int ows_acknowledge(struct ows *h, int id);

/* How many alarms were entered since owsd started. */
uint32_t ows_alarm_count(struct ows *h);
/*
 * Get the alarm of that number. -ENOENT: not entered yet, or no longer kept; -EAGAIN: owsd died
 * while writing it.
 */
int ows_alarm(struct ows *h, uint32_t number, struct ows_alarm *alarm);

#ifdef __cplusplus
#pragma GCC diagnostic pop
}
#endif

#endif
