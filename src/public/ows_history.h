/* SPDX-License-Identifier: MIT */
/*
 * libows-history: read what owsd-recorder kept: values of signals, commands, alarms, and gaps.
 *
 * It reads the recorder's file, and needs neither owsd nor the recorder to run. The recorder may
 * write meanwhile, and waits for no reader: ows_history_refresh() sees what came. Types and
 * qualities are those of ows.h, whose ows_good() says which values may be used. C11, C++11 and
 * later.
 *
 *     struct ows_history *h;
 *     if (ows_history_open("OWS", NULL, &h) == 0) {
 *             struct ows_history_point day[24];
 *             int room = ows_history_find(h, "room1");
 *             if (ows_history_points(h, room, from_ns, until_ns, day, 24) == 24)
 *                     printf("%g to %g\n", day[0].min, day[0].max);
 *             ows_history_close(h);
 *     }
 *
 * A handle belongs to one thread at a time. All functions but the texts of words read files: they
 * block, allocate, and are not for real-time threads. All return 0 (or the count or index that is
 * stated) or a negative errno; errno may change. Besides what is stated each that reads may return
 * -ENOMEM, -EIO or another error of the disk, -EAGAIN (another program has the file locked for
 * longer than two seconds), -EBADMSG (the file is damaged, or none that a recorder made) and
 * -ETIMEDOUT (it takes more of the processor than any recorder's file of that size does: two
 * seconds, and one for each 10 MB).
 * Texts are valid until the next ows_history_refresh() or _close(), if nothing else is said.
 *
 * Times are nanoseconds since 1970 (UTC). The history has boot times (CLOCK_BOOTTIME), which are
 * shown by what is known now of the clock at that boot: so a machine without a clock of its own has
 * right times for what came before it knew the time, and a refresh may move times that were read.
 * Times are whole microseconds. Where clocks were wrong, times of one boot of the machine may be
 * before those of the boot before it.
 */
#ifndef OWS_HISTORY_H
#define OWS_HISTORY_H
/* The columns are laid out for the reader of the installed file. */
/* clang-format off */

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
/* ows_history_signal and the like are a struct and a function each */
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wshadow"
#endif

struct ows_history;

/*
 * Where the history of an instance (NULL: "OWS") is looked for: below $XDG_STATE_HOME/owsd/history
 * or ~/.local/state/owsd/history (neither for root), and if it has none of that name in
 * /var/lib/owsd-recorder, the service's. -EINVAL: no instance can have that name; -ENOSPC: longer
 * than size. Does not block.
 */
int ows_history_place(const char *instance, char *path, size_t size);
/*
 * Open the history of an instance, or, if directory is not NULL, that of a directory. Free it with
 * ows_history_close(). -ENOENT: there is none; -EACCES: no permission (group owsd may read that of
 * the service); -EINVAL: no instance can have that name; -EBADMSG: the file is damaged, or of
 * another program; -EPROTONOSUPPORT: it is of a newer owsd, or of an older one and owsd-recorder
 * has not run since; -ENOSYS: the program was built without SQLite.
 */
int ows_history_open(const char *instance, const char *directory, struct ows_history **h);
/* NULL: does nothing. */
void ows_history_close(struct ows_history *h);
/* See what was written since. Ends what is being read; indexes of signals may change. */
int ows_history_refresh(struct ows_history *h);

/*
 * How many signals the history has, of all times; they are 0 .. n - 1. The raw value of a signal is
 * one of its own (room1_Raw), where it is recorded.
 */
int ows_history_signals(struct ows_history *h);
struct ows_history_signal {
	const char *name, *unit; /* "" without */
	uint8_t type;      /* enum ows_type */
	uint8_t output;    /* 1 output, 0 input */
	int32_t decimals;  /* -1: not known */
	const char *identity; /* as of struct ows_info; "": recorded before there was one */
	uint64_t spare[3]; /* 0: room for later members */
};
/* As it was last. -EINVAL: no such index. */
int ows_history_signal(struct ows_history *h, int index, struct ows_history_signal *signal);
/* The index of a name; else of an identity, or of a name that a signal had before; -ENOENT. */
int ows_history_find(struct ows_history *h, const char *name);
/* The first and the last moment of which something is known. -ENODATA: there is none. */
int ows_history_span(struct ows_history *h, int64_t *from_ns, int64_t *until_ns);

/* Why something is not known. */
enum ows_history_reason {
	OWS_HISTORY_STOPPED = 1, /* the recorder ended in order */
	OWS_HISTORY_LOST,        /* the recorder, or the machine, ended without a word */
	OWS_HISTORY_OWSD_LOST,   /* owsd had ended or hung */
	OWS_HISTORY_OVERRUN,     /* more changed than the recorder could follow */
	OWS_HISTORY_DISK,        /* the disk took nothing, and memory was full */
	OWS_HISTORY_NOT_ASKED,   /* the signal is not recorded from here on */
};
/* The words for a reason ("recorder stopped"); 0: "none". Never NULL. */
const char *ows_history_reason_text(uint8_t reason);

/*
 * From time_ns on the signal had this value, or nothing is known of it; until the next item. A
 * value that is not good is the last one that owsd had: no measurement of that time. A value that
 * stays the same comes again each hour.
 */
