/* SPDX-License-Identifier: MIT */
/* Opens the target of a verb: the one that is named, or that of the instance. */
#include <errno.h>
#include <getopt.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "hal/bus/backends.h"
#include "hal/serial/find.h"
#include "hal/usb/find.h"
#include "src/config/read/config.h"
#include "src/config/read/targets.h"
#include "src/faces/show/when.h"
#include "src/memory/libows/open.h"
#include "src/tool/owsctl/open.h"

/* --- What an instance serves ----------------------------------------------------------------- */

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

/*
 * CTL_DONE, or CTL_FAILED after printing why: the user named an instance that is not there, or that
 * does not serve what the verb needs.
 */
static int served_find(const struct ctl *ctl, struct served *served)
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

/* --- The target ------------------------------------------------------------------------------ */

#define OPEN_ASKED 256
#define USB_DEVICES "/sys/bus/usb/devices"
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

/* auto takes no adapter away from the kernel's driver. */
static void tell_way(const char *way)
{
	struct usb_place places[USB_PLACES];

	if (!strcmp(way, "w1") && usb_find(USB_DEVICES, places))
		ctl_tell("asked w1; with -t usb: owsd itself drives the DS9490R at USB %s",
		         places[0].name);
}

/* Open the first way that works, as owsd does. */
static int open_auto(struct target *target, char *why, size_t why_size)
{
	size_t used = (size_t)snprintf(why, why_size, "auto finds nothing");
	const char *way, *between = ": ";
	struct usb_place places[USB_PLACES];
	char port[200];

	for (unsigned row = 0; (way = config_auto_way(&row)); between = "; ") {
		char reason[200] = "";
		int n;

		if (open_way(target, way, reason, sizeof(reason)) == 0) {
			tell_way(way);
			return CTL_DONE;
		}
		n = snprintf(why + used, why_size - used, "%s%s", between, reason);
		used = n < 0 || (size_t)n >= why_size - used ? why_size - 1 : used + (size_t)n;
	}
	if (usb_find(USB_DEVICES, places))
		snprintf(why + used, why_size - used, "; -t usb: asks the DS9490R at USB %s",
		         places[0].name);
	else if (tty_only(SERIAL_NAMES, port, sizeof(port)))
		snprintf(why + used, why_size - used,
		         "; auto opens no serial port: is an adapter at -t serial:%s ?", port);
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
	char why[900] = "";
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
