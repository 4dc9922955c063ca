/* SPDX-License-Identifier: MIT */
/* A token, password or key of a face, which stands in a file of its own. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define SECRET_SIZE 1024
#define SECRET_PATH 512

/*
 * Read the file: a path, or the name of a credential that systemd has put into
 * CREDENTIALS_DIRECTORY; NULL: none, token is "". Blanks and line ends around the token are left
 * out. Returns 0, with why "", or a negative errno, with the reason in why: others may read the
 * file; it is no file; it is empty, or longer than a token. Blocking.
 */
int secret_read(const char *name, char token[SECRET_SIZE], char *why, size_t size);
/*
 * For --check, which may run as another user than the service and without its credentials: may the
 * face use what its key names (NULL: nothing)? Reports why not, and what cannot be looked at from
 * here. Returns 0, or a negative errno if it may not.
 */
enum secret_kind {
	SECRET_TOKEN,  /* of secret_read() */
	SECRET_KEY,    /* of secret_file(), own */
	SECRET_PUBLIC, /* of secret_file(), not own */
};
int secret_check(const char *program, const char *key, const char *name, enum secret_kind kind);
/* Is why ("": nothing is wrong) another than that of *print, 0 at first? It is from now on. */
bool secret_is_news(const char *why, uint64_t *print);
/*
 * The path of such a file, for a library that reads it itself. own: no other user may read it.
 * Errors as secret_read().
 */
int secret_file(const char *name, bool own, char path[SECRET_PATH], char *why, size_t size);
