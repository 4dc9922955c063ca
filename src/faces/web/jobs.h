/* SPDX-License-Identifier: MIT */
/*
 * A thread for what takes longer than the loop may wait: it does jobs, one after another. Peers
 * take turns, so one that asks for much delays another by one job.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "src/faces/web/person.h"

/*
 * The bytes of a body while they come, and until they are read. Few bodies may be large: there is
 * room for so many at a time. One thread, the loop of the face.
 */

#define POSTED_LARGE 2 /* large bodies at a time */
#define POSTED_S 60    /* so long a body may take to come, byte by byte */

struct posted {
	char *bytes; /* NULL: none, or they are dropped */
	size_t len, size;
	unsigned *large; /* counts large ones; NULL: this one is small */
	int64_t until_ns;
	bool dropped; /* it is counted and not kept: nobody may send it, or there is no room */
};

/* Before the body of so many bytes comes. large: how many large ones there are. */
void posted_begin(struct posted *posted, size_t size, unsigned *large, bool may, int64_t now_ns);
/* False: it is longer than was announced, comes too slowly, or there is no memory. */
bool posted_add(struct posted *posted, const char *bytes, size_t len, int64_t now_ns);
void posted_free(struct posted *posted);

struct request;
struct jobs;

#define JOBS 64         /* that wait */
#define JOBS_OF_PEER 16 /* of these, of one peer */

/* A job, and the answer that it makes. One side at a time has it. */
struct job {
	struct job *next;
	void (*run)(struct job *job); /* on the thread: fills status, text, len */
	struct request *request;      /* the loop's; NULL: nobody waits any more */
	uint64_t peer;                /* who asks, as person_number() has it */
	char person[PERSON];          /* who that is, where the path asks for rights */
	const char *instance;
	uint64_t turn;        /* of jobs.c: the jobs of a turn are of different peers */
	struct posted posted; /* the body of the request */
	unsigned status;
	char *text; /* JSON, allocated; NULL: no memory */
	size_t len;
};

/* On the loop: a job that nobody has, with what it holds. */
void job_free(struct job *job);

/* bell: rung when a job is done (hal/base/bell.h). NULL: no memory, or no thread. */
struct jobs *jobs_start(int bell);
/* False: too many wait, or too many of that peer. */
bool jobs_give(struct jobs *jobs, struct job *job);
/* A job that is done; NULL: none. */
struct job *jobs_take(struct jobs *jobs);
/* Waits for the job that runs; all others come back as done by jobs_take(). */
void jobs_end(struct jobs *jobs);
void jobs_free(struct jobs *jobs);

struct json;

/* Begin the object that answers a job. False: no memory. */
bool job_json(struct job *job, unsigned status, struct json *json);
/* Answer a job with an error. */
void job_error(struct job *job, unsigned status, const char *format, ...)
	__attribute__((format(printf, 3, 4)));
