/* SPDX-License-Identifier: MIT */
/*
 * The bytes of a body while they come, and until they are read. Few bodies may be large: there is
 * room for so many at a time. One thread, the loop of the face.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define POSTED_LARGE 2 /* large bodies at a time */
#define POSTED_S 60    /* so long a body may take to come, byte by byte */

struct posted {
	char *bytes; /* NULL: none, or they are dropped */
	size_t len, size;
	unsigned *large; /* counts large ones; NULL: this one is small */
	int64_t until_ns;
	bool dropped; /* it is counted and not kept: nobody may send it, or there is no room */
};

/* Before the body of so many bytes comes. large: how many large ones there are. */
void posted_begin(struct posted *posted, size_t size, unsigned *large, bool may, int64_t now_ns);
/* False: it is longer than was announced, comes too slowly, or there is no memory. */
bool posted_add(struct posted *posted, const char *bytes, size_t len, int64_t now_ns);
void posted_free(struct posted *posted);
