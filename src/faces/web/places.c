/* SPDX-License-Identifier: MIT */
/* Keeps the map of owsd-modbus, and reads it again when the file is another. */
#include <sys/stat.h>

#include "src/faces/web/places.h"

const struct map *places_of(const char *instance)
{
	char path[MAP_PATH];

	return map_path_found(instance, path) ? NULL : places_at(path);
}

const struct map *places_at(const char *path)
{
	static struct map map;
	static struct stat was;
	static bool right;
	struct stat is;
	unsigned line;

	if (stat(path, &is))
		return NULL;
	if (is.st_ino == was.st_ino && is.st_mtim.tv_sec == was.st_mtim.tv_sec &&
	    is.st_mtim.tv_nsec == was.st_mtim.tv_nsec)
		return right ? &map : NULL;
	was = is;
	map_free(&map);
	right = !map_read(&map, path, &line);
	return right ? &map : NULL;
}

int places_register(const struct map *map, const char *identity)
{
	unsigned place = map ? map_known(map, identity) : 0;

	return place ? (int)(place * LAYOUT_RECORD) : -1;
}
