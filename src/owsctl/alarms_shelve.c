/* SPDX-License-Identifier: MIT */
/* owsctl alarms shelve and unshelve: hides limit alarms for a time, and shows them again. */
#include <errno.h>
#include <getopt.h>
#include <string.h>

#include "hal/bus/time.h"
#include "src/owsctl/alarms_shelve.h"
#include "src/owsctl/ctl.h"
#include "src/show/when.h"

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
static int request(struct ctl *ctl, int count, char **names, uint32_t seconds, const char *why)
{
	int status, id, err;
	struct ows *h;

	status = ctl_open(ctl, OWS_CONTROL, &h);
	if (status)
		return status;
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

int alarms_shelve(struct ctl *ctl, int argc, char **argv)
{
	int64_t ns;

	ctl_options();
	if (ctl_option(ctl, argc, argv, "") != -1)
		return CTL_USAGE;
	if (argc - optind != 2 && argc - optind != 3)
		return ctl_usage(ctl, "alarms shelve takes a name, a time and perhaps a reason");
	if (!when_parse(argv[optind + 1], &ns) || ns < NS_PER_S || ns > OWS_SHELVE_MAX * NS_PER_S)
		return ctl_usage(ctl,
		                 "%s is no time to shelve an alarm: seconds, or as 30m, 8h or 2d; "
		                 "at most 7d",
		                 ctl_word(argv[optind + 1]));
	return request(ctl, 1, argv + optind, (uint32_t)(ns / NS_PER_S),
	               argc - optind == 3 ? argv[optind + 2] : "");
}

int alarms_unshelve(struct ctl *ctl, int argc, char **argv)
{
	ctl_options();
	if (ctl_option(ctl, argc, argv, "") != -1)
		return CTL_USAGE;
	if (optind == argc)
		return ctl_usage(ctl, "alarms unshelve takes names");
	return request(ctl, argc - optind, argv + optind, 0, "");
}
