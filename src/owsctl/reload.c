/* SPDX-License-Identifier: MIT */
/* owsctl reload: asks owsd to load its configuration again. */
#include <errno.h>
#include <getopt.h>
#include <string.h>

#include "hal/base/time.h"
#include "src/owsctl/ctl.h"
#include "src/owsctl/verbs.h"

#define WAIT_NS (30 * NS_PER_S)

static int reload_fail(const char *name, int err)
{
	switch (-err) {
	case ENOENT:
		return ctl_fail("owsd %s is not running", name);
	case EACCES:
		return ctl_fail("no right to reload %s: that is for root, the user of owsd and, of "
		                "the service, group owsd-config",
		                name);
	case ENOSPC:
		return ctl_fail("%s: too many programs wait for a reload: try again", name);
	case ETIMEDOUT:
		return ctl_fail("%s has not reloaded in time: its log shows what became of it",
		                name);
	case ENOTCONN:
		return ctl_fail("owsd %s has ended", name);
	case EPROTO:
		return ctl_fail("owsd %s is too old to be asked: send it SIGHUP", name);
	case EINVAL:
		return ctl_fail("%s: this is no name of an instance, or OWS_DIR is not a path",
		                ctl_word(name));
	default:
		return ctl_fail("%s: %s", name, strerror(-err));
	}
}

int verb_reload(struct ctl *ctl, int argc, char **argv)
{
	int64_t limit_ns = WAIT_NS;
	char why[256];
	int c, err;

	while ((c = ctl_option(ctl, argc, argv, "w:")) != -1)
		limit_ns = ctl_option_seconds(ctl, c);
	if (optind < argc)
		return ctl_usage(ctl, "reload takes no names");
	err = ows_reload(ctl->instance, limit_ns, why, sizeof(why));
	if (err && *why)
		return ctl_fail("owsd refuses the configuration, and all goes on as before: %s",
		                why);
	return err ? reload_fail(ctl->instance, err) : CTL_DONE;
}
