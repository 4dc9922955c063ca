/* SPDX-License-Identifier: MIT */
/* The map of places, and its file. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "hal/base/file.h"
#include "src/faces/modbus/map.h"
#include "src/ground/signal/hash.h"
#include "src/history/file/place.h"

#define PROGRAM "owsd-modbus"
#define WHAT "modbus"
#define FILE_MOST (LAYOUT_PLACES * 1024)
#define IDENTITY_MOST 500

#define HASHES (sizeof(((struct map *)0)->by_hash) / sizeof(uint16_t))

/* Where the place of the identity stands in by_hash, or is to stand. */
static size_t find(const struct map *map, const char *identity)
{
	size_t at = hash_text(HASH_BEGIN, identity, strlen(identity)) % HASHES;

	while (map->by_hash[at] && strcmp(map->places[map->by_hash[at]].identity, identity) != 0)
		at = (at + 1) % HASHES;
	return at;
}

static int map_put(struct map *map, unsigned place, const char *identity)
{
	char *copy = strdup(identity);

	if (!copy)
		return -ENOMEM;
	map->by_hash[find(map, identity)] = (uint16_t)place;
	map->places[place].identity = copy;
	map->places[place].signal = MAP_NO_SIGNAL;
	if (place > map->last)
		map->last = place;
	return 0;
}

unsigned map_known(const struct map *map, const char *identity)
{
	return map->by_hash[find(map, identity)];
}

int map_take(struct map *map, char *line)
{
	unsigned long place;
	char *identity;

	line[strcspn(line, "\r\n")] = '\0';
	if (!*line || *line == '#')
		return 0;
	place = strtoul(line, &identity, 10);
	if (*line < '0' || *line > '9' || place < 1 || place >= LAYOUT_PLACES ||
	    (*identity != ' ' && *identity != '\t'))
		return -EINVAL;
	identity += strspn(identity, " \t");
	if (*identity != '/' || strlen(identity) > IDENTITY_MOST)
		return -EINVAL;
	/* it goes into files of other programs */
	for (const char *c = identity; *c; c++)
		if (((unsigned char)*c < ' ' && *c != '\t') || *c == 0x7f)
			return -EINVAL;
	if (map->places[place].identity || map_known(map, identity))
		return 0;
	return map_put(map, (unsigned)place, identity);
}

int map_read(struct map *map, const char *path, unsigned *line)
{
	char why[100], *rest, *text, *one;
	int err;

	*line = 0;
	text = rest = file_text(path, FILE_MOST, &err, why, sizeof(why));
	/* -EINVAL is that of a line */
	if (!text)
		return err == -EINVAL ? -ENOTSUP : err;
	while (!err && (one = strsep(&rest, "\n"))) {
		++*line;
		err = map_take(map, one);
	}
	free(text);
	return err;
}

int map_write(const struct map *map, const char *path)
{
	char fresh[HISTORY_PATH + 32];
	int err = 0;
	FILE *out;

	if (snprintf(fresh, sizeof(fresh), "%s.new", path) >= (int)sizeof(fresh))
		return -ENAMETOOLONG;
	out = fopen(fresh, "we");
	if (!out)
		return -errno;
	fputs("# Places of owsd-modbus: owsctl modbus-map shows them. A place is never used again\n",
	      out);
	for (unsigned i = 1; i <= map->last; i++)
		if (map->places[i].identity)
			fprintf(out, "%u %s\n", i, map->places[i].identity);
	/* a power cut must leave the one or the other */
	if (fflush(out) || fsync(fileno(out)))
		err = -errno;
	/* a line before the last may be missing though there is room again */
	if (ferror(out) && !err)
		err = -EIO;
	if (fclose(out) && !err)
		err = -errno;
	if (!err && rename(fresh, path))
		err = -errno;
	if (err)
		unlink(fresh);
	return err;
}

int map_place(struct map *map, const char *identity)
{
	unsigned place = map_known(map, identity);
	int err;

	if (place)
		return (int)place;
	place = map->last + 1;
	if (place >= LAYOUT_PLACES)
		return -ENOSPC;
	err = map_put(map, place, identity);
	return err ? err : (int)place;
}

void map_join(struct map *map, const struct map *other)
{
	for (unsigned i = 1; i <= other->last; i++) {
		const char *identity = other->places[i].identity;

		if (identity && !map->places[i].identity && !map_known(map, identity))
			map_put(map, i, identity);
	}
}

void map_free(struct map *map)
{
	for (unsigned i = 1; i <= map->last; i++)
		free(map->places[i].identity);
	*map = (struct map){0};
}

static int in_directory(int err, const char *directory, char path[MAP_PATH])
{
	if (!err)
		snprintf(path, MAP_PATH, "%s/map", directory);
	return err;
}

int map_path(const char *instance, char path[MAP_PATH])
{
	char directory[HISTORY_PATH];

	return in_directory(history_place_state(PROGRAM, WHAT, instance, directory), directory,
	                    path);
}

int map_path_found(const char *instance, char path[MAP_PATH])
{
	char directory[HISTORY_PATH];

	return in_directory(history_place_state_found(PROGRAM, WHAT, instance, directory),
	                    directory, path);
}
