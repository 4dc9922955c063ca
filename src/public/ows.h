/* SPDX-License-Identifier: MIT */
/*
 * libows: read and set the signals of owsd from a control program.
 *
 * owsd publishes its signals in an image, which programs map read-only. A program that commands
 * connects to owsd's control socket, and gets a memory of its own for that.
 *
 * A handle belongs to one thread at a time. C11, C++11 and later. Real-time threads may call
 * ows_get(), ows_get_text(), ows_get_signal(), ows_get_signal_text(), ows_command(),
 * ows_alarm_state(), ows_origin(), ows_now(): no system call, no lock, no wait, no
 * allocation, bounded, even when owsd dies in the middle of a write; and ows_set() with its
 * relatives, ows_acknowledge(), ows_beat(): the same, but for one write() to an eventfd when owsd
 * sleeps. They never open anything again. (ows_now() and what commands read the clock by the
 * kernel's vDSO.) All other functions make system calls or allocate.
 *
 * After fork() only the parent may command: calls of the child that command return -EPERM. The
 * child may read, and ows_close() frees what it has of the handle without a word to owsd.
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
	OWS_Q_TARGET = 0x18,      /* target down or timed out */
	OWS_Q_SHORT = 0x19,       /* the wire is short */
	OWS_Q_NO_OWSD = 0x1a,     /* owsd has ended, was killed or hangs; the reader sets it */
	OWS_Q_DIFFERS = 0x1c,     /* an output reads otherwise than it was written */
	OWS_Q_INITIAL = 0x20,     /* never read or written */
	OWS_Q_LAST_USABLE = 0x44, /* a new target has not answered, or an output's was down */
	OWS_Q_DISABLED = 0x44,    /* disabled by _ReadEnable: likewise the last usable value */
	OWS_Q_RANGE = 0x54,       /* out of range: beyond Min or Max */
	OWS_Q_LOW = 0x55,         /* held at the lower end of the type or of Points */
	OWS_Q_HIGH = 0x56,        /* held at the upper end */
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
	uint32_t applied;    /* stamp (see ows_set) of this handle's last confirmed command */
	uint32_t len;        /* strings: bytes */
	uint8_t type;        /* enum ows_type */
	uint8_t quality;     /* enum ows_quality, lowered by age and by a dead owsd */
	uint8_t detail;      /* OWS_DETAIL_ bits */
	uint8_t target;      /* index of the target that served it */
};

enum ows_mode {
	OWS_READ,    /* map the image only */
	OWS_CONTROL, /* connect to owsd too: may set outputs */
};

/*
 * Open the instance (NULL: "OWS"). System calls, allocates. Free with ows_close().
 * It is looked for in the directory that OWS_DIR of the environment names; without that in
 * $XDG_RUNTIME_DIR/owsd (else /dev/shm/owsd-UID; neither for root) and in /run/owsd, the
 * service's: the first with a living owsd of that name, else the first with its image. As soon as
 * the handle has met a living owsd, it stays with that directory; until then it looks in all again.
 * OWS_CONTROL needs an owsd that runs, and waits for its answer, 2 s at most.
 * -ENOENT: no owsd of that name has run, or, for OWS_CONTROL, runs; -EACCES: no permission (group
 * owsd may read; ControlAllow of the configuration, else group owsd-control, may set); -EPROTO: not
 * of owsd, or of another layout; -EPERM: the image or the directory belongs to a user that is
 * neither root, nor owsd, nor the caller, or others may write into the directory; -EINVAL: no
 * instance can have that name, or OWS_DIR is no absolute path or longer than 191 bytes; -ENOSPC:
 * too many programs command, or too many of this user; -ETIMEDOUT: owsd does not answer; -EMFILE,
 * -ENFILE: no descriptor is left; -ENOMEM.
 */
int ows_open(const char *instance, enum ows_mode mode, struct ows **h);
/*
 * The same, under another name than the program's own: owsd shows it beside the commands.
 * It is a claim, cut at 31 bytes; user and process are the kernel's word.
 */
int ows_open_as(const char *instance, enum ows_mode mode, const char *name, struct ows **h);
/*
 * Close the handle, and say goodbye to owsd: its commands stay in force, also if it had promised a
 * beat. A program that ends without this is lost to owsd, as one whose beat does not come.
 * NULL: does nothing.
 */
void ows_close(struct ows *h);

/* The present time, by the clock of all times here. */
int64_t ows_now(void);

