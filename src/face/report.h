/* SPDX-License-Identifier: MIT */
/*
 * The report: a small file in which a face says how it does, for `owsctl stats`. It is
 * RUNTIME_DIRECTORY/status of a service, else OWS_DIR/INSTANCE.PROGRAM; without either there is
 * none. Lines of a word and its value: pid, beat (the boot time of the report, ns), status; what
 * face_ops.report writes: since (a boot time), trouble, count NAME NUMBER.
 */
#ifndef FACE_REPORT_H
#define FACE_REPORT_H

#include "src/face/face.h"

#define REPORT_NS (5 * NS_PER_S)

void report_open(struct face *face);
/* When it is due, or the status is another. It is replaced in one step; an error is not logged. */
void report_write(struct face *face, int64_t now_ns);
void report_remove(const struct face *face);

#endif
