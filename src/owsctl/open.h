/* SPDX-License-Identifier: MIT */
/*
 * A target that owsctl opens itself, without owsd: a bus, run here until its answers are there.
 * Blocking, bounded by the time given.
 */
#ifndef OWSCTL_OPEN_H
#define OWSCTL_OPEN_H

#include "hal/bus/bus.h"
#include "hal/bus/time.h"
#include "src/owsctl/ctl.h"
#include "src/owsctl/served.h"
#include "src/signal/error.h"

#define OPEN_DEFAULT_TARGET "localhost:4304"
#define OPEN_TIMEOUT_NS (20 * NS_PER_S)

struct target {
	const char *name;     /* as given */
	struct served served; /* none was given: of the instance */
	int64_t timeout_ns;   /* for opening, and for each request */
	struct bus *bus;
	struct bus_env env;
	bool up, down;
	bool dead;             /* a request was never answered: the bus still owns it */
	struct bus_event loss; /* down: why */
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
 * Open ctl->target, or the served target without one. CTL_DONE, or the status after printing why.
 */
int target_open(const struct ctl *ctl, int64_t timeout_ns, struct target *target);
void target_close(struct target *target);

/*
 * Do count requests, as many at once as the bus takes. Each has an answer afterwards: a request
 * without one by its deadline gets -ETIMEDOUT, and so does every later request of this target.
 */
void target_ask(struct target *target, struct ask *asks, unsigned count);
/* One request: the error of its answer. */
int target_ask_one(struct target *target, struct ask *ask);

/* Options of all verbs that open a target: -w; as ctl_option(). */
int target_option(struct ctl *ctl, int argc, char **argv, const char *options, int64_t *timeout_ns);

/*
 * The path of a request: one "/" in front, without /uncached, which sets *fresh. False: too long.
 */
bool target_path(const char *given, char path[256], bool *fresh);

/*
 * Trim the blanks with which owserver and owsd's buses pad numbers, and the elements of lists of
 * numbers, to 12 characters; in place; other text stays. Returns the new length.
 */
size_t target_unpad(char *text, size_t len);
/* Is it one number, as JSON writes them? */
bool target_is_number(const char *text, size_t len);

#endif
