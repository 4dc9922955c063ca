/* SPDX-License-Identifier: MIT */
/* owsctl metrics: prints what an instance has for programs that collect metrics. */
#include <getopt.h>
#include <limits.h>
#include <stdio.h>

#include "src/faces/show/metrics.h"
#include "src/faces/show/names.h"
#include "src/tool/owsctl/ctl.h"
#include "src/tool/owsctl/verbs.h"

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
	    !names_some(metrics.h, metrics.patterns, metrics.pattern_count))
		status = ctl_fail("no signal matches");
	else
		metrics_print(stdout, &metrics, &at, INT_MAX);
	ows_close(metrics.h);
	return status;
}
