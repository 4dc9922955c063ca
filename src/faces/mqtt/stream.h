/* SPDX-License-Identifier: MIT */
/*
 * The stream: the signals of an instance as rows, which of them have news, and what was published
 * of each. A profile decides how a row becomes a message, an outlet takes messages. There is no
 * queue of messages: a row that waits has the newest value when it goes.
 */
#pragma once

#include <stdbool.h>
#include <stdio.h>

#include "hal/owfs/path.h"
#include "src/faces/mqtt/topics.h"
#include "src/faces/show/json.h"
#include "src/faces/show/newest.h"
#include "src/public/ows.h"

/* What takes messages. retain: the broker keeps it for those who come later. */
struct outlet {
	/* False: not now; what was not taken comes again. */
	bool (*put)(void *ctx, const char *topic, const char *text, size_t len, bool retain);
	void *ctx;
};

struct row {
	struct ows_info info; /* its texts count while the image of stream_make() does */
	char chip_id
		[ROM_TEXT_MAX]; /* of the identity, in the one form that it has here; "": none */
	const char *property;   /* what stands after the device in the identity */
	const char *class;      /* the key Class; "": none */
	char *name;             /* a copy, which counts longer than info */
	char *level;            /* what stands for it in topics */
	char *topic;            /* of its value */
	int id;                 /* of ows_find() */
	int chip;               /* its chip; -1: none */
	bool queued, away, answers, alarms;
	bool twin;            /* another name has the same slug */
	bool twice;           /* another row before it has its chip and property */
	bool published;       /* once at least since the birth */
	bool good, simulated; /* what was published */
	uint8_t quality;      /* the same */
	uint64_t print;       /* a hash of what was published */
	int64_t published_ns; /* when */
	uint32_t alarm_print; /* of its limit alarm; 0: not published */
	bool key_away;        /* of a key: it was looked for, and not there */
	/*
	 * Of a session: times of the value that was published last, of the first one since its
	 * begin, of the last one that the broker has for certain, and of that one before the last
	 * outage; prints of the same, and of the last one that was sent again.
	 */
	int64_t moment_ns, born_ns, sure_ns, past_ns;
	uint64_t told, sure_told, past_told, past_print;
	int64_t past_us; /* since 1970, of the last one that was sent again */
};
/* A value of a row at a time that is past. */
struct past_value {
	struct row *row;
	int64_t wall_us; /* since 1970 */
	bool here;       /* in this boot: it moves with the clock */
	struct ows_value v;
	char *text; /* of a string */
	int place;  /* in their order */
};
/* Does a device of the wire answer? Unknown: it never has, and nothing says that it is away. */
enum chip_state {
	CHIP_OFFLINE,
	CHIP_UNKNOWN,
	CHIP_ONLINE,
};
struct chip {
	const char *id, *family;         /* as of its rows */
	int first;                       /* its rows are s->by_chip[first] and those after it */
	char *topic;                     /* whether it is there */
	int rows, inputs, away, answers; /* signals; of them that cannot reach it, that do */
	bool seen;                       /* it was there once, since owsd-mqtt has started */
	bool announced;                  /* by the birth */
	uint64_t birth_print;            /* a hash of it, if the broker has it; 0: it may not */
	uint64_t problem_print;          /* of what is wrong with it; 0: not published */
	bool filled;                     /* what was missed has had values of it that were good */
	bool lent;                       /* announced for what was missed alone: a death is due */
	bool published;
	enum chip_state state; /* what was published */
};

struct gone {
	char *topic, *text; /* text: what is to be published there once */
};

/* The value of a row, as it is now. */
struct news {
	struct face_value value; /* with its text, of numbers too */
	uint64_t print;
	int64_t now_ns;
};

/* A metric in the text of a message. */
struct part {
	uint64_t time;
	long at, len;
};

/* How the node is. */
enum stream_node {
	STREAM_THERE,
	STREAM_LOST,   /* owsd is */
	STREAM_KILLED, /* owsd-mqtt was: its will */
	STREAM_ENDED,  /* it ends */
};

enum { HEALTH_DOWN, HEALTH_BAD, HEALTH_ERRORS, HEALTH_RECONNECTS, HEALTH_NUMBERS };