/*
 * Look a name up: a signal ("room1", "OWS__room1"), a driver signal ("_TRANSACTIONS") or an
 * attribute ("room1_Age"). Returns an id >= 0, which stays right for the life of the handle, also
 * over ows_reopen(), or -ENOENT. Allocates at the first use of a name: -ENOMEM.
 */
int ows_find(struct ows *h, const char *name);

/*
 * Get a value. No system call, no lock, bounded. now_ns: ows_now(), once per
 * cycle is enough; a now_ns older than two seconds is too old, and values newer than it are bad.
 * -ESTALE: owsd was restarted or reloaded, call ows_reopen(); *value is filled all the same, and
 * its quality is good only while the last heartbeat in the old image is younger than two seconds,
 * or three periods. -EAGAIN: no whole sample in 64 attempts (not while owsd is sound).
 * -ENOENT: the id's name is not in the image any more. -EACCES: write-only name.
 */
int ows_get(struct ows *h, int id, int64_t now_ns, struct ows_value *value);
/*
 * The same with the text of the value, NUL-terminated, at most size bytes with the NUL.
 * Numbers are printed as owsctl prints them. -ENOSPC: the text was cut.
 */
int ows_get_text(struct ows *h, int id, int64_t now_ns, struct ows_value *value, char *text,
                 size_t size);

/*
 * Command an output (or a writable attribute). The value goes out at the signal's next
 * write, if it changed. At most one system call (none while the engine is awake).
 * Returns 0; -ERANGE: the type cannot hold the value, or it is beyond Min or Max of the
 * configuration; -EINVAL: NaN or infinity, or no text of such
 * a number; -EACCES: not writable, not by this user, or the handle is OWS_READ; -EROFS: an input
 * whose Writable is off in the configuration (also for its _WriteEnable); -EPERM: the handle is of
 * the process that this one was forked from; -ENOENT: the id's name is not in the image any more;
 * -ESTALE: owsd has ended, was reloaded, or its heart stands still: set it again after
 * ows_reopen().
 * stamp, if not NULL, gets the number that `applied` will reach (0 for attributes); each set of a
 * handle has a greater one. The flags _DGNRESET, _ReadOneShot and _WriteOneShot act when this
 * handle sets them from 0 to another value. A set that returned 0 just before an end of owsd may be
 * lost: `applied` says what was written, and ows_command() whether owsd took or refused it.
 */
int ows_set(struct ows *h, int id, double value, uint32_t *stamp);
int ows_set_integer(struct ows *h, int id, int64_t value, uint32_t *stamp);
int ows_set_text(struct ows *h, int id, const char *text, uint32_t *stamp);
/*
 * All n values with one ring; none if one is refused. Errors as ows_set().
 */
int ows_set_many(struct ows *h, const int *ids, const double *values, int n);

/* The command that owsd has for an output; ows_get() has the value last written or read back. */
struct ows_command {
	double number;   /* as in ows_value */
	int64_t integer; /* likewise */
	uint8_t given;   /* 1: there is a command; 0: none, or a string */
	uint8_t pending; /* 1: not yet confirmed on the bus */
	uint8_t safe;    /* 1: it is SafeValue: the program that set the output is lost */
	/* Of this handle's own commands for the signal, as stamps of ows_set(); 0: none. */
	uint32_t taken;   /* the last that owsd looked at */
	uint32_t applied; /* the last that the bus confirmed */
	int32_t refused;  /* 0, or why owsd refused the last that it looked at */
	uint64_t spare[4]; /* 0: room for later members */
};
/*
 * Of the signal of an id of ows_find(). Errors as ows_get(); *command is filled with -ESTALE too.
 */
int ows_command(struct ows *h, int id, struct ows_command *command);

/* The longest promise of ows_beat(), in milliseconds: an hour. SafeDelay can leave more time. */
#define OWS_BEAT_MOST_MS 3600000

/*
 * Report that this program lives, and promise the next call within period_ms. When the time is over
 * without it, the outputs that this program set last go to their SafeValue. No system call, but one
 * when period_ms is another than before. The commands in force of a program that beats outlive a
 * restart of owsd, if the program is back, by ows_reopen(), within two seconds of the start, or
 * within period_ms if that is longer. Errors as ows_set(); -EINVAL: period_ms is 0;
 * -ERANGE: it is more than OWS_BEAT_MOST_MS.
 */
int ows_beat(struct ows *h, uint32_t period_ms);

