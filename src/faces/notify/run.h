/* SPDX-License-Identifier: MIT */
/* A program that is given a text, beside the loop of the face: begun, looked at, killed late. */
#pragma once

#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

#define RUN_WORDS 160

struct run {
	pid_t pid; /* 0: none runs */
	int words; /* a file in memory with what it says */
	int64_t until_ns;
};

/*
 * May the program be run? Whoever may edit the configuration names it, so it belongs to root or to
 * the user of this process, and nobody else may write it. 0 or a negative errno; -EPERM: not so.
 */
int run_check(const char *path);
/* What the errno of these functions means, and what to do. */
const char *run_why(int err);
/*
 * Begin, if run_check() lets it. argv[0] is its path; no shell reads the rest. input: on its stdin.
 * more: up to four variables of its environment, ending with NULL, beside those of this program.
 * 0 or a negative errno.
 */
int run_begin(struct run *run, const char *const *argv, const char *input, size_t len,
              const char *const *more);
/*
 * Has it ended? 0: with 0; -EINPROGRESS: no; else it failed: why has its last words, or how it
 * ended. After a minute, or a megabyte of words, it is killed, with what it started.
 */
int run_step(struct run *run, int64_t now_ns, char why[RUN_WORDS]);
void run_kill(struct run *run);
