/* SPDX-License-Identifier: MIT */
/*
 * What owsd-recorder takes from the file: the Recorder block, and the key Record of an item. owsd
 * checks both and uses neither.
 *
 *     Record "change"                       each change of the value: the default
 *     Record "deadband 0.1"                 a change by more than 0.1 since the last record
 *     Record "interval 60"                  the newest value each minute
 *     Record "deadband 0.1, interval 600"   on both occasions; the parts may be in any order
 *     Record "change, raw"                  the raw value too
 *     Record "off"                          nothing of this signal
 */
#pragma once

#include "src/config/read/build.h"

/* The longest text of a Record. */
#define RECORD_TEXT_MAX 127

/*
 * Read the text of a Record. Returns 0, or -EINVAL with the reason in why, a whole clause such as
 * "expected change, deadband NUMBER, ...". Pure.
 */
int record_parse(const char *text, struct config_record *record, char *why, size_t size);

block_derive recorder_derive;
/* The Record of an item; known: its type is known. */
void record_build(struct build *build, const struct option_value *value, bool known,
                  struct config_item *item);

/*
 * The rule of a signal: its own, else that of the Recorder block. A deadband of the block counts as
 * "change" for a bool and a string, which have no distance. Pure.
 */
struct config_record config_record_of(const struct config *config, const struct config_item *item);
