/* SPDX-License-Identifier: MIT */
/*
 * The published layout of an instance, in the directory of owsd (docs/shared-memory.md):
 *
 *     NAME.image     one file: only owsd writes it, consumers map it read-only
 *     NAME.control   a socket: a program connects and becomes a controller. owsd hands each
 *     controller a
 *                    memory of its own, sealed, in which it commands; owsd believes nothing it
 *                    finds there
 *
 * Fixed-size records, natural alignment, little-endian, no pointers, no locks, no allocator. All
 * words that two processes share are 32 bit. Offsets are bytes from the start of the file or
 * memory. docs/shared-memory.md describes the same in words and suffices to write a reader.
 *
 * History
 *   2.0  a directory of areas; metadata, raw values, origins of commands, changes, shelved alarms,
 *        a journal of commands; commands in a memory for each controller; devices; the log. 1.x had
 *        two segments in /dev/shm
 */
#ifndef OWS_LAYOUT_H
#define OWS_LAYOUT_H
/* The columns are laid out for the reader of the installed file. */
/* clang-format off */

#include <stddef.h>
#include <stdint.h>

#define OWS_LAYOUT_MAJOR 2
#define OWS_LAYOUT_MINOR 1

#define OWS_IMAGE_MAGIC   0x4953574fu /* "OWSI" */
#define OWS_CONTROLLER_MAGIC   0x4753574fu /* "OWSG" */
#define OWS_HELLO_MAGIC   0x4853574fu /* "OWSH" */
#define OWS_WELCOME_MAGIC 0x5753574fu /* "OWSW" */

enum ows_state {
	OWS_STATE_BUILDING = 0,
	OWS_STATE_LIVE = 1,
	OWS_STATE_RETIRED = 2, /* replaced: open the image again by name */
	OWS_STATE_STOPPED = 3, /* owsd ended in order */
};

/* One value with all that belongs to it. */
struct ows_sample { /* 48 bytes, 12 words */
	int64_t value;       /* in engineering units; float and double: a double's bits */
	int64_t measured_ns; /* CLOCK_BOOTTIME; 0: never */
	int64_t tried_ns;    /* last attempt; 0: never */
	int32_t err;         /* 0 or negative errno: of the last read, else of the last write */
	uint8_t quality;     /* enum ows_quality */
	uint8_t detail;      /* OWS_DETAIL_ bits */
	uint8_t target;      /* index in the target area; 255 none */
	uint8_t flags;       /* OWS_SAMPLE_ bits */
	uint32_t count;      /* updates since start */
	uint32_t confirmed;  /* commands confirmed on the bus since start */
	uint32_t len;        /* strings: bytes of text */
	uint32_t check;      /* ows_check() of the eleven words before */
};
#define OWS_SAMPLE_PENDING 0x01 /* commanded, not yet confirmed */
#define OWS_SAMPLE_SAFE    0x02 /* the output was put to SafeValue: its controller is lost */

