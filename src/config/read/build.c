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

const char *text_is_short(const char *text)
{
	return strlen(text) <= TEXT_KEY_MAX ? NULL : "expected at most 255 bytes";
}

const char *text_is_path(const char *text)
{
	return text[0] == '/' && strlen(text) <= TEXT_KEY_MAX
	               ? NULL
	               : "expected a path from the root, at most 255 bytes";
}

const char *text_is_file(const char *text)
{
	if (strlen(text) <= TEXT_KEY_MAX &&
	    (text[0] == '/' || (!text[strspn(text, TEXT_KEY_LETTERS)] && text[0] != '.')))
		return NULL;
	return "expected a path from the root, or the name of a credential";
}

const char *text_is_name(const char *text)
{
	return strspn(text, TEXT_KEY_LETTERS) == strlen(text) && strlen(text) <= TEXT_KEY_NAME
	               ? NULL
	               : "expected letters, digits, '-', '_' and '.', at most 63";
}

const char *text_key(struct build *build, const struct option_value *values, enum option option,
                     text_check *check)
{
	const struct option_value *value = &values[option];
	const char *key = option_table[option].key, *why;

	if (!value->given || !*value->text)
		return option_table[option].preset;
	why = check ? check(value->text) : NULL;
	if (why && strpbrk(value->text, "@?")) /* as in a URL with a password */
		report_error(build->report, value->node->value_at, "%s: %s", key, why);
	else if (why)
		report_error(build->report, value->node->value_at, "%s \"%s\": %s", key,
		             value->text, why);
	return build_keep(build, value->text, strlen(value->text));
}
