/* SPDX-License-Identifier: MIT */
#include "hal/owserver/path.h"

#include <ctype.h>
#include <string.h>

static const char *const not_devices[] = {
	"settings", "statistics", "system", "structure", "simultaneous", "interface",
};

static bool is_word(const char *name, size_t len, const char *word)
{
	return strlen(word) == len && memcmp(name, word, len) == 0;
}

static bool is_prefix(const char *name, size_t len)
{
	return is_word(name, len, "uncached") || is_word(name, len, "alarm") ||
	       (len > 4 && memcmp(name, "bus.", 4) == 0);
}

static bool is_branch(const char *name, size_t len)
{
	return is_word(name, len, "main") || is_word(name, len, "aux");
}

/* The component after `at`; false at the end. */
static bool next_part(const char *path, size_t len, size_t at, struct path_part *part)
{
	while (at < len && path[at] == '/')
		at++;
	part->at = at;
	while (at < len && path[at] != '/')
		at++;
	part->len = at - part->at;
	return part->len > 0;
}

bool path_device(const char *path, size_t len, struct path_part *part)
{
	struct path_part branch, below;
	size_t at = 0;

	do {
		if (!next_part(path, len, at, part))
			return false;
		at = part->at + part->len;
	} while (is_prefix(path + part->at, part->len));
	for (size_t i = 0; i < sizeof(not_devices) / sizeof(not_devices[0]); i++)
		if (is_word(path + part->at, part->len, not_devices[i]))
			return false;
	while (next_part(path, len, part->at + part->len, &branch) &&
	       is_branch(path + branch.at, branch.len) &&
	       next_part(path, len, branch.at + branch.len, &below))
		*part = below;
	return true;
}

bool path_is_rom_name(const char *name, size_t len)
{
	if (len != 15 || name[2] != '.')
		return false;
	for (size_t i = 0; i < len; i++)
		if (i != 2 && !isxdigit((unsigned char)name[i]))
			return false;
	return true;
}
