/* SPDX-License-Identifier: MIT */
/*
 * The published layout of the two shared-memory segments of an instance:
 *
 *     /dev/shm/owsd.NAME.image     only owsd writes; consumers map it read-only
 *     /dev/shm/owsd.NAME.command   consumers write; owsd believes nothing it finds there
 *
 * Fixed-size records, natural alignment, little-endian, no pointers, no locks, no allocator. All
 * words that two processes share are 32 bit. Offsets are bytes from the start of the segment.
 * docs/shared-memory.md describes the same in words and suffices to write a reader.
 *
 * History
 *   1.0  first layout
 *   1.1  image: a journal of alarms; in the attributes the state of limit alarms and three flags;
 *        commands: words of acknowledgement
 *   1.2  image: group and moves of a target, and where the owserver protocol is served, which
 *        were 0; a flag of alarms that cannot be armed; commands: the mark of SafeValue
 */
#ifndef OWS_LAYOUT_H
#define OWS_LAYOUT_H
/* The columns are laid out for the reader of the installed file. */
/* clang-format off */

#include <stddef.h>
#include <stdint.h>

#define OWS_LAYOUT_MAJOR 1
#define OWS_LAYOUT_MINOR 2

#define OWS_IMAGE_MAGIC   0x4953574fu /* "OWSI" */
#define OWS_COMMAND_MAGIC 0x4353574fu /* "OWSC" */

enum ows_state {
	OWS_STATE_BUILDING = 0,
	OWS_STATE_LIVE = 1,
	OWS_STATE_RETIRED = 2, /* replaced: open the segment again by name */
	OWS_STATE_STOPPED = 3, /* owsd ended in order */
};

/* One value with all that belongs to it. */
struct ows_sample { /* 48 bytes, 12 words */
	int64_t value;       /* bits of a double for float and double, else the integer */
	int64_t measured_ns; /* CLOCK_BOOTTIME; 0: never */
	int64_t tried_ns;    /* last attempt; 0: never */
	int32_t err;         /* 0 or negative errno: of the last read, else of the last write */
	uint8_t quality;     /* enum ows_quality */
	uint8_t detail;      /* OWS_DETAIL_ bits */
	uint8_t target;      /* index in the target area; 255 none */
	uint8_t flags;       /* OWS_SAMPLE_ bits */
	uint32_t count;      /* updates since start */
	uint32_t applied;    /* stamp of the last command confirmed on the bus */
	uint32_t len;        /* strings: bytes of text */
	uint32_t check;      /* ows_check() of the eleven words before */
};
#define OWS_SAMPLE_PENDING 0x01 /* commanded, not yet confirmed */
#define OWS_SAMPLE_SAFE    0x02 /* the output was put to SafeValue: its client stopped beating */

/* What the attributes are made of; period numbers count from 0 at owsd's start and wrap. */
struct ows_attrs { /* 72 bytes, 18 words */
	uint64_t transactions;
	int64_t update_ns;   /* seconds of _Period: time between the last two updates, ns */
	int64_t age_max_ns;  /* _AgeMax but for the running age */
	int64_t commanded;   /* commanded value, as in sample.value, if OWS_ATTR_COMMANDED */
	uint32_t per_base;   /* period of the last update (before it: 0). _PerCount = now - this */
	uint32_t per_max;    /* _PerMax but for the running count */
	uint32_t pend_base;  /* period number when the request in work began, if OWS_ATTR_IN_WORK */
	uint32_t pend_last;
	uint32_t pend_max;   /* but for the running one */
	uint32_t alarms;     /* occurrences since start */
	uint32_t flags;      /* OWS_ATTR_ bits */
	uint8_t limit_state; /* enum ows_limit_state; 0: normal, or without limit alarms */
	uint8_t limit_condition; /* enum ows_alarm_kind of the limit alarm; 0 none */
	uint8_t spare0[2];
	uint32_t spare1;
	uint32_t check;      /* ows_check() of the seventeen words before */
};
#define OWS_ATTR_READ_ENABLE  0x01
#define OWS_ATTR_WRITE_ENABLE 0x02
#define OWS_ATTR_IN_WORK      0x04
#define OWS_ATTR_COMMANDED    0x08
#define OWS_ATTR_ALARM_POLLED 0x10 /* alarm item read as an ordinary input: no alarm search there */
#define OWS_ATTR_ALARM_STANDS 0x20 /* the device's alarm stands */
#define OWS_ATTR_LIMITS       0x40 /* it has limit alarms */
#define OWS_ATTR_ALARM_UNARMED 0x80 /* the device's alarm cannot be armed */
#define OWS_ATTR_ALARM_POR     0x100 /* that is for its PorAlarm; else for SetAlarm */

