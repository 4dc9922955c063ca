/* SPDX-License-Identifier: MIT */
/* Reads the files of the machine for a look at the board, below a root directory. */
#include <fcntl.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "src/ground/board/files.h"

void board_path(char *path, const char *root, const char *format, ...)
{
	size_t len = (size_t)snprintf(path, BOARD_PATH, "%.*s", BOARD_ROOT, root);
	va_list args;

	va_start(args, format);
	vsnprintf(path + len, BOARD_PATH - len, format, args);
	va_end(args);
}

static size_t read_some(const char *root, const char *file, void *data, size_t size)
{
	char path[BOARD_PATH];
	ssize_t n = 0;
	int fd;

	board_path(path, root, "%s", file);
	fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
	if (fd < 0)
		return 0;
	n = read(fd, data, size);
	close(fd);
	return n > 0 ? (size_t)n : 0;
}

void board_text(const char *root, const char *file, char *text, size_t size)
{
	text[read_some(root, file, text, size - 1)] = '\0';
	text[strcspn(text, "\n")] = '\0';
}

unsigned board_cell(const char *root, const char *file)
{
	uint8_t cell[4];

	if (read_some(root, file, cell, sizeof(cell)) != sizeof(cell))
		return 0;
	return (unsigned)cell[0] << 24 | (unsigned)cell[1] << 16 | (unsigned)cell[2] << 8 | cell[3];
}

bool board_there(const char *root, const char *file)
{
	char path[BOARD_PATH];
	struct stat st;

	board_path(path, root, "%s", file);
	return lstat(path, &st) == 0;
}

void board_link(const char *root, const char *file, char *name, size_t size)
{
	char path[BOARD_PATH], to[BOARD_PATH], *slash;
	ssize_t n;

	board_path(path, root, "%s", file);
	n = readlink(path, to, sizeof(to) - 1);
	to[n > 0 ? n : 0] = '\0';
	slash = strrchr(to, '/');
	snprintf(name, size, "%.*s", (int)size - 1, slash ? slash + 1 : to);
}

const char *board_config(const char *root)
{
	static const char now[] = "/boot/firmware/config.txt", before[] = "/boot/config.txt";

	return !board_there(root, now) && board_there(root, before) ? before : now;
}

bool board_configured(const char *root, const char *line)
{
	const char *equals = strchr(line, '=');
	size_t key = equals ? (size_t)(equals - line) + 1 : 0;
	char path[BOARD_PATH], text[256];
	bool found = false, all = true;
	FILE *in;

	board_path(path, root, "%s", board_config(root));
	in = key ? fopen(path, "re") : NULL;
	while (in && !found && fgets(text, sizeof(text), in)) {
		char *at = text + strspn(text, " \t"), *rest, *word;

		/* a line after a filter such as [pi4] is not for every board */
		if (*at == '[')
			all = !strncmp(at, "[all]", 5);
		if (!all || strncmp(at, line, key))
			continue;
		for (word = strtok_r(at + key, ", \t\r\n", &rest); word && !found;
		     word = strtok_r(NULL, ", \t\r\n", &rest))
			found = !strcmp(word, line + key);
	}
	if (in)
		fclose(in);
	return found;
}
