/* SPDX-License-Identifier: MIT */
/*
 * A recording of a bus: each call of its links, each exchange of its connection and each of its
 * answers is a line of text, a question and its answer. A bus can be opened on such a file in place
 * of a wire. owsctl(1) has the format.
 *
 *   trace.c      begun and ended; the exchanges of connections, the answers of a bus
 *   links.c      the calls of links
 *   i2c.c        the transactions of an I2C adapter
 *   lines.c      lines: written, and looked up
 *   anonymous.c  other ids in place of those of a recording
 *
 * Room hal/trace: recordings of buses: written, made anonymous, answered from.
 */
#pragma once

#include "hal/trace/recording.h"

/*
 * Record to file, which the caller closes: line by line, or if it is anonymous, at the end. i2c:
 * the transactions of the adapter of a DS2482 in place of the calls of its links. NULL: no memory.
 */
struct trace *trace_record(FILE *file, bool i2c, bool anonymous);
/* Replay a file. 0, -ENOMEM, or -EINVAL with the reason in why. */
int trace_replay(struct trace **trace, const char *name, char *why, size_t why_size);
/* Ends either. Returns how many lines a recording has, or an error: then the file has less. */
int trace_end(struct trace *trace);
/* How many links a replay has; of what else has it lines? */
unsigned trace_links(const struct trace *trace);
#define TRACE_ADAPTER " i2c: "
#define TRACE_SERVER " net: "
bool trace_has(const struct trace *trace, const char *what);