/*
 * From now on this handle commands for that person (NULL or "": for itself): a page that passes on
 * a person's click says whose. owsd shows it with the command; it is a claim. -ERANGE: longer than
 * 31 bytes; -EBUSY: owsd has still to look at the commands of 16 other persons; -EACCES, -EPERM as
 * ows_set().
 */
int ows_for(struct ows *h, const char *person);

/* Who did something: uid and pid are the kernel's word, both names the claims of the program. */
struct ows_by {
	uint32_t serial; /* each connection has another; 0: owsd itself, or no program */
	uint32_t uid;
	int32_t pid;     /* 0: not known */
	char name[32];   /* of the program; NUL-terminated, like person */
	char person[32]; /* for whom the program did it; "": for itself */
};

/* Why a command came into force. */
enum ows_reason {
	OWS_REASON_NONE = 0,
	OWS_REASON_SET,      /* a program commanded it */
	OWS_REASON_RETURNED, /* from before owsd's start; its program came back */
	OWS_REASON_INIT,     /* owsd wrote InitValue */
	OWS_REASON_SAFE,     /* owsd wrote SafeValue: the program in `who` is lost */
	OWS_REASON_LAST,     /* owsd wrote what was stored */
};
/* The words for a reason ("set", "SafeValue"); never NULL. */
const char *ows_reason_text(uint8_t reason);

/* Who has given the command that is in force, when, and why. */
struct ows_origin {
	struct ows_by who;
	int64_t taken_ns; /* when owsd took the command */
	uint8_t reason;   /* enum ows_reason */
	uint8_t own;      /* 1: this handle gave it */
	uint64_t spare[4]; /* 0: room for later members */
};
/*
 * Returns 0; -ENOENT: no such id; -EIO: owsd died while it wrote this; -ESTALE as ows_get(), and
 * *origin is filled all the same.
 */
int ows_origin(struct ows *h, int id, struct ows_origin *origin);

/* A program that is connected to owsd. */
struct ows_controller {
	struct ows_by who;   /* serial 0: no controller has this place */
	int64_t joined_ns;
	uint32_t period_ms;  /* promised longest time between two beats; 0: promised none */
	uint32_t commands;   /* taken */
	uint32_t refused;
	uint8_t may_set;     /* 1: it may command some signal */
	uint8_t late;        /* 1: its beat is over time */
	uint64_t spare[4]; /* 0: room for later members */
};
/* Who has that place, counted from 0. -ENOENT: past the last place; -EIO as ows_origin(). */
int ows_controller(struct ows *h, int index, struct ows_controller *controller);

/* Where a program stands in the changes of its handle. All zero to begin; libows writes it. */
struct ows_cursor {
	uint32_t number, start_id, generation, flags;
	int64_t looked_ns;
};
/*
 * Get the signals that changed since the cursor: at most n of them, each once, as indexes of
 * ows_info(); and move the cursor past them. Costs what changed, not what there is. Sleeps until
 * there is a change, at most timeout_ns (0: not at all; negative: no limit). Returns how many; 0:
 * the time is over.
 *
 * A change is an update (a value read or written; one that differs from the last change by less
 * than Deadband is none), another quality, error, target, command or alarm state, and that a good
 * value becomes older than StaleAfter. The row is at least as new as the change.
 *
 * -EOVERFLOW: look at all signals. The cursor is new; or so much changed that the ring of changes
 * has not all of it any more; or owsd is lost (killed, ended, hung: all values turned bad) or back.
 * The cursor is at the present now. A loss is reported within two seconds, or three periods if
 * that is longer.
 * -ESTALE: owsd has reloaded, or another owsd has started: ows_reopen(); the next call returns
 * -EOVERFLOW. -EINVAL: n below 1. -ENOMEM (at the first use and after a reload). -EINTR.
 * -EOPNOTSUPP: an older owsd.
 */
int ows_changes(struct ows *h, struct ows_cursor *cursor, int *signals, int n,
                int64_t timeout_ns);

/*
 * Sleep until owsd publishes something newer than *news, at most timeout_ns (negative: no limit).
 * Start with *news = 0. Returns 1: news, 0: the time is over, -ESTALE as ows_get(), the second time
 * after a tenth of a second, -EINTR. Wakes once a second, to look for another image.
 */
