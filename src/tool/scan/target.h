/* SPDX-License-Identifier: MIT */
/*
 * A target that a program opens without an engine: a bus that runs in the calling thread until its
 * answers have come. Blocking, up to the time given.
 */
#pragma once

#include "hal/base/time.h"
#include "hal/bus/bus.h"

struct target {
	const char *name; /* the target as given */
	/* Makes the bus of that name: bus_create(), or of one backend, whose "where" name is */
	int (*create)(const char *name, const struct bus_env *env, struct bus **bus, char *why,
	              size_t why_size);
	int64_t timeout_ns; /* for opening, and for each request */
	int64_t until_ns;   /* for all requests, CLOCK_BOOTTIME; 0: no limit */
	/* Called while several requests are under way; NULL: the caller shows no progress. */
	void (*progress)(struct target *target);
	int64_t printed_ns; /* of progress */
	struct tap *tap;    /* it sees all that the target does; NULL: there is none */
	/* What a target that stands for a recording has to say; NULL: it is not shown. */
	void (*note)(const char *text);
	struct bus *bus;
	struct bus_env env;
	bool up, down;
	bool dead;             /* a request was never answered: the bus still owns it */
	struct bus_event loss; /* why the target is down */
	struct ask *asks;
	unsigned count, answered;
	uint32_t first_id;
};

/* A request and its answer. req.id and req.deadline_ns are set by target_ask(). */
struct ask {
	struct bus_req req;
	struct bus_answer answer;
};

/*
 * Open target->name by target->create; timeout_ns is set. With until_ns, try again for three
 * quarters of that time: while owsd finds out what its chips are, an answer takes longer than a
 * connection waits. 0; -ENOTCONN: it is not there; or a negative errno of create(); with the reason
 * in why.
 */
int target_connect(struct target *target, char *why, size_t why_size);
void target_close(struct target *target);

/*
 * Do count requests, as many at once as the bus takes. Each has an answer afterwards: a request
 * without one by its deadline gets -ETIMEDOUT, and so does every later request of this target.
 */
void target_ask(struct target *target, struct ask *asks, unsigned count);
/* Do one request. Returns the error of its answer. */
int target_ask_one(struct target *target, struct ask *ask);
/* The words of that error; of a target that was lost meanwhile, why. */
const char *target_error(const struct target *target, int err);

/*
 * The path of a request: one "/" in front, without /uncached, which sets *fresh. False: too long.
 */
bool target_path(const char *given, char path[256], bool *fresh);

/*
 * Trim the blanks with which owserver and owsd's buses pad numbers, and the elements of lists of
 * numbers, to 12 characters; in place; other text stays. Returns the new length.
 */
size_t target_unpad(char *text, size_t len);
