/* SPDX-License-Identifier: MIT */
/*
 * The head of a request, looked at before libmicrohttpd reads it: by the letter of RFC 9112, so
 * that no proxy before owsd-web understands another request than owsd-web does.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#define HEAD_MAX 8192 /* bytes of a head */
#define BODY_MAX 8192 /* and of a body */
/* Of a body that has a configuration, as JSON: a text of 1 MiB, and what JSON adds */
#define BODY_LARGE (1536u * 1024)

/*
 * What len bytes from the begin of a connection are: 0: a head that goes on; 200: a whole head, and
 * a body that may follow; else the status of the refusal, with the reason in *why. Pure.
 */
int head_check(const char *bytes, size_t len, const char **why);

/* Is that a path whose bodies may be large? Without "?". Pure. */
bool head_large(const char *path);
