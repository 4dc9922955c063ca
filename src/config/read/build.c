/* SPDX-License-Identifier: MIT */
/* Room in the arena of the configuration that is being made. */
#include <string.h>

#include "src/config/read/build.h"

const char *build_keep(struct build *build, const char *text, size_t len)
{
	const char *copy = arena_text(&build->box->arena, text, len);

	if (!copy)
		build->no_memory = true;
	return copy ? copy : "";
}

void *build_take(struct build *build, size_t count, size_t size)
{
	void *memory = arena_take(&build->box->arena, (count + 1) * size);

	if (!memory)
		build->no_memory = true;
	return memory;
}

bool build_part(const char **text, const char *separators, const char **part, size_t *len)
{
	size_t n;

	if (!*text)
		return false;
	*text += strspn(*text, " \t");
	n = strcspn(*text, separators);
	*part = *text;
	*text = (*text)[n] ? *text + n + 1 : NULL;
	while (n && strchr(" \t", (*part)[n - 1]))
		n--;
	*len = n;
	return true;
}
