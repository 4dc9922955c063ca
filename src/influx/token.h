/* SPDX-License-Identifier: MIT */
/* The token of the server, which stands in a file of its own. */
#ifndef INFLUX_TOKEN_H
#define INFLUX_TOKEN_H

#include <stddef.h>

#define TOKEN_SIZE 1024
#define TOKEN_PATH 512

/*
 * Read the file of a TokenFile: a path, or the name of a credential that systemd has put into
 * CREDENTIALS_DIRECTORY; NULL: none, token is "". Blanks and line ends around the token are left
 * out. Returns 0, or a negative errno, with the reason in why: others may read the file; it is no
 * file; it is empty, or longer than a token. Blocking.
 */
int token_read(const char *name, char token[TOKEN_SIZE], char *why, size_t size);

#endif
