/* SPDX-License-Identifier: MIT */
/* Finds the target that reaches the served protocol of an instance. */
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "src/faces/show/when.h"
#include "src/memory/libows/open.h"
#include "src/tool/owsctl/served.h"

/* The shared memory keeps so many bytes of a target's text. */
#define NAME_MOST 103
#define SCHEME "owserver:"

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

/* Of a target that find_own() wrote. */
static const char *own_path(const struct served *served)
{
	return served->target + strlen(SCHEME);
}

/* NAME.sock of an owsd that serves nothing else. False: this user may not use it. */
static bool find_own(const struct ctl *ctl, const struct ows *h, struct served *served)
{
	int n = snprintf(served->target, sizeof(served->target), SCHEME "%s/%s.sock", open_dir(h),
	                 ctl->instance);

	if (n >= 0 && (size_t)n < sizeof(served->target) &&
	    access(own_path(served), R_OK | W_OK) == 0)
		return true;
	served->target[0] = '\0';
	return false;
}

static int served_refuse(const struct ctl *ctl, const struct served *served)
{
	if (served->own)
		return ctl_fail(
			"owsd %s takes no writes at %s, it is read-only there: ListenSocket "
			"in its configuration or its option -l lets it; for a signal there "
			"is owsctl set",
			ctl->instance, own_path(served));
	return ctl_fail(
		"owsd %s serves no clients: ListenSocket in its configuration or its option "
		"-l lets it; the group owsd-config may read without",
		ctl->instance);
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
		h = ctl_open(ctl, OWS_READ); /* prints the reason, and ends */
	ows_daemon(h, when_now().boot, &daemon);
	served->runs = daemon.alive;
	where = ows_served(h);
	if (served->runs && where)
		snprintf(served->target, sizeof(served->target), "%s", where);
	else if (served->runs)
		served->own = find_own(ctl, h, served);
	served->cut = !copy_targets(h, served->targets, sizeof(served->targets));
	ows_close(h);
	if (ctl->named && !served->runs)
		return ctl_fail("owsd %s is not running", ctl->instance);
	if (ctl->named && (!served->target[0] || (served->own && ctl->verb->writes)))
		return served_refuse(ctl, served);
	/* as where owsd serves nothing */
	if (served->own && ctl->verb->writes)
		served->target[0] = '\0';
	return CTL_DONE;
}
