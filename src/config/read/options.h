/* SPDX-License-Identifier: MIT */
/*
 * All keys of the configuration in one table: the reader takes types, limits and defaults from it,
 * owsd --check and the edits their order, and a test lays the manual page beside it.
 */
#pragma once

#include "src/config/read/config.h"
#include "src/config/read/rio.h"
#include "src/config/read/texts.h"
#include "src/ground/signal/value.h"

enum option_place {
	PLACE_DRIVER,
	PLACE_ITEM,
	PLACE_BUS,
#define BLOCK(name, ...) PLACE_##name,
#include "src/config/read/option_list.h"
	PLACE_COUNT,
};

enum option_kind {
	OPTION_TEXT,
	OPTION_COUNT,   /* whole number, decimal or 0x hexadecimal */
	OPTION_SECONDS, /* decimal */
	OPTION_NUMBER,  /* decimal */
	OPTION_FLAG,    /* on, off */
	OPTION_TYPE,    /* a name of value_type_name() */
	OPTION_IO,      /* input, output */
	OPTION_BLOCK,
};

/* How its member in the struct of the block holds it: by the type of that member. */
enum option_store {
	STORE_NONE,     /* there is no such member: code of its own takes the value */
	STORE_TEXT,     /* const char *; NULL: not given, and no preset */
	STORE_BOOL,     /* bool */
	STORE_UNSIGNED, /* unsigned */
	STORE_NS,       /* int64_t, nanoseconds */
	STORE_DOUBLE,   /* double */
};

enum option {
#define OTHER(name, ...) OPT_##name,
#include "src/config/read/option_list.h"
	OPTION_COUNT_ALL,
};

struct option_def {
	const char *key;
	enum option_place place;
	enum option_kind kind;
	bool repeats;       /* may stand more than once */
	bool empty;         /* an empty text is a value of its own, and not the same as no key */
	bool quiet;         /* printed only where it is not the default */
	double least, most; /* counts, seconds and numbers; both 0: any number */
	size_t offset;      /* of the member in the struct of its block */
	enum option_store store;
	size_t has, at; /* of the bool that it is given, of its config_spot; 0: there is none */
	enum option_place inside; /* of a block that stands once: the place of its own keys */
	text_check *check;        /* of a text; NULL: it may be any */
	const char *words;        /* of a text that is one of these, "init or last"; NULL: other */
	const char *needed;       /* an example of what a block cannot be without; NULL: it can */
	const char *preset;       /* the default as it would be written; NULL: none */
	const char *help;         /* one line */
};
extern const struct option_def option_table[OPTION_COUNT_ALL];

/* How messages call a place: "OwsDrv", "Item". */
const char *option_place_name(enum option_place place);
/* The option of that key, -1 if there is none. */
int option_find(enum option_place place, const char *key);
/*
 * Write the nearest known keys of the place, "LimitH or LimitHH" where several are as near, into
 * text. Returns text; NULL if none is near.
 */
#define OPTION_NEAREST 200
const char *option_nearest(enum option_place place, const char *key, char text[OPTION_NEAREST]);
/*
 * The key of an alarm that has such a value, or such a name: the original's names of these keys are
 * not public. NULL: it is no part of an alarm.
 */
const char *option_of_alarm(const char *key, const char *value, char text[OPTION_NEAREST]);

/* Is the node a block of that key? */
bool option_is_block(const struct rio_node *node, enum option option);
/* The row of a block of that name that stands once, such as Recorder; NULL: it is none. */
const struct option_def *option_single(const char *name);
/* How many of them the driver's block has. */
unsigned options_blocks(const struct rio_node *driver, enum option option);

/* The bits of IOType. */
#define IO_TYPE_CODE 0x0fu
#define IO_TYPE_INPUT 0x10u
#define IO_TYPE_OUTPUT 0x20u
#define IO_TYPE_UNCACHED 0x100u
#define IO_TYPE_KNOWN (IO_TYPE_CODE | IO_TYPE_INPUT | IO_TYPE_OUTPUT | IO_TYPE_UNCACHED)

/* A key of a block as the reader found it. */
struct option_value {
	const struct rio_node *node; /* NULL: absent */
	bool given;                  /* present and valid; if not, number is the default */
	const char *text;            /* "" if not given */
	double number; /* counts, seconds, numbers, flags (0, 1), types, IO (1: output) */
};
/* Of seconds. */
static inline int64_t option_ns(const struct option_value *value)
{
	return (int64_t)(value->number * 1e9 + 0.5);
}
/* Where the value stands; 0 and 0: the key is absent. */
static inline struct config_spot option_spot(const struct option_value *value)
{
	struct config_spot none = {0, 0};

	return value->node ? (struct config_spot){value->node->value_at.line,
	                                          value->node->value_at.column}
	                   : none;
}

struct build;
/* One key of a block, checked against its row. value: begun by option_begin(). */
void option_begin(const struct option_def *def, struct option_value *value);
void option_read(const struct option_def *def, const struct rio_node *node,
                 struct option_value *value, struct config_report *report);
/* Put the value, or the default, into its member of the struct of the block. */
void option_take(struct build *build, const struct option_def *def,
                 const struct option_value *value, void *to);
/*
 * The same of all keys of a block (NULL: it is absent) into values, which has OPTION_COUNT_ALL
 * entries, and into the struct of the block (NULL: none). Unknown keys warn; keys that stand twice
 * and values that cannot be are errors.
 */
void options_read(struct build *build, const struct rio_node *block, enum option_place place,
                  struct option_value *values, void *to);

/* Has its member a value, of the file or by default? */
bool option_is_given(const struct option_def *def, const void *from);
/* Is the value the default? */
bool option_is_preset(const struct option_def *def, const void *from);
/* The value as it would be written, without quotes; "" if there is none. room: for numbers. */
const char *option_text(const struct option_def *def, const void *from, char room[VALUE_TEXT_MAX]);
