/* SPDX-License-Identifier: MIT */
/* Control programs: they set the relays, beat, die, and scribble. */
#pragma once

#include <stdbool.h>

struct generation;

void program_begin(void);
/* All programs join the engine of a generation; once it has taken over, the rest is freed. */
void program_join(struct generation *generation);
void program_moved(void);
void program_end(void);
/* Each second. It dies with the heartbeat, and what it set goes to SafeValue. */
void program_runs(void);
bool program_beats(void);
/* The relays, without a heartbeat. */
void program_sets(unsigned value);
void program_dies(void);
/* Everything that a program may write, and no program should; and sets it right. */
void program_scribbles(void);
