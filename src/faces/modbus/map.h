/* SPDX-License-Identifier: MIT */
/*
 * Which place a signal has: kept by its identity, so that it stays when signals are added, removed,
 * sorted, renamed or their devices replaced. A place is never given to another signal. As a file:
 * lines of a place and an identity; what begins with # is a comment.
 */
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "src/faces/modbus/layout.h"

#define MAP_NO_SIGNAL (-1)

struct map {
	struct {
		char *identity; /* NULL: the place is free */
		int signal;     /* by the index of ows_info(), or MAP_NO_SIGNAL */
	} places[LAYOUT_PLACES];
	unsigned last; /* the highest place that is not free; 0: none */
	/* The places by the hashes of their identities, at the next that is free; 0: none */
	uint16_t by_hash[2 * LAYOUT_PLACES];
};

/*
 * Take the places of a file. What the map has already wins. 0; a negative errno: the file cannot be
 * read, -ENOTSUP: it is a pipe or the like, -EINVAL: it is none of places; *line says where, from
 * 1.
 */
int map_read(struct map *map, const char *path, unsigned *line);
/* A line of it. 0, -EINVAL or -ENOMEM. Pure. */
int map_take(struct map *map, char *line);
/* Replace the file. 0 or a negative errno. */
int map_write(const struct map *map, const char *path);

/* The place of the identity; 0: it has none. Pure. */
unsigned map_known(const struct map *map, const char *identity);
/* The place of the identity, after all others if it has none. -ENOSPC, -ENOMEM. Pure. */
int map_place(struct map *map, const char *identity);
/* Take what another map has besides, at places that are free here. */
void map_join(struct map *map, const struct map *other);
void map_free(struct map *map);

#define MAP_PATH 264
/* Where the service, or this user, keeps that of the instance. -ENAMETOOLONG. */
int map_path(const char *instance, char path[MAP_PATH]);
/* Where a reader finds it: that of this user, or if that is missing of the service. */
int map_path_found(const char *instance, char path[MAP_PATH]);
