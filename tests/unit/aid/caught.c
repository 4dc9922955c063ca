/* SPDX-License-Identifier: MIT */
/* Runs verbs of owsctl and catches their stdout and stderr. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "unity.h"

#include "tests/unit/aid/caught.h"

struct ctl caught_ctl;
char *out, *err;
static struct verb verb = {.name = "verb", .usage = "OPERANDS", .brief = "tested"};

void caught_begin(const char *instance)
{
	caught_ctl = (struct ctl){.instance = instance, .verb = &verb};
}

void caught_end(void)
{
	free(out);
	free(err);
	out = err = NULL;
}

void holds(const char *text, const char *part)
{
	TEST_ASSERT_NOT_NULL_MESSAGE(strstr(text, part), text);
}

static char *whole(FILE *file)
{
	long size;
	char *text;

	fflush(file);
	size = ftell(file);
	text = calloc(1, (size_t)size + 1);
	TEST_ASSERT_NOT_NULL(text);
	rewind(file);
	TEST_ASSERT_EQUAL_size_t((size_t)size, fread(text, 1, (size_t)size, file));
	return text;
}

int run(int (*function)(struct ctl *, int, char **), const char *words)
{
	FILE *files[2] = {tmpfile(), tmpfile()};
	int saved[2] = {dup(STDOUT_FILENO), dup(STDERR_FILENO)}, status, argc = 0;
	char *argv[16], *copy = strdup(words);

	TEST_ASSERT_TRUE(files[0] && files[1] && copy);
	for (char *word = strtok(copy, " "); word && argc < 15; word = strtok(NULL, " "))
		argv[argc++] = word;
	argv[argc] = NULL;
	caught_ctl.json = false;
	fflush(stdout);
	dup2(fileno(files[0]), STDOUT_FILENO);
	dup2(fileno(files[1]), STDERR_FILENO);
	verb.run = function;
	status = ctl_flush(ctl_run(&caught_ctl, argc, argv));
	dup2(saved[0], STDOUT_FILENO);
	dup2(saved[1], STDERR_FILENO);
	free(out);
	free(err);
	for (int i = 0; i < 2; i++) {
		fseek(files[i], 0, SEEK_END);
		*(i ? &err : &out) = whole(files[i]);
		fclose(files[i]);
		close(saved[i]);
	}
	free(copy);
	return status;
}
