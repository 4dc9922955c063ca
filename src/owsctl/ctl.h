/* SPDX-License-Identifier: MIT */
/*
 * What all verbs of owsctl need. A verb gets the words after its name with its own name as argv[0],
 * and returns the exit status.
 */
#ifndef OWSCTL_CTL_H
#define OWSCTL_CTL_H

#include <stdbool.h>

#include "src/libows/ows.h"

enum ctl_status {
	CTL_DONE = 0,
	CTL_FAILED = 1,
	CTL_USAGE = 2,
	CTL_NOT_GOOD = 3, /* a value is not good */
	CTL_NOTHING = 4,  /* a scan found nothing */
};

struct verb;
struct ctl {
	const char *instance;
	bool named;         /* -n: the instance was given */
	const char *target; /* -t; NULL: none given */
	bool json;
	const struct verb *verb; /* the one in work */
};

struct verb {
	const char *name;
	const char *usage; /* behind the name: "NAME..." */
	const char *brief; /* one line for the list of verbs */
	int (*run)(struct ctl *ctl, int argc, char **argv);
	bool opens; /* a target itself, without owsd: knows -t */
};

/*
 * The next option as getopt(); options that begin with '+' stop at the first word that is none.
 * --json is taken, and -t by verbs that open a target; --all means -a where there is one; -h prints
 * the usage and ends the program. '?' : it was wrong and this has been said; return CTL_USAGE.
 * Operands are argv[optind] and up once -1 was returned. ctl_options() starts anew.
 */
void ctl_options(void);
int ctl_option(struct ctl *ctl, int argc, char **argv, const char *options);

/* Say what is wrong on stderr. */
int ctl_usage(const struct ctl *ctl, const char *format, ...) /* returns CTL_USAGE */
	__attribute__((format(printf, 2, 3)));
int ctl_fail(const char *format, ...) /* returns CTL_FAILED */
	__attribute__((format(printf, 1, 2)));

int ctl_nothing(const char *format, ...) /* returns CTL_NOTHING */
	__attribute__((format(printf, 1, 2)));

/* The word as a message shows it: an empty one by its quotes. */
const char *ctl_word(const char *word);
#define CTL_NO_TARGET "-t: a target expected, as localhost:4304, i2c:/dev/i2c-1 or w1"

/* A number of seconds, at most a year; false when text is none. */
bool ctl_seconds(const char *text, int64_t *ns);

/* Open the instance; CTL_DONE, or CTL_FAILED after having said why. */
int ctl_open(const struct ctl *ctl, enum ows_mode mode, struct ows **h);
/* "owsd is not running ..." on stderr when it is not; returns whether it runs. */
bool ctl_alive(const struct ctl *ctl, struct ows *h, int64_t now_ns);
/* Between two looks for a new owsd. */
void ctl_nap(void);
/* ows_wait(), and look for a new owsd where the present one is gone. */
void ctl_sleep(struct ows *h, uint32_t *news, int64_t timeout_ns);
/* No such name: says so with the nearest there is; returns CTL_FAILED. */
int ctl_unknown(struct ows *h, const char *name);
/* Nobody reads stdout any more. */
bool ctl_reader_gone(void);
/* Write what is left; CTL_FAILED after having said why, else status. No reader is no error. */
int ctl_flush(int status);
/* What is printed so far, at once; false: it cannot be written, which ctl_flush() will say. */
bool ctl_flush_lines(void);

#endif
