/* SPDX-License-Identifier: MIT */
/* Room in the arena of the configuration that is being made. */
#include "src/config/build.h"

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