/* What the attributes are made of; period numbers count from 0 at owsd's start and wrap. */
struct ows_attrs { /* 80 bytes, 20 words */
	uint64_t transactions;
	int64_t update_ns;   /* seconds of _Period: time between the last two updates, ns */
	int64_t age_max_ns;  /* _AgeMax but for the running age */
	int64_t commanded;   /* commanded value, as in sample.value, if OWS_ATTR_COMMANDED */
	int64_t raw;         /* _Raw: bits of a double, before scaling and filter; of a string 0 */
	uint32_t per_base;   /* period of the last update (before it: 0). _PerCount = now - this */
	uint32_t per_max;    /* _PerMax but for the running count */
	uint32_t pend_base;  /* period number when the request in work began, if OWS_ATTR_IN_WORK */
	uint32_t pend_last;
	uint32_t pend_max;   /* but for the running one */
	uint32_t alarms;     /* occurrences since start */
	uint32_t flags;      /* OWS_ATTR_ bits */
	uint8_t limit_state; /* enum ows_limit_state; 0: normal, or without limit alarms */
	uint8_t limit_condition; /* enum ows_alarm_kind of the limit alarm; 0 none */
	uint8_t shelved;     /* 1: the limit alarm is shelved */
	uint8_t spare0;
	uint32_t spare1;
	uint32_t check;      /* ows_check() of the nineteen words before */
};
#define OWS_ATTR_READ_ENABLE  0x01
#define OWS_ATTR_WRITE_ENABLE 0x02
#define OWS_ATTR_IN_WORK      0x04
#define OWS_ATTR_COMMANDED    0x08
#define OWS_ATTR_ALARM_POLLED 0x10 /* alarm item read as an ordinary input: no alarm search there */
#define OWS_ATTR_ALARM_STANDS 0x20 /* the device's alarm stands */
#define OWS_ATTR_LIMITS       0x40 /* it has limit alarms */
#define OWS_ATTR_ALARM_UNARMED 0x80 /* the device's alarm does not come */
#define OWS_ATTR_ALARM_WHY     0x700 /* that is for this enum ows_unarmed, less 1 */
#define OWS_ATTR_ALARM_WHY_SHIFT 8

struct ows_slot { /* 128 bytes */
	struct ows_sample sample;
	struct ows_attrs attrs;
};

/*
 * A signal. Writer of state n: seq = 2n - 1 (release); release fence; write slot[n & 1]; seq = 2n
 * (release).
 * Reader: s = seq (acquire); copy slot[(s >> 1) & 1]; acquire fence; s2 = seq; the copy is whole if
 * s2 - (s & ~1) <= 2 (unsigned), else again. A writer killed anywhere leaves the older slot whole.
 */
struct ows_record { /* 320 bytes */
	uint32_t seq;
	uint32_t text_off; /* strings: two texts of text_cap bytes each, slot n's at text_off +
	                      (n & 1) * text_cap, written under the same seq; else 0 */
	uint8_t type;      /* enum ows_type; constant */
	uint8_t flags;     /* OWS_RECORD_ bits; constant */
	uint16_t text_cap; /* multiple of 4 */
	uint32_t spare;
	struct ows_slot slot[2];
	uint32_t spare2[12];
};
#define OWS_RECORD_OUTPUT 0x01
#define OWS_RECORD_FRESH  0x02 /* read past the cache */
#define OWS_RECORD_ALARM  0x04
#define OWS_RECORD_NO_SET 0x08 /* an input whose Writable is off: nothing sets it */

/*
 * Record 0 is owsd itself: type OWS_LARGE, value = _RECONNECTS, measured_ns = the heartbeat,
 * attrs.transactions = _TRANSACTIONS, attrs.per_base = the period number at the heartbeat. Signals
 * of the file are records 1 and up, in its order.
 */

/* What does not change while a generation lives; info i belongs to record i. Texts are in the pool;
   offset 0: none. A limit that is not set is NaN. */
struct ows_info_entry { /* 192 bytes */
	uint32_t name_off;
	uint32_t path_off;
	uint32_t per_factor;
	uint32_t line;     /* of the configuration file */
	int64_t stale_after_ns;
	int64_t init_value;
	int64_t safe_value;
	uint32_t flags;    /* OWS_INFO_ bits */
	uint32_t unit_off;
	uint32_t description_off;
	uint32_t family_off;     /* the kind of device as the path's family code says: "DS18B20" */
	uint32_t device_off;     /* the device's ROM id as in the path */
	uint32_t calibrated_off; /* a date: "2026-11-22" */
	uint32_t points_off;     /* Points as configured */
	uint32_t decimals;       /* 0xffffffff: not known */
	double scale, offset;    /* 1 and 0 without */
	double min, max;         /* Min and Max */
	double limit_hh, limit_h, limit_l, limit_ll;
	double filter_s, deadband; /* 0 without */
	uint32_t identity_off; /* the path, or Identity; 0, before minor version 1: the path */
	uint32_t group_off;    /* where people look for it: "Heating" */
	uint32_t spare[8];
};
#define OWS_INFO_INIT   0x01
#define OWS_INFO_SAFE   0x02
#define OWS_INFO_LAST   0x04 /* Start "last" */
#define OWS_INFO_SCALED 0x08 /* Scale, Offset or Points: _Raw differs */
#define OWS_INFO_CONFIRM 0x10 /* Confirm: ask a person once more before a set */

