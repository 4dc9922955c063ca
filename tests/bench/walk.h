/* SPDX-License-Identifier: MIT */
/*
 * The walk of a new client through a server of owserver's protocol, over one kept connection, one
 * request at a time: look for the devices, list all their directories, read each property. It
 * knows nothing of the families: what a directory lists is read, and what cannot be read is
 * refused by the server. Of an array only .ALL and .BYTE are read, which have its elements; of a
 * memory with more than 512 bytes only the first page.
 *
 * All times are ns of wall clock. Each request waits a minute at the most.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#define WALK_PATH 128
#define WALK_MOST 8192 /* properties */

struct walk_property {
	char path[WALK_PATH]; /* "/28.0000000000A1/temperature" */
	int ret;              /* the length of the answer, or the server's refusal below 0 */
	int64_t ns;
};

struct walk {
	uint16_t port;
	int fd;
	unsigned devices, directories, properties;
	unsigned unlisted;    /* of the directories, which the server refused to list */
	char why[200];        /* the first of these, and the refusal */
	unsigned connections; /* 1: the server has kept the first one */
	int64_t scan_ns, list_ns, read_ns;
	struct walk_property property[WALK_MOST];
};

/* The answer of a server that is not there, or has ended the connection twice. */
#define WALK_NO_SERVER (-1000)

void walk_init(struct walk *walk, uint16_t port);
void walk_end(struct walk *walk);
/*
 * The names of the devices, separated by commas; fresh: by a search of the wire, past all caches.
 * Returns how many, or the server's refusal.
 */
int walk_scan(struct walk *walk, bool fresh, char *names, size_t size);
/* The properties of these devices, into property[]. */
void walk_list(struct walk *walk, const char *names);
/* Each property once. The one that ends the server is the last: properties is their number then. */
void walk_read(struct walk *walk);
/* One property. */
int walk_read_one(struct walk *walk, const char *path);
/*
 * A scenario with one of each simulated family, and with each board of other makers, on one chip;
 * returns how many.
 */
unsigned walk_scenario(FILE *file, unsigned khz);
