/* SPDX-License-Identifier: MIT */
/*
 * libmicrohttpd in the loop of the face: requests are read, given to the function of their path,
 * and answered. All answers say that nothing is to be kept, guessed or framed.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include "src/faces/web/jobs.h"
#include "src/faces/web/web.h"

struct MHD_Connection;
struct MHD_Response;

/* A request, from its head to the end of the answer. */
struct request {
	struct web *web;
	struct MHD_Connection *connection;
	struct job *job; /* that makes the answer; NULL: none was given */
	bool answered;   /* the job is done */
	bool head;       /* the head of the answer is asked for alone */
	int64_t came_ns; /* it came later than that */
	size_t held;     /* bytes of the answer that count in web->held */
	struct posted posted;
	char person[PERSON]; /* who asks, where the path asks for rights */
};

/* Start it. 0 or a negative errno. */
int http_open(struct web *web);
/* Let it work on what is ready. Then http_next() says when to call this again at the latest. */
void http_run(struct web *web);
int64_t http_next(const struct web *web, int64_t now_ns);
/* All streams have ended before. */
void http_close(struct web *web);

const char *http_header(const struct request *request, const char *name); /* NULL: none */
const char *http_argument(const struct request *request, const char *name);

/* Who asks, in the words of a proxy; NULL: none. Anybody can claim that. */
const char *http_named(const struct request *request);

/* The descriptor of its connection. */
int http_descriptor(const struct request *request);

/* Each answers the request, and returns what libmicrohttpd wants. */
int http_answer(struct request *request, unsigned status, struct MHD_Response *response);
/*
 * text was allocated (open_memstream()), and belongs to the answer now; NULL: no memory. A long one
 * is refused while the answers that slow clients have not yet read are too long in sum.
 */
int http_json(struct request *request, unsigned status, char *text, size_t len);
int http_error(struct request *request, unsigned status, const char *format, ...)
	__attribute__((format(printf, 3, 4)));

/*
 * A job of so many bytes, zeroed, that begins with a struct job; it gets the body of the request,
 * and who asks. NULL: no memory. Then give it to http_defer() or job_free().
 */
struct job *http_job(struct request *request, size_t size, void (*run)(struct job *job));
/* Have a worker answer it. Takes the job; NULL: no memory. */
int http_defer(struct request *request, enum web_worker worker, struct job *job);
/* Answer those whose jobs are done. */
void http_done(struct web *web);

/* May who asks do that? As person_may_do(), with the person whom a proxy names. */
bool http_may(const struct request *request, enum person_deed deed, char person[PERSON],
              const char **why);