/* Names of all records, sorted by bytes (memcmp, shorter first). */
struct ows_name_entry { /* 8 bytes */
	uint32_t name_off;
	uint32_t record;
};

struct ows_target_entry { /* 128 bytes */
	char name[104];      /* NUL-terminated */
	uint32_t state;      /* 0 down, 1 up, 2 suspended */
	uint32_t reconnects;
	uint32_t group;      /* ways to one wire have the same; constant */
	uint32_t moves;      /* signals that came from another target */
	uint32_t spare[2];
};

struct ows_counter_entry { /* 64 bytes */
	char name[48];  /* NUL-terminated */
	uint32_t target; /* index, 0xffffffff: owsd itself */
	uint32_t spare;
	uint32_t low, high; /* of the 64-bit total; for display: they may be of different moments */
};

/* A controller, as owsd knows it: uid and pid are the kernel's word, the two names are claims. */
#define OWS_NAME 32 /* NUL-terminated, filled up with NUL */
struct ows_who { /* 80 bytes */
	uint32_t serial; /* each connection has another, from 1; 0: owsd itself */
	uint32_t uid;
	int32_t pid;     /* 0: unknown */
	uint32_t spare;
	char name[OWS_NAME];   /* of the program */
	char person[OWS_NAME]; /* for whom the program commands; "": for itself */
};

/*
 * Entries that change as a whole: origins, controllers, shelves, journals, devices, log. Writer:
 * seq + 1 (odd); release fence; the rest; seq + 1 (release). Reader: copy as long as seq is odd or
 * changed; 64 times at most. An owsd that was killed leaves at most one entry odd for good. check:
 * ows_check() of the words between seq and check.
 */

/* Origin of the command that is in force; entry i belongs to record i. */
struct ows_origin_entry { /* 104 bytes */
	uint32_t seq;
	uint32_t reason;  /* enum ows_reason (ows.h) */
	int64_t taken_ns; /* when owsd took it; 0: no command */
	struct ows_who who;
	uint32_t spare;
	uint32_t check;
};

/* A connected controller. */
struct ows_controller_entry { /* 120 bytes */
	uint32_t seq;
	uint32_t flags;      /* OWS_CONTROLLER_ bits; 0: the entry is free */
	int64_t joined_ns;
	struct ows_who who;
	uint32_t period_ms;  /* promised longest time between two beats; 0: promised none */
	uint32_t commands;   /* taken */
	uint32_t refused;
	uint32_t spare[2];
	uint32_t check;
};
#define OWS_CONTROLLERS 128
#define OWS_CONTROLLER_CONNECTED 0x01
#define OWS_CONTROLLER_MAY_SET   0x02 /* ControlAllow lets it command some signal */
#define OWS_CONTROLLER_LATE      0x04 /* its beat is over time */

/* A shelved limit alarm. */
#define OWS_SHELVES 64
#define OWS_TEXT 64 /* NUL-terminated, filled up with NUL */
struct ows_shelf_entry { /* 184 bytes */
	uint32_t seq;
	uint32_t record;   /* 0: the entry is free */
	int64_t since_ns, until_ns;
	struct ows_who who;
	char why[OWS_TEXT];
	uint32_t spare[3];
	uint32_t check;
};

