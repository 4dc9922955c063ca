/* SPDX-License-Identifier: MIT */
/*
 * The way by which the guest's scripts tell the simulator something: one command line, one answer,
 * over a socket of the guest.
 */
#pragma once

#include <stddef.h>

/* 0 done, negative refused; answer gets a text either way. */
typedef int control_command(void *ctx, const char *line, char *answer, size_t size);

/* A descriptor to poll for reading, or negative errno. */
int control_listen(void);
/* Take one command from one caller and answer it; a caller that says nothing is dropped. */
void control_serve(int fd, control_command *command, void *ctx);

/* The caller's side: words make the line. Prints the answer; the exit status for main(). */
int control_tell(int words, char **word);
