/* SPDX-License-Identifier: MIT */
/* Reads the table of the faces, and what their blocks of the configuration ask for. */
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

#include "src/config/read/config.h"
#include "src/config/read/listen.h"
#include "src/config/read/options.h"
#include "src/ground/board/look.h"
#include "src/tool/owsctl/machine/faces.h"

const struct face_right face_rights[FACE_RIGHTS] = {
	{"Write", "owsd-control", NULL},
	{"Configure", "owsd-config", "owsd-writer"},
	{"Rename", "owsd-config", "owsd-writer"},
};

/* The next column of a row, without blanks around it. */
static char *next_column(char **rest)
{
	char *word = strsep(rest, "|"), *end;

	if (!word)
		return NULL;
	word += strspn(word, " ");
	for (end = word + strlen(word); end > word && strchr(" \n", end[-1]);)
		*--end = '\0';
	return word;
}

int faces_table(struct face_row rows[FACE_ROWS])
{
	char folder[400], path[420], line[256];
	int count = 0;
	FILE *in;

	/* it lies beside the folder of the boards */
	board_folder(folder, sizeof(folder));
	snprintf(path, sizeof(path), "%s/../faces", folder);
	in = fopen(path, "re");
	if (!in)
		return -errno;
	while (count < FACE_ROWS && fgets(line, sizeof(line), in)) {
		char *rest = line, *column[6] = {0};

		for (int i = 0; i < 6 && *line != '#'; i++)
			column[i] = next_column(&rest);
		if (!column[5])
			continue;
		snprintf(rows[count].program, sizeof(rows[count].program), "%.31s", column[0]);
		snprintf(rows[count].package, sizeof(rows[count].package), "%.31s", column[2]);
		rows[count++].socket = !strcmp(column[5], "-");
	}
	fclose(in);
	return count;
}

/* "web" of "owsd-web" */
static const char *word_of(const char *program)
{
	return program + strcspn(program, "-") + 1;
}

const struct face_row *faces_find(const struct face_row *rows, int count, const char *word)
{
	/* what a person calls it */
	if (!strcmp(word, "history"))
		word = "recorder";
	for (int i = 0; i < count; i++)
		if (!strcmp(word, rows[i].program) || !strcmp(word, word_of(rows[i].program)))
			return &rows[i];
	return NULL;
}

/* A block has the name of its program: Web of owsd-web. */
static const struct option_def *block_of(const char *program)
{
	for (int i = 0; i < OPTION_COUNT_ALL; i++)
		if (option_table[i].inside && !strcasecmp(option_table[i].key, word_of(program)))
			return &option_table[i];
	return NULL;
}

bool face_has_block(const struct config *config, const char *program)
{
	const struct option_def *block = block_of(program);

	return block && option_is_given(block, config);
}

bool face_may(const char *program, const char *key)
{
	const struct option_def *block = block_of(program);

	return block && (!key || option_find(block->inside, key) >= 0);
}

bool face_has(const struct config *config, const char *program, const char *key)
{
	const struct option_def *block = block_of(program);
	int at = block ? option_find(block->inside, key) : -1;
	const void *from = block ? (const char *)config + block->offset : NULL;
	char room[VALUE_TEXT_MAX];
	const char *text = at < 0 ? "" : option_text(&option_table[at], from, room);

	return *text && strcmp(text, "off") != 0;
}

const char *face_unit(const struct face_row *row, const char *instance, const char *what,
                      char unit[FACE_UNIT])
{
	snprintf(unit, FACE_UNIT, "%s@%.200s.%s", row->program, instance, what);
	return unit;
}

size_t faces_files(const char *root, const char *pattern, glob_t *found)
{
	static const char *const folders[] = {"usr/lib", "usr/local/lib", "lib", "etc"};
	char path[640];

	*found = (glob_t){0};
	for (size_t i = 0; i < sizeof(folders) / sizeof(*folders); i++) {
		snprintf(path, sizeof(path), "%.200s/%s/%.400s", root, folders[i], pattern);
		/* not GLOB_BRACE, which musl has not */
		glob(path, found->gl_pathc ? GLOB_APPEND : 0, NULL, found);
	}
	return found->gl_pathc;
}

bool face_is_installed(const char *root, const struct face_row *row)
{
	char pattern[FACE_UNIT];
	glob_t found;
	bool any;

	snprintf(pattern, sizeof(pattern), "systemd/system/%.100s@.service", row->program);
	any = faces_files(root, pattern, &found) > 0;
	globfree(&found);
	return any;
}

/* A link makes it start. */
bool face_starts(const char *root, const char *unit)
{
	char pattern[FACE_UNIT + 40];
	glob_t found;
	bool any;

	snprintf(pattern, sizeof(pattern), "systemd/system/*.wants/%s", unit);
	any = faces_files(root, pattern, &found) > 0;
	globfree(&found);
	return any;
}

void face_addresses(const struct config *config, char *text, size_t size)
{
	const struct config_web *web = &config->web;
	char at[LISTEN_TEXT_MAX], host[64] = "";
	size_t used = 0;

	text[0] = '\0';
	gethostname(host, sizeof(host) - 1);
	for (unsigned i = 0; i < web->address_count && used < size; i++) {
		struct listen_address any = {.is_v6 = web->addresses[i].is_v6,
		                             .port = web->addresses[i].port};

		/* a browser needs a name in place of 0.0.0.0 */
		listen_print(&web->addresses[i], at);
		if (listen_same(&any, &web->addresses[i]) && *host)
			snprintf(at, sizeof(at), "%.48s:%u", host, (unsigned)any.port);
		used += (size_t)snprintf(text + used, size - used, "%shttp://%s/", used ? " " : "",
		                         at);
	}
}
