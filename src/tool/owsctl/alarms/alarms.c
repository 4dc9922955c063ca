/* SPDX-License-Identifier: MIT */
/*
 * owsctl alarms: lists the present alarms, or does what the word after it says: acknowledges,
 * shelves and unshelves limit alarms, or lists those of before.
 */
#include <errno.h>
#include <getopt.h>
#include <stdio.h>
#include <string.h>

#include "hal/base/time.h"
#include "src/faces/show/present.h"
#include "src/faces/show/when.h"
#include "src/public/ows.h"
#include "src/tool/owsctl/alarms/alarms_live.h"
#include "src/tool/owsctl/alarms/journal.h"
#include "src/tool/owsctl/ctl.h"
#include "src/tool/owsctl/verbs.h"

/* --- Acknowledge ----------------------------------------------------------------------------- */

/* owsd takes an acknowledgement at once; an owsd that takes longer hangs. */
#define PATIENCE_NS (2 * NS_PER_S)

static bool unacknowledged(struct ows *h, int id)
{
	struct ows_alarm_state state = {0};

	ows_alarm_state(h, id, &state);
	return standing_unacknowledged(&state);
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

static int alarms_ack(struct ctl *ctl, int argc, char **argv)
{
	bool all = false;
	struct ows *h;
	int status;

	while (ctl_option(ctl, argc, argv, "a") != -1)
		all = true;
	if (all != (optind == argc))
		return ctl_usage(ctl, "alarms ack takes names or -a");
	h = ctl_open(ctl, OWS_CONTROL);
	if (!ctl_alive(ctl, h, ows_now()))
		status = CTL_FAILED;
	else if (all)
		status = acknowledge_all(h);
	else
		status = acknowledge_names(h, argc - optind, argv + optind);
	ows_close(h);
	return status;
}

/* --- Shelve and unshelve --------------------------------------------------------------------- */

static int alarms_shelve_fail(const char *name, bool shelve, int err)
{
	const char *verb = shelve ? "shelve" : "unshelve";

	switch (-err) {
	case EOPNOTSUPP:
		return ctl_fail("%s has no limit alarms", name);
	case ENOSPC:
		return ctl_fail("cannot shelve %s: as many alarms are shelved as can be", name);
	case EAGAIN:
		return ctl_fail("cannot %s %s: too many requests; try again in a second", verb,
		                name);
	case ETIMEDOUT:
		return ctl_fail("owsd did not %s %s", verb, name);
	}
	return ctl_fail("cannot %s %s: %s", verb, name, strerror(-err));
}

/* seconds 0: unshelve. */
static int shelve_names(struct ctl *ctl, int count, char **names, uint32_t seconds, const char *why)
{
	struct ows *h = ctl_open(ctl, OWS_CONTROL);
	int status = CTL_DONE, id, err;

	if (!ctl_alive(ctl, h, ows_now()))
		status = CTL_FAILED;
	for (int i = 0; status == CTL_DONE && i < count; i++)
		if (ows_find(h, names[i]) < 0)
			status = ctl_unknown(h, names[i]);
	for (int i = 0; status == CTL_DONE && i < count; i++) {
		id = ows_find(h, names[i]);
		err = ows_shelve(h, id, seconds, why);
		if (err)
			status = alarms_shelve_fail(names[i], seconds > 0, err);
	}
	ows_close(h);
	return status;
}

static int alarms_shelve(struct ctl *ctl, int argc, char **argv)
{
	int64_t ns;

	ctl_option(ctl, argc, argv, "");
	if (argc - optind != 2 && argc - optind != 3)
		return ctl_usage(ctl, "alarms shelve takes a name, a time and perhaps a reason");
	if (!when_parse(argv[optind + 1], &ns) || ns < NS_PER_S || ns > OWS_SHELVE_MAX * NS_PER_S)
		return ctl_usage(ctl,
		                 "%s is no time to shelve an alarm: seconds, or as 30m, 8h or 2d; "
		                 "at most 7d",
		                 ctl_word(argv[optind + 1]));
	return shelve_names(ctl, 1, argv + optind, (uint32_t)(ns / NS_PER_S),
	                    argc - optind == 3 ? argv[optind + 2] : "");
}

static int alarms_unshelve(struct ctl *ctl, int argc, char **argv)
{
	ctl_option(ctl, argc, argv, "");
	if (optind == argc)
		return ctl_usage(ctl, "alarms unshelve takes names");
	return shelve_names(ctl, argc - optind, argv + optind, 0, "");
}

/* --- The word -------------------------------------------------------------------------------- */

const struct alarms_word alarms_words[] = {
	{"history", journal_alarms},
	{"ack", alarms_ack},
	{"shelve", alarms_shelve},
	{"unshelve", alarms_unshelve},
	{0},
};

int verb_alarms(struct ctl *ctl, int argc, char **argv)
{
	for (const struct alarms_word *w = alarms_words; argc > 1 && w->word; w++)
		if (strcmp(argv[1], w->word) == 0)
			return w->run(ctl, argc - 1, argv + 1);
	return alarms_live(ctl, argc, argv);
}