/*
 * A device that signals name by its ROM id, in the order of these; and what owsd counted of the
 * requests for its signals.
 */
#define OWS_IDENTITY 48 /* NUL-terminated, filled up with NUL */
struct ows_device_entry { /* 128 bytes */
	uint32_t seq;
	uint32_t id_off;     /* in the pool, as in the configuration; constant */
	uint32_t family_off; /* the kind that its family code names; 0 none; constant */
	uint32_t target;     /* which answered last, index; 0xffffffff: none yet */
	uint64_t answers;    /* of the target, if only an error */
	uint64_t errors;     /* requests that failed, those without an answer too */
	uint64_t retries;    /* of the bus, after errors that it made good or not */
	uint64_t wire_us;    /* what its requests took of the wire, as far as the bus knows */
	int64_t ok_ns;       /* last good answer; 0: none */
	uint32_t power;      /* enum ows_power (ows.h) */
	uint32_t wire;       /* N + 1 of the bus.N of the target; 0: not known */
	char identity[OWS_IDENTITY]; /* which chip it is by its behaviour; "": not known */
	uint32_t spare2[3];
	uint32_t check;
};

/* A line of owsd's log: number n, from 1 at owsd's start, is at place n % count. */
#define OWS_LINE 256 /* NUL-terminated, filled up with NUL */
struct ows_log_entry { /* 280 bytes */
	uint32_t seq;
	uint32_t number; /* 0: the entry is free */
	int64_t time_ns; /* CLOCK_BOOTTIME */
	uint32_t level;  /* of syslog(3): 3 error, 4 warning, 5 notice, 6 info, 7 debug; 8 trace */
	char text[OWS_LINE];
	uint32_t check;
};
/*
 * In OWS_AREA_REFUSED: number counts the reloads that were refused since this image was made, text
 * says why the last one was (level 4: a restart takes it). 0: what is served was loaded last.
 * In OWS_AREA_NOTES: why the target is down; while it is up what disturbs it; "": nothing.
 */

/*
 * The journals: rings of alarms and of commands. Entry number n, from 0 at owsd's start, is at
 * place n % count; the header's head counts what was ever entered, and is stored after the entry. A
 * value after an alarm comes later.
 */
#define OWS_JOURNAL 256
struct ows_journal_entry { /* 200 bytes */
	uint32_t seq;
	uint32_t record;
	int64_t occurred_ns; /* CLOCK_BOOTTIME */
	int64_t before;      /* as in sample.value, if OWS_JOURNAL_BEFORE */
	int64_t after;       /* likewise, if OWS_JOURNAL_AFTER; of commands: the commanded value */
	uint8_t kind;        /* enum ows_alarm_kind; of commands enum ows_reason */
	uint8_t event;       /* enum ows_alarm_event; of commands 0 */
	uint8_t quality;     /* of the signal at that moment */
	uint8_t flags;       /* OWS_JOURNAL_ bits */
	uint32_t more;       /* commands: so many of the signal were not entered before it */
	char text[OWS_TEXT]; /* device alarms: the latch; shelving: why; commands: a text */
	struct ows_who who;  /* who commanded, acknowledged, shelved */
	uint32_t number;
	uint32_t spare[2];
	uint32_t check;
};
#define OWS_JOURNAL_BEFORE 0x01
#define OWS_JOURNAL_AFTER  0x02

/*
 * Changes: a ring of published rows; change number n is at place n % count (a power of two). The
 * header's change_head counts all that were ever entered. Writer: release fence; record; number
 * (release); change_head (release). Reader: head = change_head (acquire); more than count - 1
 * behind: it fell behind and looks at everything; copy entries; acquire fence; change_head again:
 * if the first copied is more than count - 1 behind it now, it may be overwritten, and the reader
 * fell behind.
 */
struct ows_change_entry { /* 8 bytes */
	uint32_t number;
	uint32_t record;
};

