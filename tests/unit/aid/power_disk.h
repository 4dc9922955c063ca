/* SPDX-License-Identifier: MIT */
/*
 * A disk of history that writes to a directory, notes each call, and fails on demand; and what a
 * power cut leaves of the noted calls. Data that was not synced may be there, or not, or some
 * sectors of it, in any order; names stay in their order up to some point.
 */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "src/faces/influx/disk.h"

#define POWER_OPS 4096
#define POWER_FILES 64
#define POWER_SECTOR 512

struct power_op {
	enum {
		POWER_CREATE,
		POWER_WRITE,
		POWER_SYNC,
		POWER_TRUNCATE,
		POWER_RENAME,
		POWER_UNLINK,
		POWER_SYNC_NAMES
	} what;
	int file; /* the same over a rename */
	uint64_t at;
	size_t size;
	uint8_t *data;
	char name[64]; /* CREATE, RENAME: the new one */
};
struct power_disk {
	struct spool_disk disk; /* to give to the writer */
	struct power_op ops[POWER_OPS];
	int count;
	char names[POWER_FILES][64]; /* now; "" none */
	int files;
	struct {
		int fd, file; /* file -1: a directory */
	} open[POWER_FILES];
	/* Failures: after so many more writes (-1: never) each write and sync returns this. */
	int fail_after, fail_with;
	bool fail_open;
	int fail_read; /* reads of this page of a file, from 1, return -EIO; 0: none */
	/* After so many more reads (-1: never) each returns this; 0: nothing is there. */
	int fail_reads_after, fail_reads_with;
	int64_t free; /* bytes, or a negative errno */
};
void power_init(struct power_disk *power);
/* Take the files of a directory as written and synced. Returns the number of operations. */
int power_take(struct power_disk *power, const char *from);
void power_free(struct power_disk *power);
/*
 * Make directory `to` (emptied) as a power cut before op number `cut` may leave it; *seed decides.
 */
void power_cut(const struct power_disk *power, int cut, uint64_t *seed, const char *to);
/* Deterministic numbers (xorshift). */
uint64_t power_random(uint64_t *seed);
