/* SPDX-License-Identifier: MIT */
/*
 * ownet SERVER: libownet, as a program of its users is linked, at the command of a system test. One
 * command a line, one answer a line; data are hexadecimal.
 *   dir PATH · read PATH · lread SIZE OFFSET PATH · put HEX PATH · lwrite OFFSET HEX PATH ·
 *   present PATH · scale LETTER · format WORD · trim NUMBER
 *                 "ok HEX" or "error NUMBER"; HEX is "-" where it is empty
 */
#if __has_include(<ownetapi.h>)
#include <ownetapi.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static char line[8192], data[70000];

static void say(int ret, const char *text)
{
	if (ret < 0) {
		printf("error %d\n", ret);
		return;
	}
	printf("ok %s", ret ? "" : "-");
	for (int i = 0; i < ret; i++)
		printf("%02x", (unsigned char)text[i]);
	putchar('\n');
}

static size_t bytes_of(const char *hex)
{
	size_t n = 0;

	for (unsigned byte; sscanf(hex, "%2x", &byte) == 1 && n < sizeof(data); hex += 2)
		data[n++] = (char)byte;
	return n;
}

static void obey(OWNET_HANDLE h, char *verb, char *rest)
{
	char *text = NULL, word[4096] = "", path[4096] = "";
	long size = 0, offset = 0;
	size_t n;
	int ret;

	if (!strcmp(verb, "dir")) {
		ret = OWNET_dirlist(h, rest, &text);
		say(ret, text);
	} else if (!strcmp(verb, "read")) {
		ret = OWNET_read(h, rest, &text);
		say(ret, text);
	} else if (!strcmp(verb, "lread") &&
	           sscanf(rest, "%ld %ld %4095s", &size, &offset, path) == 3 && size >= 0 &&
	           size <= (long)sizeof(data)) {
		ret = OWNET_lread(h, path, data, (size_t)size, offset);
		say(ret, data);
	} else if (!strcmp(verb, "put") && sscanf(rest, "%4095s %4095s", word, path) == 2) {
		n = bytes_of(word);
		say(OWNET_put(h, path, data, n) < 0 ? -1 : 0, "");
	} else if (!strcmp(verb, "lwrite") &&
	           sscanf(rest, "%ld %4095s %4095s", &offset, word, path) == 3) {
		n = bytes_of(word);
		say(OWNET_lwrite(h, path, data, n, offset) < 0 ? -1 : 0, "");
	} else if (!strcmp(verb, "present")) {
		say(OWNET_present(h, rest) < 0 ? -1 : 0, "");
	} else if (!strcmp(verb, "scale")) {
		OWNET_set_temperature_scale(rest[0]);
		say(0, "");
	} else if (!strcmp(verb, "format")) {
		OWNET_set_device_format(rest);
		say(0, "");
	} else if (!strcmp(verb, "trim")) {
		OWNET_set_trim(atoi(rest));
		say(0, "");
	} else {
		say(-1000, "");
	}
	free(text);
}

int main(int argc, char **argv)
{
	OWNET_HANDLE h = argc == 2 ? OWNET_init(argv[1]) : -1;

	if (h < 0)
		return 1;
	while (fgets(line, sizeof(line), stdin)) {
		char *rest = strchr(line, ' ');

		line[strcspn(line, "\n")] = '\0';
		if (rest)
			*rest++ = '\0';
		obey(h, line, rest ? rest : line + strlen(line));
		fflush(stdout);
	}
	OWNET_finish();
	return 0;
}
#else
/* Without the header there is no such program; who starts it is told by the exit status. */
int main(void)
{
	return 77;
}
#endif
