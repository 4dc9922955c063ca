/* SPDX-License-Identifier: MIT */
/*
 * One POST at a time to one server, by libcurl, without blocking: the caller waits for the
 * descriptors and for the time that it asks for. Names are looked up by a thread of libcurl.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "src/faces/kit/backoff.h"

#define POST_WORDS 160
#define POST_HEADER 1100

struct post;
struct post_result {
	long status; /* of HTTP; 0: there was no answer */
	/* "HTTP 400: the first words of the answer", or why there was none; printable */
	char words[POST_WORDS + 16];
};

/* What kind of failure is that? A proxy whose server is away answers with 502 or 504. */
static inline enum backoff_why post_why(long status)
{
	return status && status != 502 && status != 504 ? BACKOFF_REFUSED : BACKOFF_AWAY;
}

/* watch: wait for fd too, events as in poll(2); 0: no more. NULL: no memory. */
struct post *post_open(void (*watch)(void *ctx, int fd, short events), void *ctx);
void post_close(struct post *post);

struct post_what {
	const char *url, *type;     /* of the content */
	const char *scheme, *token; /* of Authorization; token "": none */
	const char *data;           /* has to stay until the end */
	size_t len;
};
/* Begin. The answer has to be there within 20 s. 0 or -ENOMEM. */
int post_begin(struct post *post, const struct post_what *what);
bool post_is_busy(const struct post *post);
/*
 * Go on: fd is ready, as poll(2) has it; or -1: the time has come. True: it is over, and *result
 * says how.
 */
bool post_step(struct post *post, int fd, short ready, struct post_result *result);
/* Wait for the end, at the end of the program. True: it is over before that time, with *result. */
bool post_wait(struct post *post, int64_t until_ns, struct post_result *result);
/* When to go on if no descriptor is ready: CLOCK_BOOTTIME; INT64_MAX: never. */
int64_t post_next(const struct post *post);
/* Give up. The server may have got the data, or not. */
void post_cancel(struct post *post);
