/* SPDX-License-Identifier: MIT */
/*
 * A target that owsctl opens without owsd: a bus that runs in this process until its answers have
 * come. Blocking, up to the time given.
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
	const char *name;     /* the target as given */
	struct served served; /* without a given target: that of the instance */
	int64_t timeout_ns;   /* for opening, and for each request */
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
 * Open ctl->target, or the served target without one. CTL_DONE, or the status after printing why.
 */
int target_open(const struct ctl *ctl, int64_t timeout_ns, struct target *target);
void target_close(struct target *target);

/*
 * Do count requests, as many at once as the bus takes. Each has an answer afterwards: a request
 * without one by its deadline gets -ETIMEDOUT, and so does every later request of this target.
 */
void target_ask(struct target *target, struct ask *asks, unsigned count);
/* Do one request. Returns the error of its answer. */
int target_ask_one(struct target *target, struct ask *ask);

/* The option -w of all verbs that open a target; as ctl_option(). */
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
/* Is the text one number, as JSON writes them? */
bool target_is_number(const char *text, size_t len);

#endif
