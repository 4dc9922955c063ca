/* SPDX-License-Identifier: MIT */
/* owsctl alarms ack: acknowledges limit alarms. */

#include <errno.h>
#include <getopt.h>
#include <stdio.h>
#include <string.h>

#include "hal/bus/time.h"
#include "src/libows/ows.h"
#include "src/owsctl/alarms_ack.h"
#include "src/owsctl/ctl.h"

/* owsd takes an acknowledgement at once; an owsd that takes longer hangs. */
#define PATIENCE_NS (2 * NS_PER_S)

static bool unacknowledged(struct ows *h, int id)
{
	struct ows_alarm_state state = {0};

	ows_alarm_state(h, id, &state);
	return state.limit_state == OWS_LIMIT_UNACKNOWLEDGED ||
	       state.limit_state == OWS_LIMIT_RETURNED;
}

/* The id of an alarm to acknowledge; -1 after printing why there is none. */
static int alarms_ack_find(struct ows *h, const char *name)
{
	struct ows_alarm_state state = {0};
	int id = ows_find(h, name);

	if (id < 0) {
		ctl_unknown(h, name);
		return -1;
	}
	ows_alarm_state(h, id, &state);
	if (!state.limits) {
		ctl_fail("%s has no limit alarms", name);
		return -1;
	}
	return id;
}

static int acknowledge(struct ows *h, const char *name, int id)
{
	int64_t until = ows_now() + PATIENCE_NS, left;
	uint32_t news = 0;
	int err;

	if (!unacknowledged(h, id))
		return CTL_DONE;
	err = ows_acknowledge(h, id);
	if (err)
		return ctl_fail("cannot acknowledge %s: %s", name, strerror(-err));
	while (unacknowledged(h, id)) {
		left = until - ows_now();
		if (left <= 0)
			return ctl_fail("owsd did not take the acknowledgement of %s", name);
		ctl_sleep(h, &news, left);
	}
	return CTL_DONE;
}

static int acknowledge_all(struct ows *h)
{
	int status = CTL_DONE;

	for (int i = 0; i < ows_count(h); i++) {
		struct ows_info info;

		if (ows_info(h, i, &info) == 0 && acknowledge(h, info.name, ows_find(h, info.name)))
			status = CTL_FAILED;
	}
	return status;
}

static int acknowledge_names(struct ows *h, int count, char **names)
{
	int status = CTL_DONE;

	for (int i = 0; i < count; i++)
		if (alarms_ack_find(h, names[i]) < 0)
			status = CTL_FAILED;
	for (int i = 0; status == CTL_DONE && i < count; i++)
		status = acknowledge(h, names[i], ows_find(h, names[i]));
	return status;
}

int alarms_ack(struct ctl *ctl, int argc, char **argv)
{
	bool all = false;
	struct ows *h;
	int c, status;

	ctl_options();
	while ((c = ctl_option(ctl, argc, argv, "a")) != -1) {
		if (c != 'a')
			return CTL_USAGE;
		all = true;
	}
	if (all != (optind == argc))
		return ctl_usage(ctl, "alarms ack takes names or -a");
	status = ctl_open(ctl, OWS_CONTROL, &h);
	if (status)
		return status;
	if (!ctl_alive(ctl, h, ows_now()))
		status = CTL_FAILED;
	else if (all)
		status = acknowledge_all(h);
	else
		status = acknowledge_names(h, argc - optind, argv + optind);
	ows_close(h);
	return status;
}