/* The directory of areas. An area that a reader does not know is skipped. */
struct ows_area_entry { /* 16 bytes */
	uint32_t kind;  /* enum ows_area */
	uint32_t off;   /* multiple of 8 */
	uint32_t size;  /* of an entry; a later minor version may append to it, a multiple of 8 (but
	                   pool, texts: 1) */
	uint32_t count;
};
enum ows_area {
	OWS_AREA_RECORDS = 1,
	OWS_AREA_INFOS = 2,
	OWS_AREA_NAMES = 3,
	OWS_AREA_TARGETS = 4,
	OWS_AREA_COUNTERS = 5,
	OWS_AREA_POOL = 6,     /* strings, each ended by NUL, and so the last byte */
	OWS_AREA_TEXTS = 7,    /* of string signals */
	OWS_AREA_ORIGINS = 8,
	OWS_AREA_CONTROLLERS = 9,
	OWS_AREA_SHELVES = 10,
	OWS_AREA_ALARMS = 11,   /* journal of alarms */
	OWS_AREA_COMMANDS = 12, /* journal of commands */
	OWS_AREA_CHANGES = 13,
	OWS_AREA_DEVICES = 14,
	OWS_AREA_LOG = 15,
	OWS_AREA_REFUSED = 16, /* one line of the log's form: the reload that was refused last */
	OWS_AREA_NOTES = 17,   /* one line of the log's form for each target */
	OWS_AREAS /* one more than the last */
};

struct ows_image_header { /* 256 bytes: four lines of 64 */
	uint32_t magic;
	uint16_t major, minor;
	uint32_t size;        /* of the file */
	uint32_t generation;  /* changes at each start or reload */
	uint32_t state;       /* enum ows_state; the one word in these 128 bytes that changes */
	int32_t pid;
	uint32_t start_id;    /* random, another one for each generation */
	uint32_t area_off;    /* the directory of areas */
	uint32_t area_count;
	uint32_t served_off;  /* the target that reaches the served protocol, in the pool; 0 none */
	int64_t start_ns;     /* CLOCK_BOOTTIME of owsd's start */
	int64_t start_wall_ns; /* CLOCK_REALTIME of the same moment, for display */
	int64_t period_ns;
	uint32_t spare0[16];

	uint32_t news;         /* counts published batches; futex word */
	uint32_t alarm_head;   /* alarms ever entered into their journal */
	uint32_t command_head; /* likewise commands */
	uint32_t change_head;  /* likewise changes */
	uint32_t spare1[12];

	uint32_t awake;        /* not 0: the engine looks before it sleeps; no bell needed */
	uint32_t spare2[15];
};

/* --- Commands: the memory of one controller --- */

/* A controller's commands for one record; slot i belongs to record i. Slot 0: driver _DGNRESET. */
struct ows_command_slot { /* 64 bytes */
	/* The controller writes: */
	uint64_t value;        /* as ows_sample.value */
	/* the controller counts its commands from 1; release, after the value */
	uint32_t stamp;
	uint32_t person;       /* index + 1 in the persons; 0: for itself */
	uint32_t read_enable;  /* 0 not commanded; else 4 * count + 1 off, + 2 on */
	uint32_t write_enable; /* likewise */
	uint32_t one_shot;     /* counts edges of _WriteOneShot */
	uint32_t dgn_reset;    /* likewise of _DGNRESET; in steps of OWS_STEP_READ _ReadOneShot */
	uint32_t acknowledged; /* counts acknowledgements of the limit alarm */
	uint32_t spare0[3];
	/* owsd writes, for this controller to read: */
	uint32_t taken;        /* stamp of the last command that owsd looked at */
	uint32_t applied;      /* stamp of the last command confirmed on the bus */
	int32_t err;           /* 0, or why the command of stamp taken was refused */
	uint32_t allowed;      /* 1: this controller may command the signal */
};

#define OWS_STEP_READ 0x10000u

