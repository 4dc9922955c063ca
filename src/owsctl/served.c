/* SPDX-License-Identifier: MIT */
/* Finds the target that reaches the served protocol of an instance. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "src/owsctl/served.h"
#include "src/owsctl/when.h"

/* The shared memory keeps so many bytes of a target's text. */
#define NAME_MOST 103

/*
 * Write the targets as in TargetName: a bar between ways to one wire, a comma between wires. False:
 * the text is cut.
 */
static bool copy_targets(struct ows *h, char *out, size_t size)
{
	bool whole = true;
	struct ows_target target;
	uint32_t group = 0;
	size_t used = 0;

	for (int i = 0; ows_target(h, i, &target) == 0; i++) {
		const char *between = !used ? "" : target.group == group ? " | " : ", ";
		int n = snprintf(out + used, size - used, "%s%s", between, target.name);

		if (n < 0 || (size_t)n >= size - used) {
			whole = false;
			break;
		}
		whole = whole && strlen(target.name) < NAME_MOST;
		used += (size_t)n;
		group = target.group;
	}
	out[used] = '\0';
	return whole;
}

int served_find(const struct ctl *ctl, struct served *served)
{
	struct ows_daemon daemon = {0};
	const char *where;
	struct ows *h;
	int err;

	*served = (struct served){0};
	err = ows_open(ctl->instance, OWS_READ, &h);
	/* no owsd was asked for and none is there: the caller means the port of owserver */
	if (err == -ENOENT && !ctl->named)
		return CTL_DONE;
	if (err)
		return ctl_open(ctl, OWS_READ, &h); /* ctl_open() prints the reason */
	ows_daemon(h, when_now().boot, &daemon);
	served->runs = daemon.alive;
	where = ows_served(h);
	if (served->runs && where)
		snprintf(served->target, sizeof(served->target), "%s", where);
	served->cut = !copy_targets(h, served->targets, sizeof(served->targets));
	ows_close(h);
	if (ctl->named && !served->runs)
		return ctl_fail("owsd %s is not running", ctl->instance);
	if (ctl->named && !served->target[0])
		return ctl_fail("owsd %s serves no clients: ListenSocket in its configuration or "
		                "its option -l lets it",
		                ctl->instance);
	return CTL_DONE;
}
