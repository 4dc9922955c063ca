/* SPDX-License-Identifier: MIT */
/* owsctl write: a value to a path of a target. */
#include <getopt.h>
#include <string.h>

#include "src/tool/owsctl/open.h"
#include "src/tool/owsctl/verbs.h"

int verb_write(struct ctl *ctl, int argc, char **argv)
{
	int64_t timeout_ns = OPEN_TIMEOUT_NS;
	struct target target;
	struct served served;
	char path[256], words[ERROR_WORDS];
	bool fresh;
	struct ask ask = {.req = {.op = BUS_WRITE, .prio = BUS_OUTPUT, .path = path}};
	int status;

	/* A value may begin with "-". */
	target_option(ctl, argc, argv, "+", &timeout_ns);
	if (argc - optind != 2)
		return ctl_usage(ctl, "expected a path and a value");
	if (!target_path(argv[optind], path, &fresh))
		return ctl_usage(ctl, "the path is longer than %d bytes", 255);
	status = open_target(ctl, timeout_ns, &target, &served);
	if (status)
		return status;
	ask.req.fresh = fresh;
	ask.req.data = (uint8_t *)argv[optind + 1];
	ask.req.len = (uint32_t)strlen(argv[optind + 1]);
	if (target_ask_one(&target, &ask))
		status = ctl_fail("%s: %s%s", argv[optind], error_words(ask.answer.err, words),
		                  open_asked(ctl, &target, &served));
	target_close(&target);
	return status;
}
