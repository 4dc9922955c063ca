/* SPDX-License-Identifier: MIT */
/* A control program: it sets the relays, beats, dies, and scribbles. */
#ifndef TESTS_ENDURANCE_PROGRAM_H
#define TESTS_ENDURANCE_PROGRAM_H

#include <stdbool.h>

void program_begin(void);
/* Each second. It dies with the heartbeat, and what it set goes to SafeValue. */
void program_runs(void);
bool program_beats(void);
/* The relays, without a heartbeat. */
void program_sets(unsigned value);
void program_dies(void);
/* Everything that a program may write, and no program should; and sets it right. */
void program_scribbles(void);

#endif
