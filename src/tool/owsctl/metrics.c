/* SPDX-License-Identifier: MIT */
/* owsctl metrics: prints what an instance has for programs that collect metrics. */
#include <getopt.h>
#include <limits.h>
#include <stdio.h>

#include "src/faces/show/metrics.h"
#include "src/faces/show/names.h"
#include "src/tool/owsctl/ctl.h"
#include "src/tool/owsctl/verbs.h"

static bool any_matches(struct ows *h, char *const *patterns, int count)
{
	struct ows_info info;

	for (int i = 0; ows_info(h, i, &info) == 0; i++)
		if (names_match(info.name, patterns, count))
			return true;
	return false;
}

int verb_metrics(struct ctl *ctl, int argc, char **argv)
{
	struct metrics metrics = {.instance = ctl->instance};
	int status = CTL_DONE, at = 0;

	while (ctl_option(ctl, argc, argv, "p") != -1)
		metrics.prometheus = true;
	if (ctl->json)
		return ctl_usage(ctl, "metrics are text; stats and list have --json");
	metrics.patterns = argv + optind;
	metrics.pattern_count = argc - optind;
	metrics.h = ctl_open(ctl, OWS_READ);
	if (metrics.pattern_count > 0 &&
	    !any_matches(metrics.h, metrics.patterns, metrics.pattern_count))
		status = ctl_fail("no signal matches");
	else
		metrics_print(stdout, &metrics, &at, INT_MAX);
	ows_close(metrics.h);
	return status;
}