struct ows_slot { /* 120 bytes */
	struct ows_sample sample;
	struct ows_attrs attrs;
};

/*
 * A signal. Writer of state n: seq = 2n - 1 (release); release fence; write slot[n & 1]; seq = 2n
 * (release).
 * Reader: s = seq (acquire); copy slot[(s >> 1) & 1]; acquire fence; s2 = seq; the copy is whole if
 * s2 - (s & ~1) <= 2 (unsigned), else again. A writer killed anywhere leaves the older slot whole.
 */
struct ows_record { /* 256 bytes */
	uint32_t seq;
	uint32_t text_off; /* strings: two texts of text_cap bytes each, slot n's at text_off +
	                      (n & 1) * text_cap, written under the same seq; else 0 */
	uint8_t type;      /* enum ows_type; constant */
	uint8_t flags;     /* OWS_RECORD_ bits; constant */
	uint16_t text_cap; /* multiple of 4 */
	uint32_t spare;
	struct ows_slot slot[2];
};
#define OWS_RECORD_OUTPUT 0x01
#define OWS_RECORD_FRESH  0x02 /* read past the cache */
#define OWS_RECORD_ALARM  0x04
#define OWS_RECORD_NO_SET 0x08 /* an input whose Writable is off: nothing sets it (since 1.2) */

/*
 * Record 0 is owsd itself: type OWS_LARGE, value = _RECONNECTS, measured_ns = the heartbeat,
 * attrs.transactions = _TRANSACTIONS, attrs.per_base = the present period number. Signals of the
 * file are records 1 and up, in its order.
 */

/* What does not change while a generation lives; info i belongs to record i. */
struct ows_info_entry { /* 64 bytes */
	uint32_t name_off; /* NUL-terminated, in the string pool */
	uint32_t path_off;
	uint32_t per_factor;
	uint32_t line;     /* of the configuration file */
	int64_t stale_after_ns;
	int64_t init_value;
	int64_t safe_value;
	uint32_t flags;    /* OWS_INFO_ bits */
	uint32_t spare[5];
};
#define OWS_INFO_INIT 0x01
#define OWS_INFO_SAFE 0x02

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

/*
 * The journal of alarms: a ring of alarm_count entries; entry number n, from 0 at owsd's start, is
 * at place n % alarm_count. Writer: seq + 1 (odd); release fence; the rest; seq + 1 (release); for
 * a new entry then alarm_head. A value after comes later, in the same way. Reader: copy as long as
 * seq is odd or changed; the entry is the one wanted if its number is.
 */
#define OWS_ALARMS 256
struct ows_alarm_entry { /* 64 bytes, 16 words */
	uint32_t seq;
	uint32_t record;
	int64_t occurred_ns; /* CLOCK_BOOTTIME */
	int64_t before;      /* as in sample.value, if OWS_ALARM_BEFORE */
	int64_t after;       /* likewise, if OWS_ALARM_AFTER */
	uint8_t kind;        /* enum ows_alarm_kind */
	uint8_t event;       /* enum ows_alarm_event */
	uint8_t quality;     /* of the signal at that moment */
	uint8_t flags;       /* OWS_ALARM_ bits */
	char latch[20];      /* device alarms: text of the latch, filled up with NUL */
	uint32_t number;
	uint32_t check;      /* ows_check() of the fourteen words record .. number */
};
#define OWS_ALARM_BEFORE 0x01
#define OWS_ALARM_AFTER  0x02

struct ows_image_header { /* 256 bytes: four lines of 64 */
	uint32_t magic;
	uint16_t major, minor;
	uint32_t size;        /* of the segment */
	uint32_t generation;  /* changes at each start or reload */
	uint32_t state;       /* enum ows_state; the one word here that changes */
	int32_t pid;
	uint32_t start_id;    /* random, the same for both segments of a generation */
	uint32_t alarm_off;   /* journal of alarms; 0 in 1.0 */
	int64_t start_ns;     /* CLOCK_BOOTTIME of owsd's start */
	int64_t start_wall_ns; /* CLOCK_REALTIME of the same moment, for display */
	int64_t period_ns;
	uint32_t alarm_size, alarm_count;

	uint32_t record_off, record_size, record_count; /* count includes record 0 */
	uint32_t info_off, info_size;
	uint32_t name_off;    /* record_count entries of 8 bytes */
	uint32_t target_off, target_size, target_count;
	uint32_t counter_off, counter_size, counter_count;
	uint32_t pool_off, pool_size; /* strings */
	uint32_t text_off, text_size; /* texts of string signals */

