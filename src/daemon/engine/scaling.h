/* SPDX-License-Identifier: MIT */
/*
 * The raw values of a signal: what was read becomes its value, what it commands becomes what is
 * written. The rest of the engine knows engineering values only. Not of strings.
 */
#pragma once

#include "src/daemon/engine/table.h"

struct slot;

/* The type that a raw value is read as: that of the signal, or double where a scale makes it. */
enum ows_type signal_raw_type(const struct signal *s);

/*
 * The sample's value of a raw value (of signal_raw_type()) that was measured at that time: scaled,
 * judged by the range, filtered, rounded to the type. *quality: what reading it found; good, it
 * becomes what scale and range say. Returns 0; -EREMCHG: it jumps: the sample is unchanged.
 */
int signal_scale_raw(struct signal *s, int64_t raw, int64_t measured_ns, uint8_t *quality);

/* May it be commanded: does it fit the type, lie in the range, and have a raw value? */
bool signal_accepts(const struct signal *s, int64_t value);
/* Have the slot's request write a value that the signal accepts; text: that of a string. */
void signal_write(struct slot *slot, const struct signal *s, int64_t value, const char *text,
                  size_t len);
/* The value was written: the sample has it, unless it is doubted that the device has. */
void signal_written(struct signal *s, int64_t value);
/*
 * Has the output that was read the raw value that was written last? Then its value is that of the
 * command and good, though no raw value may give exactly that.
 */
bool signal_reads_as_written(struct signal *s, uint8_t *quality);

/* A reload has copied s from was, and may have given it another scale. */
void signal_rescale(struct signal *s, const struct signal *was);