int ows_wait(struct ows *h, uint32_t *news, int64_t timeout_ns);
/*
 * A descriptor for poll(): readable when owsd publishes something after this call, when owsd has
 * ended, and twice a second, to look whether owsd lives or is back: so poll() needs no timeout.
 * Call it again before each poll(), and before the look at what has changed: that makes it silent.
 * It stays the same until ows_close(), also while owsd is away. Do not read or close it. An
 * OWS_READ handle connects to owsd at the first call; errors then as ows_open(OWS_CONTROL). -EPERM
 * as ows_set(); -EMFILE, -ENFILE, -ENOMEM.
 */
int ows_fd(struct ows *h);

/*
 * Map the present image after -ESTALE, and get the memory for commands that belongs to it; after a
 * restart it connects again, as the same controller, and beats if it had promised to. Ids stay
 * right. System calls, allocates; waits for owsd's answer, 20 ms at most (a second while too
 * many connect).
 * -ENOENT: they do not exist yet, try again in the next cycle (the old image stays readable);
 * -EPERM as ows_set(); all errors of ows_open(). An owsd that was killed cannot report its end: its
 * values turn bad by themselves, and when the next owsd has started, all calls return -ESTALE.
 */
int ows_reopen(struct ows *h);

/*
 * Ask the owsd of that instance (NULL: "OWS") to load its configuration again, and wait until it
 * serves it, at most timeout_ns (negative: no limit): owsd leaves up to ten seconds between two
 * reloads. Needs no handle. Root, owsd's own user and, of the service, the group owsd-config may.
 * Returns 0: done, and what owsd warns of in why, "2 warnings; the first: ...", empty: of nothing.
 * A negative errno, and a reason in why (NULL: not wanted; else NUL-terminated, cut at size bytes,
 * without control characters): owsd refuses the configuration, and all goes on as before. An empty
 * reason: there was no reload, or not in time. -ENOENT: no owsd of that name
 * runs; -EACCES: this user may not ask; -ENOSPC: too many programs ask; -ETIMEDOUT; -ENOTCONN: owsd
 * has ended meanwhile; -EPROTO: it is too old to be asked; others as ows_open().
 */
int ows_reload(const char *instance, int64_t timeout_ns, char *why, size_t size);

/*
 * Signals are 0 .. ows_count() - 1 in the order of the file, until ows_reopen().
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
	/* What people say of the signal. Texts are "" where nothing is said, never NULL. */
	const char *unit, *description;
	const char *family;     /* the kind of device: "DS18B20" */
	const char *device;     /* its ROM id, as in the path */
	const char *calibrated; /* the date */
	const char *points;     /* of the characteristic, as configured */
	double scale, offset;   /* 1 and 0 without */
	double min, max;        /* NaN: not set, like the limits of its alarm */
	double limit_hh, limit_h, limit_l, limit_ll;
	double filter_s, deadband; /* 0 without */
	int32_t decimals;       /* -1: not known */
	uint8_t confirm;        /* 1 ask a person once more before a set */
	/* What the signal was when it began: the same over a rename and over a replaced device. */
	const char *identity;
	const char *group; /* where people look for the signal: "Heating"; "": nowhere */
	uint64_t spare[2]; /* 0: room for later members */
};
int ows_info(const struct ows *h, int signal, struct ows_info *info);
/* Get the value of a signal by its index (not an id of ows_find()); otherwise as ows_get(). */
int ows_get_signal(struct ows *h, int signal, int64_t now_ns, struct ows_value *value);
/* The same with the text of the value, as ows_get_text(). */
int ows_get_signal_text(struct ows *h, int signal, int64_t now_ns, struct ows_value *value,
                        char *text, size_t size);

/* owsd itself. */
struct ows_daemon {
	int32_t pid;
	uint32_t state;      /* 1 live, 2 retired, 3 stopped */
	uint32_t generation; /* changes at each start or reload */
	int64_t start_ns;
	int64_t beat_age_ns; /* since the last heartbeat */
	int64_t period_ns;
	int alive;           /* state live and heart beating */
	uint64_t spare[4]; /* 0: room for later members */
};
int ows_daemon(struct ows *h, int64_t now_ns, struct ows_daemon *daemon);

/*
 * The target that reaches the owserver protocol which owsd serves, as "127.0.0.1:4304" or
 * "owserver:/run/owsd/owserver.sock"; NULL: owsd serves it at NAME.sock alone, which takes no
 * writes. Valid until ows_reopen().
 */
const char *ows_served(const struct ows *h);