	uint32_t news;        /* counts published states; futex word */
	uint32_t alarm_head;  /* number of alarms ever entered */
	uint32_t served_off;  /* the target that reaches the served protocol, in the pool; 0 none */
	uint32_t spare2[13];

	uint32_t spare3[16];
};

/* A consumer's commands for one record; slot i belongs to record i. Slot 0: driver _DGNRESET. */
struct ows_command_slot { /* 32 bytes */
	uint64_t value;    /* as ows_sample.value */
	uint32_t stamp;    /* counts commands (fetch_add after value is stored); 0: never set */
	uint32_t client;   /* index + 1 in the client table of who set it last; 0: nobody who beats;
	                      OWS_CLIENT_SAFE: owsd put it to SafeValue */
	uint32_t read_enable;  /* 0 not commanded, 1 off, 2 on */
	uint32_t write_enable; /* likewise */
	uint32_t one_shot;     /* counts edges of _WriteOneShot */
	uint32_t dgn_reset;    /* counts edges of _DGNRESET */
};

#define OWS_CLIENT_SAFE 0xffffffffu

/* Strings: the claim is taken by compare-and-swap from 0 to the writer's pid. */
struct ows_command_text { /* 16 bytes, then text_cap bytes */
	uint32_t claim;
	uint32_t len;
	uint32_t check; /* ows_check_bytes() */
	uint32_t spare;
};

/* What a slot meant, so that values are carried over a restart by name, type and path. */
struct ows_command_entry { /* 16 bytes */
	uint32_t name_off;
	uint32_t path_off;
	uint32_t type;
	uint32_t text_off; /* strings: offset of struct ows_command_text, else 0 */
};

#define OWS_CLIENTS 32
struct ows_client { /* 32 bytes */
	uint32_t pid;       /* 0: free; taken by compare-and-swap */
	uint32_t beat;      /* counts */
	uint32_t period_ms; /* promised longest time between two beats */
	uint32_t spare[5];
};

struct ows_command_header { /* 256 bytes */
	uint32_t magic;
	uint16_t major, minor;
	uint32_t size;
	uint32_t generation;
	uint32_t state;    /* enum ows_state, written by owsd */
	int32_t pid;
	uint32_t start_id;
	uint32_t slot_off, slot_size, slot_count;
	uint32_t entry_off, entry_size;
	uint32_t dirty_off, dirty_words; /* one bit for each slot, set by consumers */
	uint32_t client_off, client_size;

	uint32_t pool_off, pool_size;
	uint32_t text_off, text_size, text_cap;
	uint32_t ack_off;  /* one word for each slot: counts acknowledgements; 0 in 1.0 */
	uint32_t spare1[10];

	uint32_t bell;     /* the engine's futex word: fetch_add 1, wake one */
	uint32_t awake;    /* not 0: the engine works and looks before it sleeps; no wake needed */
	uint32_t spare2[14];

	uint32_t spare3[16];
};

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
OWS_STATIC_ASSERT(sizeof(struct ows_attrs) == 72);
OWS_STATIC_ASSERT(offsetof(struct ows_attrs, check) == 68);
OWS_STATIC_ASSERT(sizeof(struct ows_slot) == 120);
OWS_STATIC_ASSERT(sizeof(struct ows_record) == 256);
OWS_STATIC_ASSERT(offsetof(struct ows_record, slot) == 16);
OWS_STATIC_ASSERT(sizeof(struct ows_info_entry) == 64);
OWS_STATIC_ASSERT(sizeof(struct ows_name_entry) == 8);
OWS_STATIC_ASSERT(sizeof(struct ows_target_entry) == 128);
OWS_STATIC_ASSERT(sizeof(struct ows_counter_entry) == 64);
OWS_STATIC_ASSERT(sizeof(struct ows_alarm_entry) == 64);
OWS_STATIC_ASSERT(offsetof(struct ows_alarm_entry, latch) == 36);
OWS_STATIC_ASSERT(sizeof(struct ows_image_header) == 256);
OWS_STATIC_ASSERT(offsetof(struct ows_image_header, record_off) == 64);
OWS_STATIC_ASSERT(offsetof(struct ows_image_header, news) == 128);
OWS_STATIC_ASSERT(sizeof(struct ows_command_slot) == 32);
OWS_STATIC_ASSERT(sizeof(struct ows_command_text) == 16);
OWS_STATIC_ASSERT(sizeof(struct ows_command_entry) == 16);
OWS_STATIC_ASSERT(sizeof(struct ows_client) == 32);
OWS_STATIC_ASSERT(sizeof(struct ows_command_header) == 256);
OWS_STATIC_ASSERT(offsetof(struct ows_command_header, bell) == 128);

#endif