struct profile;
struct stream {
	const struct profile *profile;
	struct outlet outlet;
	/* What all topics begin with; the keys. The texts belong to the caller. */
	const char *prefix, *topic, *node, *discovery, *link;
	bool write, old_readers;
	struct ows *h;
	/* The key Class of a signal; "": none. The text counts until the next stream_make(). */
	const char *(*class_of)(void *ctx, const char *name);
	void *class_ctx;
	struct row *rows;
	int count;
	struct row **by_topic, **by_chip; /* all rows; those without a chip are first */
	struct chip *chips;
	int chip_count;
	int *queue, queue_at, queue_len;    /* rows with news, the oldest first */
	struct gone *gone;                  /* topics of which something is no more */
	int gone_at, gone_count, gone_room; /* those before gone_at are published */
	bool settled;   /* what the broker keeps of the node is ours alone, and can be emptied */
	bool live;      /* owsd is there: else no value is good */
	int birth;      /* the next message of the birth; -1: all is published */
	int each;       /* how many entities of it are */
	bool announced; /* the node itself, by the birth */
	uint64_t birth_print;            /* as of chips */
	bool online;                     /* it was published that the node is there */
	char *health;                    /* as it was published last */
	int64_t numbers[HEALTH_NUMBERS]; /* the same, of a session */
	bool clock_set;                  /* wall-clock times can be believed */
	bool clock_right;                /* they are those of others, too: it is synchronised */
	uint64_t described;              /* by homie5: a hash of the description, */
	int64_t description;             /* and its version */
	/*
	 * Of sessions: the host that each waits for, NULL for none; is it there; the time of its
	 * last word, ms; was the node born to it since the last connection?
	 */
	const char *host;
	bool host_there, born;
	uint64_t host_ms;
	/* The number of the CONNECT with the will, of the next message */
	uint8_t bdseq, seq;
	struct part *parts; /* room for two of each row, and for those of the node */
	int part_count;
	FILE *out; /* makes a message in text */
	char *text;
	size_t len;
};

/* A command: the signal, its value, what is wrong with it, else NULL. */
typedef void stream_take(void *ctx, const char *name, const char *text, const char *fault);

/*
 * A profile: how the stream looks at the broker. Each function puts messages; false: the outlet
 * does not take one now, and the call comes again.
 */
struct profile {
	const char *name; /* as the key Profile has it */
	/*
	 * Stands before the id of the node, or, without dash, before the key Topic. NULL: all
	 * begins with the keys Topic and Node.
	 */
	const char *root;
	char dash;   /* what topic_slug() puts into ids; 0: topic_escape() makes them */
	uint8_t qos; /* of messages; wills and commands have 1 at least */
	bool health; /* it publishes the message of health */
	/* A birth begins a session, with numbers and right times, and nothing else goes before */
	bool session;
	const char *none; /* what is published last at the topic of a signal that is no more */
	/* Below the prefix, with wildcards; the last level has none. NULL: listen_write, take */
	const char *commands;
	/*
	 * Likewise, where values are asked for, and TOPIC_READ and TOPIC_RENAME beside it; NULL:
	 * nowhere, and no command has an answer
	 */
	const char *asks;
	/* Where retained messages may stand, likewise; NULL at the end, or in its place: nowhere */
	const char *const *below;
	/* Is the topic, which ends with below, one of what there is now? */
	bool (*writes)(const struct stream *s, const char *topic, const char *below);
	/* The topic of a row's value. */
	void (*topic)(const struct stream *s, const struct row *row, char topic[TOPIC_SIZE]);
	/*
	 * A part of what announces what there is, by its number. *more: there are further ones.
	 * NULL, as all functions below that have to do with births: nothing is announced.
	 */
	bool (*birth)(struct stream *s, int number, bool *more);
	/* The value and quality of a row. */
	bool (*value)(struct stream *s, struct row *row);
	bool (*state)(struct stream *s, enum stream_node node);
	/* Health, as numbers, if they are others than were published. NULL: as the flag has it. */
	bool (*numbers)(struct stream *s);
	/* An entry of the journal of alarms; one that is not taken is lost. NULL: it shows none. */
	void (*alarm)(struct stream *s, const struct ows_alarm *alarm);
	/*
	 * What values of a chip, or of what has none, were, in the order of time. The node is born.
	 * NULL: it shows only what is.
	 */
	bool (*past)(struct stream *s, const struct past_value *values, int n);
	/* A topic to listen to besides those of commands. */
	void (*listen)(const struct stream *s, char topic[TOPIC_SIZE]);
	/* The topic of the host, which stream.host names. NULL: it waits for none. */
	void (*listen_host)(const struct stream *s, char topic[TOPIC_SIZE]);
	/* The topics of commands, */
	void (*listen_write)(const struct stream *s, char topic[TOPIC_SIZE]);
	/* and the commands of a message there or at that of listen. True: as of heard. */
	bool (*take)(struct stream *s, const char *topic, const char *text, size_t len,
	             stream_take *take, void *ctx);
	/* What came there or of the host. True: the birth has to be published again. */
	bool (*heard)(struct stream *s, const char *topic, const char *text, size_t len);
	/* Where retained births of ours may stand, by a number from 0. False: there is no more. */
	bool (*births)(const struct stream *s, int number, char topic[TOPIC_SIZE]);
	/*
	 * What has to be published there because something of one of these is no more: "" if
	 * nothing of it is left, as of all when s has another profile; else s->text, and the birth
	 * follows. NULL: nothing, or it is not of this node.
	 */
	const char *(*outlived)(struct stream *s, const char *topic, const char *text);
};
/* 0 or -ENOMEM. */
int stream_open(struct stream *s);
void stream_close(struct stream *s);
/*
 * The signals of h, in place of those before. All is to be published. Allocates. 0 or -ENOMEM:
 * there are no rows.
 */
