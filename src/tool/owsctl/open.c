/* SPDX-License-Identifier: MIT */
/* Opens the target of a verb: the one that is named, or that of the instance. */
#include <errno.h>
#include <getopt.h>
#include <stdio.h>
#include <string.h>

#include "hal/bus/backends.h"
#include "src/config/read/config.h"
#include "src/config/read/targets.h"
#include "src/faces/show/when.h"
#include "src/tool/owsctl/open.h"

#define OPEN_ASKED 256
#define PROGRESS_NS (5 * NS_PER_S) /* the pause between two prints of the count of answers */

/* Returns CTL_DONE; or the status, with the reason in why. */
static int open_way(struct target *target, const char *name, char *why, size_t why_size)
{
	int err;

	target->name = name;
	err = target_connect(target, why, why_size);
	if (!err)
		return CTL_DONE;
	return err == -ENOMEM || err == -ENOTCONN ? CTL_FAILED : CTL_USAGE;
}

/* Open the first way that works, as owsd does. */
static int open_auto(struct target *target, char *why, size_t why_size)
{
	size_t used = (size_t)snprintf(why, why_size, "auto finds nothing");
	const char *way, *between = ": ";

	for (unsigned row = 0; (way = config_auto_way(&row)); between = "; ") {
		char reason[200] = "";
		int n;

		if (open_way(target, way, reason, sizeof(reason)) == 0)
			return CTL_DONE;
		n = snprintf(why + used, why_size - used, "%s%s", between, reason);
		used = n < 0 || (size_t)n >= why_size - used ? why_size - 1 : used + (size_t)n;
	}
	return CTL_FAILED;
}

/* Print how many of several requests are answered, every PROGRESS_NS. */
static void print_progress(struct target *target)
{
	int64_t now_ns = when_now().boot;

	if (now_ns - target->printed_ns < PROGRESS_NS)
		return;
	target->printed_ns = now_ns;
	ctl_tell("%u of %u answers from %s", target->answered, target->count, target->name);
}

static void print_note(const char *text)
{
	ctl_tell("%s", text);
}

int open_target(const struct ctl *ctl, int64_t timeout_ns, struct target *target,
                struct served *served)
{
	const char *name = ctl->target;
	char why[700] = "";
	int status;

	*target = (struct target){.timeout_ns = timeout_ns,
	                          .until_ns = ctl->until_ns,
	                          .create = bus_create,
	                          .progress = print_progress,
	                          .tap = ctl->tap,
	                          .note = print_note};
	*served = (struct served){0};
	if (!name && served_find(ctl, served))
		return CTL_FAILED;
	if (!name)
		name = served->target[0] ? served->target : OPEN_DEFAULT_TARGET;
	if (!ctl->target && !served->target[0] && served->runs)
		ctl_tell("asked " OPEN_DEFAULT_TARGET ": owsd %s serves no clients", ctl->instance);
	status = strcmp(name, "auto") ? open_way(target, name, why, sizeof(why))
	                              : open_auto(target, why, sizeof(why));
	if (strcmp(name, "auto") == 0)
		target->name = name;
	if (status)
		ctl_fail("%s%s", why,
		         status == CTL_USAGE || ctl->target ? ""
		         : !served->runs                    ? " (-t TARGET names another target)"
		         : served->target[0]                ? ""
		                             : " (and the owsd that runs here serves no clients: "
		                               "ListenSocket in its configuration lets it)");
	return status;
}

const char *open_asked(const struct ctl *ctl, const struct target *target,
                       const struct served *served)
{
	static char text[OPEN_ASKED];

	*text = '\0';
	if (!ctl->target && served->target[0])
		snprintf(text, sizeof(text), " (asked owsd %s)", ctl->instance);
	else if (!ctl->target)
		snprintf(text, sizeof(text), " (asked %s)", target->name);
	return text;
}

int target_option(struct ctl *ctl, int argc, char **argv, const char *options, int64_t *timeout_ns)
{
	char all[16];
	int c;

	snprintf(all, sizeof(all), "%sw:%s", *options == '+' ? "+" : "",
	         options + (*options == '+'));
	while ((c = ctl_option(ctl, argc, argv, all)) == 'w')
		if (!ctl_seconds(optarg, timeout_ns) || *timeout_ns <= 0)
			ctl_end(ctl_usage(ctl, "%s is not a number of seconds above 0",
			                  ctl_word(optarg)));
	return c;
}