/* Strings: texts are whole if the check word is right; the controller stores them before the
 * stamp. */
struct ows_command_text { /* 8 bytes, then text_cap bytes */
	uint32_t len;
	uint32_t check; /* ows_check_bytes() */
};

/* Shelving of limit alarms: one request at a time. */
struct ows_command_shelf { /* 96 bytes */
	uint32_t count;   /* the controller: +1 (release) after the rest */
	uint32_t record;
	uint32_t seconds; /* 0: unshelve */
	uint32_t person;  /* as in a slot */
	char why[OWS_TEXT];
	uint32_t done;    /* owsd: the count that it acted on */
	int32_t err;      /* owsd: 0 or why not */
	uint32_t spare[2];
};

#define OWS_PERSONS 16
struct ows_controller_header { /* 256 bytes */
	/* constant; owsd keeps a copy of its own and never reads these again */
	uint32_t magic;
	uint16_t major, minor;
	uint32_t size;
	uint32_t generation, start_id; /* equal the image's */
	uint32_t serial;
	uint32_t slot_off, slot_size, slot_count;
	uint32_t text_off, text_cap; /* of a string: at text_off + place * (8 + text_cap) */
	uint32_t place_off;          /* u32 for each record: its text's place; 0xffffffff none */
	uint32_t dirty_off, dirty_words; /* one bit for each slot */
	uint32_t person_off;         /* OWS_PERSONS names of OWS_NAME bytes */
	uint32_t shelf_off;          /* struct ows_command_shelf */

	/* owsd writes: */
	uint32_t state;  /* enum ows_state: RETIRED: ows_reopen() gets the next memory */
	uint32_t spare1[15];

	/* the controller writes: */
	uint32_t marked;    /* not 0: some dirty bit may be set; stored after the bits */
	uint32_t beat;      /* counts */
	uint32_t period_ms; /* promised longest time between two beats; 0: none */
	uint32_t goodbye;   /* 1: the controller ends in order; its commands stay in force */
	uint32_t waits;     /* 1: write into the pipe of news at the next one */
	uint32_t spare2[11];

	uint32_t spare3[16];
};

/*
 * The socket NAME.control is of type SOCK_SEQPACKET. The program sends one hello; owsd answers with
 * one welcome. With err 0 three descriptors come along: the memory (a memfd sealed against
 * shrinking, growing and further seals), the bell (an eventfd) and the news (the end of a pipe that
 * is read). After a reload owsd sends another welcome, with the memory of the new generation alone.
 * The connection lasts as long as the controller.
 *
 * A hello with OWS_HELLO_RELOAD makes no controller: it asks owsd to load its configuration again,
 * which root, owsd's user and the group owsd-config may. owsd answers with one welcome of size 0,
 * without descriptors, when it serves the configuration (err 0; its generation) or has refused it;
 * in the same message the reason follows in words, or with err 0 how many warnings there are and
 * the first, OWS_WHY bytes at most, without NUL. Then owsd hangs up.
 */
struct ows_hello { /* 128 bytes */
	uint32_t magic;
	uint16_t major, minor;
	uint32_t flags;      /* OWS_HELLO_ bits */
	uint32_t spare0;
	uint8_t token[16];   /* of the welcome before, when the controller comes back; else 0 */
	char name[OWS_NAME]; /* of the program, as it shall be shown */
	uint32_t spare[16];
};
#define OWS_HELLO_COMMAND 0x01 /* it wants to command; else only to hear of news */
#define OWS_HELLO_RELOAD  0x02 /* it asks for a reload, and for nothing else */

struct ows_welcome { /* 64 bytes */
	uint32_t magic;
	uint16_t major, minor;
	int32_t err;         /* 0, -EACCES: may not command, -ENOSPC: too many, -EPROTO: major */
	uint32_t generation, start_id;
	uint32_t serial;
	uint32_t size;       /* of the memory; 0: the answer to a program that asked for a reload */
	uint32_t spare0;
	uint8_t token[16];   /* secret: who has it comes back as this controller */
	uint32_t spare[4];
};
#define OWS_WHY 240

