/* SPDX-License-Identifier: MIT */
/* Entries of the journal that owsd-recorder has on disk, put before those of owsd's memory. */
#pragma once

#include "src/faces/show/journal_entry.h"
#include "src/public/ows_history.h"

/*
 * Read the entries from from_ns on, before until_ns (wall clock), into *past, at most the last
 * `most` of them: oldest first, in the order of time, those of earlier boots of the machine in
 * front. 0, or a negative
 * errno of libows-history. Names are valid until the history is refreshed or
 * closed.
 */
int journal_past(struct ows_history *history, const struct when *now, int64_t from_ns,
                 int64_t until_ns, char *const *patterns, int count, unsigned most,
                 struct journal_entries *past);

/*
 * Drop from *past what is among `entries` too. The disk has times in whole milliseconds and no
 * numbers of entries, so an entry is the same if boot time, signal and what happened are; and of
 * several of these the newest are. false: no memory.
 */
bool journal_past_drop(struct journal_entries *past, const struct journal_entries *entries);
