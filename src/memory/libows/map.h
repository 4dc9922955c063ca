/* SPDX-License-Identifier: MIT */
/*
 * The image of an owsd: found by name, mapped, and checked before anything of it is used.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "src/public/ows.h"

struct ows_map;
struct ows_record;

/* path: of the directory. */
int map_open(const char *path, const char *instance, struct ows_map *map);
void map_close(struct ows_map *map);
/* The string at an offset of the image; "" for an offset outside the strings. */
const char *map_string(const struct ows_map *map, uint32_t off);
const char *map_name(const struct ows_map *map, uint32_t record);
/* Do the texts of a record lie where texts are? */
bool map_has_text(const struct ows_map *map, const struct ows_record *record);
/* Record of a signal's name, -1 if there is none; as attribute_find, map is a struct ows_map. */
int map_find(void *map, const char *name, size_t len);
/* Does the name lead to another file than the mapped one? One system call. */
bool map_is_elsewhere(const struct ows_map *map, const char *dir, const char *instance);
