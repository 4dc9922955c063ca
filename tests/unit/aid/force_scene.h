/* SPDX-License-Identifier: MIT */
/*
 * A scene for tests of the command in force: one output of each kind, all of one device, and a
 * controller that has set all of them.
 */
#pragma once

#include "tests/unit/aid/scene.h"

extern struct scene s;

/* Records 1 to 8: bit 0 has InitValue, bit 1 SafeValue, bit 2 Start "last". */
#define OUTPUTS 8
#define BEAT_MS 500
#define INIT 10
#define SAFE 20
#define NEXT 30 /* what the controller set */
#define OTHER 40

/* What an output of a kind has to have in the end; NOTHING: owsd writes nothing to it. */
enum { NOTHING = -1 };

/* A row of the table: without and with InitValue, SafeValue, both; the same with Start "last". */
struct row {
	int plain, init, safe, both, last, last_init, last_safe, last_both;
};

/* The outputs as the configuration has them, with a target that is up. */
void start_outputs(void);
void set_all(unsigned seat, int64_t value);
/* These writes, each once at most, since the trace was cleared. */
void expect_outputs(struct row row);
extern const struct row nothing, command, ended, lost, lost_running;

/* A controller at seat 1 with token 2 has set all; it promises a beat or not. */
void controller_set_all(bool beats);
/* owsd is killed, or ends in order: for the next one that is the same. */
void restart_owsd(void);
/* The controller connects again by its token, and beats, as ows_reopen() does. */
void come_back(void);
void beat_on(int64_t ns);
