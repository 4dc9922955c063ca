/* SPDX-License-Identifier: MIT */
/*
 * A stretch of owsd's life on the rig, in real time: what the endurance program knows and checks.
 * It tells the simulated chips what to measure, so it knows which values can be true.
 */
#pragma once

#include <stdbool.h>
#include <stdint.h>
#include <sys/types.h>

#include "src/public/ows.h"

#define SECOND INT64_C(1000000000)
#define STALE_AFTER (30 * SECOND) /* of the items in endurance.rio */

enum { WARM, COLD, FAR, AIR, PINS, INPUTS, RELAYS = INPUTS, SIGNALS };
extern const char *const signal_names[SIGNALS];

/* --- Results: lines as the rig counts them --- */
void passed(const char *form, ...) __attribute__((format(printf, 1, 2)));
/* False: so many were in this episode that it is not shown. */
bool violated(const char *form, ...) __attribute__((format(printf, 1, 2)));
void remark(const char *form, ...) __attribute__((format(printf, 1, 2)));

/* --- What is true: which values the inputs had when --- */
/* Tell the chip another value of that input; which, is its own matter. */
void truth_change(int input);
/* The pins that the control program drives low from now on. */
void truth_relays(unsigned pins);
/* Could it be measured between these moments? */
bool truth_between(int input, double value, int64_t from_ns, int64_t until_ns);
/* Is it what is there now? */
bool truth_now(int input, double value);
/* Remarks: what it was lately. */
void truth_explain(int input);
/* An event of the scenario language; false: refused. */
bool sim_tell(const char *event);

/* --- The daemon --- */
void daemon_start(void);
void daemon_signal(int number);
/* As child_end() */
int daemon_end(void);
/* Exchange its file for the other one and have it read. */
void daemon_reload(void);
bool daemon_lives(void);
pid_t daemon_pid(void);

/* --- Programs: owsd, and all that are beside it --- */
/* In the child, which returns 0: its output goes there. */
pid_t child(int output);
/* After a signal that ends it: wait, at most 60 s. Status as of waitpid(), -1: it does not end. */
int child_end(pid_t pid);

/* What a process that is well holds; samples is 0 at its start. */
struct life {
	long memory_most;
	int descriptors;
	unsigned samples;
};

/* --- The faces: one table of programs, and of genuine clients that ask each again and again */
void faces_start(void);
/* See to those that run, and ask; a good value that a client is told has to be true. */
void faces_step(void);
/* Ask none from now on, or ask again. No client is there now. */
bool faces_rest(bool rest);
/* All that show what is there now have told a good value to who asked since then. */
bool faces_tell(int64_t since_ns);
/* One of them has told each who asked since then a good value, or nobody has asked; NULL: none. */
const char *faces_good(int64_t since_ns);
/* What happens to one after another. */
void faces_kill(void);
void faces_stop(void);
/* Of each that is ours. */
void faces_each(void (*hold)(const char *name, pid_t pid, struct life *life));
/* Each ends when it is told to, and each client was told something. */
void faces_end(void);

/* --- The control program and reader --- */
/* Wait for the table, at most 60 s. */
bool reader_open(void);
/* One look at all signals: every good value must be true. */
void reader_look(void);
/* owsd stood still until now. */
void reader_stood(void);
/* All good, of now, and the output done. */
bool reader_all_well(void);
/* A signal that is good although nothing can be; -1: none. */
int reader_any_good(void);
void reader_set_relays(unsigned pins);
/* What owsd counts is in order. */
void reader_counters(void);
uint64_t reader_looks(void);
uint64_t reader_checked(void);
/* Which signals are not good, and why. */
void reader_explain(void);
