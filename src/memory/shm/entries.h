/* SPDX-License-Identifier: MIT */
/*
 * The entries of the image that change as a whole, writer's side: origins, controllers, shelves,
 * devices, the log, and the journals of alarms and of commands. Sequence and check words are set
 * here. No system calls. One thread.
 */
#pragma once

#include "src/memory/shm/image.h"

/* The origin of the command in force for a record. */
void image_origin(struct image *image, uint32_t record, const struct ows_origin_entry *entry);
/* The controller of a place below OWS_CONTROLLERS. */
void image_controller(struct image *image, uint32_t place,
                      const struct ows_controller_entry *entry);
/* The shelved alarm of a place below OWS_SHELVES. */
void image_shelf(struct image *image, uint32_t place, const struct ows_shelf_entry *entry);

/* The device of a place, but for its id and family, which stay. */
void image_device(struct image *image, uint32_t place, const struct ows_device_entry *entry);

/* A line of the log, cut to the room for it; the number is set here, after that of the last. */
void image_log(struct image *image, int64_t time_ns, uint32_t level, const char *text, size_t len);
/* A reload was refused, and why; counted here. */
void image_refused(struct image *image, int64_t time_ns, bool restart, const char *why, size_t len);
/* What is to be said of a target since time_ns; "": nothing. */
void image_note(struct image *image, uint32_t target, int64_t time_ns, const char *text);
/* Continue the log of the previous image in this one, with its numbers. */
void image_carry_log(struct image *image, const struct image *before);

/*
 * Enter an alarm into its journal; the number is set here. Returns it, with which
 * image_alarm_after() adds the value after the alarm; once the ring has lost the entry, that does
 * nothing.
 */
uint32_t image_alarm(struct image *image, const struct ows_journal_entry *entry);
void image_alarm_after(struct image *image, uint32_t number, int64_t after);
/* Enter a command into its journal; returns its number. */
uint32_t image_command(struct image *image, const struct ows_journal_entry *entry);
/*
 * Continue both journals of the previous image in this one, with their numbers: record r of the
 * previous image is records[r - 1] + 1 here; where that is 0xffffffff, the record and its entries
 * are gone.
 */
void image_carry_journals(struct image *image, const struct image *before, const uint32_t *records);