struct ows_history_item {
	int64_t time_ns;
	int64_t boot_ns;   /* the same as boot time, of whatever boot that was */
	double number;     /* as in struct ows_value; NaN: not known, or a string */
	int64_t integer;   /* the value if type is not float, double or string */
	const char *text;  /* of a string, NUL-terminated, valid until the next call; else NULL */
	uint32_t len;      /* of a string: bytes */
	uint8_t known;     /* 0: nothing is known from here on, and reason says why */
	uint8_t type;      /* enum ows_type */
	uint8_t quality;   /* enum ows_quality; 0 if it is not known */
	uint8_t reason;    /* enum ows_history_reason; 0: the end of what is written yet */
	uint8_t trusted;   /* 1: the clock was right, or is corrected */
	uint64_t spare[4]; /* 0: room for later members */
};
/*
 * Begin to read a signal: with the value that held at from_ns, up to but without until_ns. Then
 * ows_history_next() gives up to n items (one at a time if they are strings): how many, 0: the end.
 * One signal at a time is read in a handle. -EINVAL: no such index; n below 1; ows_history_read()
 * was not called since the handle was opened or refreshed.
 */
int ows_history_read(struct ows_history *h, int signal, int64_t from_ns, int64_t until_ns);
int ows_history_next(struct ows_history *h, struct ows_history_item *items, int n);

/* A stretch of time of one signal. */
struct ows_history_point {
	int64_t from_ns, until_ns;
	double min, max, mean, last; /* of good values; NaN: there is none, or it is a string */
	int64_t good_ns;       /* for so long the value was good */
	int64_t known_ns;      /* for so long something was known */
	uint32_t count;        /* values that were recorded in it */
	uint8_t quality;       /* the last one; 0 where nothing is known */
	uint8_t worst;         /* the lowest one */
	uint8_t gap;           /* 1: of some of it nothing is known */
	uint8_t trusted;       /* 1: the clock was right, or is corrected */
	uint64_t spare[4];     /* 0: room for later members */
};
/*
 * Divide the time into n stretches of the same length, to draw a signal: a year in milliseconds.
 * Stretches of two hours or more come from sums of hours, those of a minute or more from sums of
 * minutes; so does what is so old that its values are deleted. A sum is of the stretch that its
 * middle is in. mean is weighted by time. Returns n.
 * -EINVAL: n below 1, a time before 1970 or after 2116, or an end that is not after the begin; no
 * such index. What ows_history_read() began has ended.
 */
int ows_history_points(struct ows_history *h, int signal, int64_t from_ns, int64_t until_ns,
                       struct ows_history_point *points, int n);

/* What happened. */
enum ows_history_kind {
	OWS_HISTORY_BEGIN = 3, /* the recorder began to look; reason says what was before */
	OWS_HISTORY_END,       /* it ended */
	OWS_HISTORY_GAP,       /* from time_ns to until_ns nothing is known */
	OWS_HISTORY_CLOCK,     /* the clock was set, or became trusted */
	OWS_HISTORY_COMMAND,
	OWS_HISTORY_ALARM,
};
/* Who did it, as in struct ows_by of ows.h. */
struct ows_history_who {
	uint32_t serial; /* 0: owsd itself, or no program */
	uint32_t uid;
	int32_t pid;
	char name[32];   /* NUL-terminated, like person */
	char person[32];
};
struct ows_history_event {
	int64_t time_ns;
	int64_t boot_ns;    /* the same as boot time */
	int64_t until_ns;   /* of a gap: its end */
	double number;      /* of a command; of an alarm: the value after */
	double before;      /* of an alarm: the value before */
	int64_t integer;    /* likewise, if type is not float, double or string */
	int64_t before_integer;
	int32_t signal;     /* index; -1: of none, or the signal's name is lost */
	uint8_t kind;       /* enum ows_history_kind */
	uint8_t reason;     /* command: enum ows_reason; begin, gap: enum ows_history_reason */
	uint8_t alarm;      /* enum ows_alarm_kind */
	uint8_t event;      /* enum ows_alarm_event */
	uint8_t type;       /* enum ows_type, of the signal */
	uint8_t quality;    /* of the signal at that moment */
	uint8_t has_before, has_after;
	uint8_t trusted;    /* 1: the clock was right, or is corrected */
	uint8_t this_boot;  /* 1: boot_ns is of the boot that this machine is in */
	char text[160];     /* what the latch showed, why, or a text that was commanded */
	struct ows_history_who who;
	uint64_t spare[4];  /* 0: room for later members */
};
/*
 * Begin to read the journal between two times, in the order of recording: which is nearly that of
 * time. kinds: a bit (1u << kind) for each wanted kind; 0: all. Then ows_history_next_event()
 * returns 1, 0 at the end. -EINVAL as ows_history_next(). A signal may be read at the same time.
 */
int ows_history_events(struct ows_history *h, int64_t from_ns, int64_t until_ns, uint32_t kinds);
int ows_history_next_event(struct ows_history *h, struct ows_history_event *event);

#ifdef __cplusplus
#pragma GCC diagnostic pop
}
#endif

#endif
