/* SPDX-License-Identifier: MIT */
/* Rows and gaps of a signal, as its steps. */
#pragma once

#include "src/history/library/handle.h"

/*
 * A row with the columns id, value, quality, reason of a gap. What a signal had before its type
 * changed counts. 0 or -ENOMEM. Free the text.
 */
int steps_take(sqlite3_stmt *from, const struct known_signal *signal, struct step *step);
/* The index of the signal that has this number in the file; -1: none. */
int handle_signal(const struct ows_history *h, int64_t number);
/* What held at an id: 1; 0: nothing is known of it. Free the text. */
int handle_held(struct ows_history *h, const struct known_signal *signal, int64_t id,
                struct step *step);
/* The steps of a signal from an id on, before end: as many as there is room for. Free the texts. */
int handle_steps(struct ows_history *h, const struct known_signal *signal, int64_t first,
                 int64_t end, struct step *steps, int room);
