/* SPDX-License-Identifier: MIT */
/* The state of an instance from what is seen of it, and the file that its command line names. */
#include <string.h>

#include "src/tool/owsctl/instance_state.h"

enum instance_state instance_state_of(bool has_image, uint32_t state, bool alive, int lock,
                                      bool process)
{
	bool held = lock < 0 ? process : lock > 0;

	if (!has_image)
		return held ? INSTANCE_HIDDEN : INSTANCE_LEFT;
	if (state == 3)
		return INSTANCE_STOPPED;
	/* a stopped heart shows after two seconds, a released lock at once */
	if (alive && lock != 0)
		return INSTANCE_RUNNING;
	return held ? INSTANCE_HANGS : INSTANCE_KILLED;
}

bool instance_is_up(enum instance_state state)
{
	return state == INSTANCE_RUNNING || state == INSTANCE_HANGS;
}

const char *instance_state_text(enum instance_state state)
{
	static const char *const texts[] = {
		[INSTANCE_RUNNING] = "running", [INSTANCE_HANGS] = "hangs",
		[INSTANCE_STOPPED] = "stopped", [INSTANCE_KILLED] = "killed",
		[INSTANCE_LEFT] = "remains",    [INSTANCE_HIDDEN] = "hidden",
	};

	return texts[state];
}

/*
 * The argument of -c in a word: "-cFILE" or "--config=FILE"; "" when the next word is the argument.
 */
static const char *option_in(const char *word)
{
	if (!strncmp(word, "--config", 8) && (!word[8] || word[8] == '='))
		return word[8] ? word + 9 : "";
	return !strncmp(word, "-c", 2) ? word + 2 : NULL;
}

const char *instance_config_of(const char *line, size_t len)
{
	const char *end = line + len, *found = NULL;

	if (!len || line[len - 1])
		return NULL;
	/* the last option counts, as for getopt */
	for (const char *word = line; word < end; word += strlen(word) + 1) {
		const char *value = word == line ? NULL : option_in(word);

		if (!value)
			continue;
		if (!*value) {
			word += strlen(word) + 1;
			if (word >= end)
				break;
			value = word;
		}
		found = value;
	}
	return found;
}