int stream_make(struct stream *s, struct ows *h);
/* There are no signals, until stream_make(): their topics are not of the present profile. */
void stream_clear(struct stream *s);
/* The chip of an id in the one form; NULL: no signal names it. */
struct chip *stream_chip(const struct stream *s, const char *id);
/* The row whose value the first len bytes of topic are for; NULL: none. */
const struct row *stream_row(const struct stream *s, const char *topic, size_t len);
enum stream_ask {
	STREAM_NO_ASK,
	STREAM_SET,  /* a command */
	STREAM_GET,  /* a question for the value */
	STREAM_READ, /* a command: owsd is to read it now */
	STREAM_RENAME,
};
/* What is topic of? *row is whose, or NULL; name gets what to call it. */
enum stream_ask stream_command(const struct stream *s, const char *topic, const struct row **row,
                               char name[TOPIC_SIZE]);
/* What follows prefix and a slash in topic; NULL: it begins otherwise. */
const char *stream_below(const char *topic, const char *prefix);
/* The text is to be published once, retained, at a topic of what is no more. It is copied. */
void stream_gone(struct stream *s, const char *topic, const char *text);
/* Signals have news, as in face_ops.changes. */
void stream_changes(struct stream *s, const int *signals, int n);
/* Signals whose value has to be published again have news, though no change came. */
void stream_repeat(struct stream *s, int64_t now_ns);
/* All is to be published, as to a broker that knows nothing. */
void stream_begin(struct stream *s);
/* What there is is to be announced again; all: also what the broker has, as it is now. */
void stream_announce(struct stream *s, bool all);
/* owsd is there, or not. */
void stream_live(struct stream *s, bool live);
/* Put what waits, as much as the outlet takes. True: nothing waits. */
bool stream_pump(struct stream *s);

/* For profiles: begin a message, put it. */
void stream_message(struct stream *s, struct json *json);
bool stream_put(struct stream *s, const char *topic, bool retain);
bool stream_put_text(struct stream *s, const char *topic, const char *text, bool retain);
/* The same at a topic below the prefix, retained; text NULL: the message that was begun. */
bool stream_put_below(struct stream *s, const char *below, const char *text);
/* Begin a message that is the value alone; yes, no: of a bool. */
void stream_value(struct stream *s, const struct news *news, const char *yes, const char *no);
/* How often a value that stays the same is published again, ns; 0: never. From StaleAfter. */
int64_t stream_repeat_ns(const struct ows_info *info);
/* What a row's value is. True: it has to be published, and stream_published() is due then. */
bool stream_read(struct stream *s, struct row *row, struct news *news);
bool stream_published(struct row *row, const struct news *news); /* Returns true. */