/* Targets and counters, for tools. Return -ENOENT past the end. */
struct ows_target {
	const char *name;
	uint32_t state; /* 0 down, 1 up, 2 suspended: owsd keeps this way to the wire closed */
	uint32_t reconnects;
	uint32_t group; /* ways to the same wire have the same group */
	uint32_t moves; /* signals that came from another target */
	uint64_t spare[4]; /* 0: room for later members */
};
int ows_target(struct ows *h, int index, struct ows_target *target);
struct ows_counter {
	const char *name;
	int target; /* -1: of owsd itself */
	uint64_t value;
};
int ows_counter(struct ows *h, int index, struct ows_counter *counter);

/*
 * The devices that signals name by their ROM ids, in the order of these: what owsd knows of each,
 * and what it has counted since its start of the requests for its signals. owsd asks nothing of a
 * device for it, so a target that does not know leaves out identity, power, retries and wire_us.
 * -ENOENT past the end, -EIO if owsd died while it wrote this.
 */
enum ows_power {
	OWS_POWER_UNKNOWN,
	OWS_POWER_PARASITE, /* from the data line */
	OWS_POWER_EXTERNAL,
};
struct ows_device {
	const char *id;     /* "28.551DDF030000", as in the configuration */
	const char *family; /* the kind that its family code names: "DS18B20"; "" none */
	char identity[48];  /* which chip it is by its behaviour; "" not known */
	int target;         /* which answered last, for ows_target(); -1: none */
	uint32_t power;     /* enum ows_power */
	uint64_t answers;   /* requests that its target answered, if only with an error */
	/* Requests that failed, without an answer too; not of a device known to be absent */
	uint64_t errors;
	uint64_t retries;   /* how often the target did it again after an error */
	uint64_t wire_us;   /* what the requests took of the wire; without what served several */
	int64_t ok_ns;      /* last good answer; 0: none */
	uint64_t wire;      /* N + 1 of the bus.N of the target where it is; 0: not known */
	uint64_t spare[3];  /* 0: room for later members */
};
int ows_device(struct ows *h, int index, struct ows_device *device);

/*
 * The last lines of owsd's log: they count from 1 at owsd's start, and the last 64 are kept, also
 * after its end. Lines that owsd does not log (owsd -v) are not here either. ows_log_last(): the
 * number of the newest, 0 if there is none. -ENOENT: the line is not kept; -EIO: owsd died while it
 * wrote this.
 */
struct ows_log_line {
	uint32_t number;
	uint32_t level;    /* 3 error, 4 warning, 5 notice, 6 info, 7 debug, 8 trace */
	int64_t time_ns;   /* CLOCK_BOOTTIME */
	char text[256];    /* printable UTF-8 */
	uint64_t spare[2]; /* 0: room for later members */
};
uint32_t ows_log_last(struct ows *h);
int ows_log_line(struct ows *h, uint32_t number, struct ows_log_line *line);

/*
 * The reload that owsd refused last: text says why, number counts those since one was taken over;
 * level 4: a restart takes the file. -ENOENT: none: it was loaded last. -EIO: owsd died meanwhile.
 */
int ows_refused_reload(struct ows *h, struct ows_log_line *line);

/*
 * What is to be said of a target, and since when: why it is down; while it is up what disturbs it,
 * as another program that has its adapter open. -ENOENT: nothing. -EIO: owsd died while it wrote.
 */
int ows_target_note(struct ows *h, int index, struct ows_log_line *line);

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
	OWS_ALARM_DIFFERS,    /* the output reads (after) otherwise than it was written (before) */
};
enum ows_alarm_event {
	OWS_ALARM_RAISED = 1,
	OWS_ALARM_RETURNED,
	OWS_ALARM_ACKNOWLEDGED,
	OWS_ALARM_SHELVED,
	OWS_ALARM_UNSHELVED,
	OWS_ALARM_FAILED, /* the device's alarm does not come: something of it is refused */
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
	char text[64];       /* the latch, why it was shelved, or what is refused; NUL-terminated */
	struct ows_by who;   /* the program that acknowledged or shelved it */
	uint64_t spare[4]; /* 0: room for later members */
};
/* States of a limit alarm, as in ISA-18.2. */
enum ows_limit_state {
	OWS_LIMIT_NORMAL = 0,
	OWS_LIMIT_UNACKNOWLEDGED = 1,
	OWS_LIMIT_ACKNOWLEDGED = 2,
	OWS_LIMIT_RETURNED = 3, /* to normal, not acknowledged */
};
const char *ows_limit_state_text(uint8_t state);

