/* SPDX-License-Identifier: MIT */
/* Commands of the system that owsctl runs, without a shell, and waits for. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define COMMAND_WORDS 48

/*
 * Run it, and take what it writes to stdout. False: it cannot run, fails, or has not ended by
 * then and is killed; text is "" then.
 */
bool command_output(const char *const words[], int64_t until_ns, char *text, size_t size);
/*
 * Print "+ COMMAND", and run it; dry: print alone. Returns 0, or -EIO after saying that it failed.
 */
int command_run(const char *const words[], bool dry);
/* The same of the words in len bytes of a line, with blanks between them. */
int command_line(const char *line, size_t len);
