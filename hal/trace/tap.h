/* SPDX-License-Identifier: MIT */
/* A recording, or a replay, begun and ended. */
#pragma once

#include "hal/trace/trace.h"

/* Record to file, which the caller closes. i2c: the transactions of the adapter of a DS2482. */
void trace_record(struct trace *trace, FILE *file, bool i2c);
/* Replay a file. As trace_read(). */
int trace_replay(struct trace *trace, const char *name, char *why, size_t why_size);
/* Ends either; of a recording, what is begun is written first. */
void trace_end(struct trace *trace);
