/* SPDX-License-Identifier: MIT */
/*
 * The spool: batches that wait for the server as files of a directory, NUMBER.lines, the oldest
 * first. A file is whole: it is written and synced under another name. What the server refuses is
 * moved aside as NUMBER.refused. All functions block as a disk does.
 */
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "src/faces/influx/disk.h"

#define SPOOL_REFUSED 8 /* files that are kept; the oldest goes */
#define SPOOL_NAME 32

struct spool_file {
	uint64_t number;
	uint32_t size;
};
struct spool {
	const struct spool_disk *disk;
	int dir, lock; /* -1: not open */
	uint64_t limit, bytes, next;
	struct spool_file *files; /* the oldest first */
	size_t first, end, room;
	uint64_t refused[SPOOL_REFUSED]; /* numbers; 0: none */
	uint64_t dropped; /* bytes: the oldest batches, for which there was no room */
};

/*
 * Open the directory, make it if it is missing, lock it, and look what waits in it. limit: bytes of
 * all batches; a file counts as whole blocks of 4096. 0; -EBUSY: another program has it; or a
 * negative errno. Allocates.
 */
int spool_open(struct spool *spool, const char *path, uint64_t limit,
               const struct spool_disk *disk);
void spool_close(struct spool *spool);

/* Add a batch, and drop the oldest ones for it. 0: it is on the disk. Allocates. */
int spool_put(struct spool *spool, const char *data, size_t len);
size_t spool_count(const struct spool *spool);
/* Read the oldest batch. Returns its length or a negative errno; -EFBIG: it is none of ours. */
int64_t spool_read(struct spool *spool, char *data, size_t size);
/* The oldest batch is sent, or cannot be read: delete it. */
void spool_remove(struct spool *spool);
/* The server refuses a batch: put it aside; data NULL: the oldest one. It may fail. */
void spool_refuse(struct spool *spool, const char *data, size_t len);
/* The number of the oldest batch, 0: none waits; no other batch ever has it. */
uint64_t spool_oldest(const struct spool *spool);
/* The name of the oldest batch, for a message. */
void spool_name(const struct spool *spool, char name[SPOOL_NAME]);