/* Why the device's alarm does not come: a request of owsd's that fails, or what the file says. */
enum ows_unarmed {
	OWS_UNARMED_SET = 1,  /* cannot be armed: SetAlarm is missing or refused */
	OWS_UNARMED_POR,      /* cannot be armed: PorAlarm cannot be set to 0 */
	OWS_UNARMED_LATCH,    /* cannot be read: LatchAlarm */
	OWS_UNARMED_RESET,    /* cannot be reset: ResetLatch */
	OWS_UNARMED_POR_READ, /* cannot be read: PorAlarm */
	OWS_UNARMED_NO_POR,   /* can do nothing: PorAlarm is not defined */
	OWS_UNARMED_NO_LATCH, /* can do nothing: LatchAlarm is not defined, or empty */
	OWS_UNARMED_STAYS,    /* not cleared: the latch stays set, whatever ResetLatch does */
};
/* How the alarms of a signal stand now. */
struct ows_alarm_state {
	uint32_t occurrences; /* of the device's alarm, since owsd started */
	uint8_t item;         /* 1: an alarm item */
	uint8_t stands;       /* 1: the device's alarm stands */
	uint8_t polled;       /* 1: the bus has no alarm search, owsd reads the item as an input */
	uint8_t limits;       /* 1: the signal has limit alarms */
	uint8_t limit_state;  /* enum ows_limit_state */
	uint8_t limit_kind;   /* enum ows_alarm_kind of the limit alarm; 0: none */
	uint8_t unarmed;      /* enum ows_unarmed, err of the sample says why; 0: nothing fails */
	/* The limit alarm is shelved: its state is normal, its kind that of what is active. */
	uint8_t shelved;
	int64_t since_ns, until_ns; /* this and the next two: of the shelving */
	struct ows_by who;
	char why[64];               /* NUL-terminated */
	uint64_t spare[4]; /* 0: room for later members */
};
/* Of the signal of an id of ows_find(). Errors as ows_get(); *state is filled with -ESTALE too. */
int ows_alarm_state(struct ows *h, int id, struct ows_alarm_state *state);
/*
 * Acknowledge the limit alarm of a signal; does nothing if the signal has no unacknowledged alarm.
 * Errors as ows_set().
 */
int ows_acknowledge(struct ows *h, int id);
/*
 * Shelve the limit alarm of a signal for so many seconds, at most OWS_SHELVE_MAX; why: up to 63
 * bytes, or NULL. 0: unshelve it, which does nothing if it is not shelved. Waits until owsd has
 * done that, at most 2 seconds. Errors as ows_set(); -EOPNOTSUPP: it has no limit alarms; -ERANGE:
 * too many seconds; -ENOSPC: 64 are shelved; -EAGAIN: too many requests, again in a second;
 * -ETIMEDOUT; -EBUSY: one that timed out still waits.
 */
#define OWS_SHELVE_MAX (7 * 86400)
int ows_shelve(struct ows *h, int id, uint32_t seconds, const char *why);

/* How many alarms were entered since owsd started. */
uint32_t ows_alarm_count(struct ows *h);
/*
 * Get the alarm of that number. -ENOENT: not entered yet, or no longer kept; -EAGAIN: owsd died
 * while writing it.
 */
int ows_alarm(struct ows *h, uint32_t number, struct ows_alarm *alarm);

/*
 * The journal of commands since owsd started, likewise. Of one program's to one signal it has at
 * most one in each second; `more` of the next entry counts the others.
 */
struct ows_commanded {
	int signal;        /* as in ows_info() */
	int64_t taken_ns;
	double number;     /* the value; of strings text */
	int64_t integer;   /* likewise, if type is not float or double */
	uint32_t more;     /* so many to this signal were not entered before it */
	uint8_t type;      /* enum ows_type, of the signal */
	uint8_t reason;    /* enum ows_reason */
	uint8_t quality;   /* of the signal at that moment */
	char text[64];     /* NUL-terminated; may be cut */
	struct ows_by who;
	uint64_t spare[4]; /* 0: room for later members */
};
uint32_t ows_command_count(struct ows *h);
int ows_command_entry(struct ows *h, uint32_t number, struct ows_commanded *commanded);

#ifdef __cplusplus
#pragma GCC diagnostic pop
}
#endif

#endif
