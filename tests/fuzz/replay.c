/* SPDX-License-Identifier: MIT */
/*
 * The seeds and found cases of a target, without libFuzzer: each file is a test. With arguments
 * these files only. What comes last on stdout before a crash is the file that made it.
 */
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/fuzz/fuzz.h"

static unsigned tests;

static void run_file(const char *path)
{
	FILE *file = fopen(path, "rb");
	uint8_t *bytes = NULL;
	long n = -1;

	printf("%s\n", path);
	fflush(stdout);
	if (file && fseek(file, 0, SEEK_END) == 0)
		n = ftell(file);
	if (n >= 0)
		bytes = malloc((size_t)n + 1);
	if (!bytes || fseek(file, 0, SEEK_SET) || fread(bytes, 1, (size_t)n, file) != (size_t)n) {
		fprintf(stderr, "%s: cannot be read\n", path);
		exit(1);
	}
	fclose(file);
	/* without a byte behind it that is not its own */
	bytes = realloc(bytes, n ? (size_t)n : 1);
	LLVMFuzzerTestOneInput(bytes, (size_t)n);
	free(bytes);
	tests++;
}

static void run_folder(const char *kind, const char *target)
{
	char folder[200], path[500];
	struct dirent **names;
	int n;

	snprintf(folder, sizeof(folder), "tests/fuzz/%s/%s", kind, target);
	n = scandir(folder, &names, NULL, alphasort);
	for (int i = 0; i < n; i++) {
		snprintf(path, sizeof(path), "%s/%s", folder, names[i]->d_name);
		if (names[i]->d_name[0] != '.')
			run_file(path);
		free(names[i]);
	}
	if (n >= 0)
		free(names);
}

int main(int argc, char **argv)
{
	const char *name = strrchr(argv[0], '/');

	for (int i = 1; i < argc; i++)
		run_file(argv[i]);
	if (argc < 2) {
		name = name ? name + 1 : argv[0];
		name = strncmp(name, "replay_", 7) == 0 ? name + 7 : name;
		run_folder("seeds", name);
		run_folder("cases", name);
	}
	printf("%u Tests 0 Failures 0 Ignored\n", tests);
	return 0;
}
