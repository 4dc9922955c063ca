/* SPDX-License-Identifier: MIT */
/*
 * What all verbs of owsctl need. A verb gets the words after its name with its own name as argv[0],
 * and returns the exit status.
 *
 * Room src/tool/owsctl: the command-line tool, a program over libows; scan, read and write open a
 * target themselves.
 */
#pragma once

#include <stdbool.h>
#include <stdio.h>

#include "src/public/ows.h"

enum ctl_status {
	CTL_DONE = 0,
	CTL_FAILED = 1,
	CTL_USAGE = 2,
	CTL_NOT_GOOD = 3, /* a value is not good */
	CTL_NOTHING = 4,  /* a scan found nothing */
};

struct verb;
struct tap;
struct ctl {
	const char *instance;
	bool named;         /* the user gave the instance with -n */
	const char *target; /* the target of -t; NULL: none was given */
	bool json;
	int64_t until_ns;        /* of scan --within, CLOCK_BOOTTIME; 0: no limit */
	const struct verb *verb; /* the verb that runs */
	struct tap *tap;         /* of record: it sees what a target does */
	const struct verb *(*find)(const char *name); /* a verb; NULL: there is none */
};

struct verb {
	const char *name;
	const char *usage; /* what follows the name: "NAME..." */
	const char *brief; /* one line for the list of verbs */
	int (*run)(struct ctl *ctl, int argc, char **argv);
	const char *options; /* a line for each option and sub-verb, indented by two; NULL: none */
	const char *example; /* a whole use, without the word owsctl in front */
	bool finds;          /* without -n the one instance that runs is taken */
	bool opens;  /* the verb opens a target itself, without owsd, and has the option -t */
	bool writes; /* and writes to it */
};

/*
 * The next option as getopt(); options that begin with '+' stop at the first word that is none.
 * ctl_option() handles --json, and -t for verbs that open a target; --all means -a where the verb
 * has -a; -h prints the usage and ends the verb, and so does a wrong option, with the reason.
 * After -1 the operands are argv[optind] and up. To read other words, set optind to 0 before.
 */
struct when;
int ctl_option(struct ctl *ctl, int argc, char **argv, const char *options);
/*
 * The moment in optarg, by when_moment(). Ends the verb if it is none, and names the option c as
 * the user gave it: -s or --since.
 */
int64_t ctl_moment(const struct ctl *ctl, int c, const struct when *now);
/* The seconds in optarg, the argument of the option c. Ends the verb if they are none. */
int64_t ctl_option_seconds(const struct ctl *ctl, int c);

/* Print what a verb takes: at most a screen. */
void ctl_help(const struct verb *verb, FILE *out);

/*
 * Print on stderr, after "owsctl: ", made printable: a text may have bytes from elsewhere. Returns
 * the status.
 */
int ctl_say(int status, const char *format, ...) __attribute__((format(printf, 2, 3)));
#define ctl_tell(...) ctl_say(CTL_DONE, __VA_ARGS__)
#define ctl_fail(...) ctl_say(CTL_FAILED, __VA_ARGS__)
/* The same, and after it the usage of the verb. Returns CTL_USAGE. */
int ctl_usage(const struct ctl *ctl, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* As config_report.line (src/config): prints errors; where ctx is not NULL, warnings too. */
void ctl_report(void *ctx, bool is_error, const char *message);

/* Run ctl->verb with these words, its own name first. Returns the exit status. */
int ctl_run(struct ctl *ctl, int argc, char **argv);
/* End the verb that runs: ctl_run() returns that status. What the verb has open stays so. */
_Noreturn void ctl_end(int status);
/* Memory that was allocated; without it the verb ends. */
void *ctl_need(void *memory);

/* The word as a message shows it: an empty word as "". */
const char *ctl_word(const char *word);
#define CTL_NO_TARGET "-t: a target expected, as localhost:4304, i2c:/dev/i2c-1 or w1"

/* Parse a number of seconds, at most a year; false: the text is none. */
bool ctl_seconds(const char *text, int64_t *ns);
/* Parse a whole number from least to most; false: the text is none. */
bool ctl_count(const char *text, int64_t least, int64_t most, int64_t *count);

/* Open the instance. If that fails, prints why and ends the verb. */
struct ows *ctl_open(const struct ctl *ctl, enum ows_mode mode);
/* The same, as a program of another name than owsctl. */
struct ows *ctl_open_as(const struct ctl *ctl, enum ows_mode mode, const char *program);
/* Returns whether owsd runs; prints "owsd is not running ..." on stderr when it does not. */
bool ctl_alive(const struct ctl *ctl, struct ows *h, int64_t now_ns);
/* Prints on stderr why owsd refused the last reload, if it did: its file is not what it serves. */
void ctl_refused(const struct ctl *ctl, struct ows *h, int64_t now_ns);
/* The time between two looks for a new owsd. */
void ctl_nap(void);
/* As ows_wait(), and looks for a new owsd when the present one is gone. */
void ctl_sleep(struct ows *h, uint32_t *news, int64_t timeout_ns);
/* Print that there is no such name, with the nearest name; returns CTL_FAILED. */
int ctl_unknown(struct ows *h, const char *name);
/*
 * Print the bytes of a value, CTL_VALUE at most, on a line: a program gets them as they are, a
 * terminal without control characters.
 */
#define CTL_VALUE 65536
void ctl_value(const char *text, size_t len);
/* Has the reader of stdout closed its end? */
bool ctl_reader_gone(void);
/*
 * Flush stdout. Returns CTL_FAILED after printing why, else status. A reader that left is no error.
 */
int ctl_flush(int status);
/* Write at once what is printed so far; false: writing failed, which ctl_flush() reports. */
bool ctl_flush_lines(void);