/* Check words: mixes n words; a reader without memory fences verifies what it copied by it. */
static inline uint32_t ows_check(const uint32_t *word, size_t n)
{
	uint32_t h = 0x9e3779b9u;

	for (size_t i = 0; i < n; i++) {
		h ^= word[i];
		h *= 0x85ebca6bu;
		h ^= h >> 15;
	}
	return h;
}

/* The same for len bytes of text. */
static inline uint32_t ows_check_bytes(const char *text, size_t len)
{
	uint32_t h = 0x9e3779b9u ^ (uint32_t)len;

	for (size_t i = 0; i < len; i++) {
		h ^= (uint8_t)text[i];
		h *= 0x85ebca6bu;
		h ^= h >> 15;
	}
	return h;
}

#ifdef __cplusplus
#define OWS_STATIC_ASSERT(c) static_assert(c, #c)
#else
#define OWS_STATIC_ASSERT(c) _Static_assert(c, #c)
#endif
OWS_STATIC_ASSERT(sizeof(struct ows_sample) == 48);
OWS_STATIC_ASSERT(offsetof(struct ows_sample, check) == 44);
OWS_STATIC_ASSERT(sizeof(struct ows_attrs) == 80);
OWS_STATIC_ASSERT(offsetof(struct ows_attrs, check) == 76);
OWS_STATIC_ASSERT(sizeof(struct ows_slot) == 128);
OWS_STATIC_ASSERT(sizeof(struct ows_record) == 320);
OWS_STATIC_ASSERT(offsetof(struct ows_record, slot) == 16);
OWS_STATIC_ASSERT(sizeof(struct ows_info_entry) == 192);
OWS_STATIC_ASSERT(sizeof(struct ows_name_entry) == 8);
OWS_STATIC_ASSERT(sizeof(struct ows_target_entry) == 128);
OWS_STATIC_ASSERT(sizeof(struct ows_counter_entry) == 64);
OWS_STATIC_ASSERT(sizeof(struct ows_who) == 80);
OWS_STATIC_ASSERT(sizeof(struct ows_origin_entry) == 104);
OWS_STATIC_ASSERT(sizeof(struct ows_controller_entry) == 120);
OWS_STATIC_ASSERT(sizeof(struct ows_shelf_entry) == 184);
OWS_STATIC_ASSERT(sizeof(struct ows_device_entry) == 128);
OWS_STATIC_ASSERT(sizeof(struct ows_log_entry) == 280);
OWS_STATIC_ASSERT(sizeof(struct ows_journal_entry) == 200);
OWS_STATIC_ASSERT(sizeof(struct ows_change_entry) == 8);
OWS_STATIC_ASSERT(sizeof(struct ows_area_entry) == 16);
OWS_STATIC_ASSERT(sizeof(struct ows_image_header) == 256);
OWS_STATIC_ASSERT(offsetof(struct ows_image_header, news) == 128);
OWS_STATIC_ASSERT(offsetof(struct ows_image_header, awake) == 192);
OWS_STATIC_ASSERT(sizeof(struct ows_command_slot) == 64);
OWS_STATIC_ASSERT(sizeof(struct ows_command_text) == 8);
OWS_STATIC_ASSERT(sizeof(struct ows_command_shelf) == 96);
OWS_STATIC_ASSERT(sizeof(struct ows_controller_header) == 256);
OWS_STATIC_ASSERT(offsetof(struct ows_controller_header, state) == 64);
OWS_STATIC_ASSERT(offsetof(struct ows_controller_header, marked) == 128);
OWS_STATIC_ASSERT(sizeof(struct ows_hello) == 128);
OWS_STATIC_ASSERT(sizeof(struct ows_welcome) == 64);

#endif
