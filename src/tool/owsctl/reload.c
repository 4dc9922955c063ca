/* SPDX-License-Identifier: MIT */
/* owsctl reload: asks owsd to load its configuration again. */
#include <errno.h>
#include <getopt.h>
#include <stdio.h>
#include <string.h>

#include "hal/base/time.h"
#include "src/faces/show/faces.h"
#include "src/tool/owsctl/ctl.h"
#include "src/tool/owsctl/verbs.h"

#define WAIT_NS (30 * NS_PER_S)
/* From the begin on; faces follow within moments, and report it. */
#define FACES_NS (3 * NS_PER_S)

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

/* Faces read the file when owsd has reloaded it. */
static bool all_have_loaded(const struct faces_one *faces, unsigned count, int64_t begin_ns)
{
	for (unsigned i = 0; i < count; i++)
		if (!faces_silent(&faces[i], begin_ns) && faces[i].loaded_ns < begin_ns)
			return false;
	return true;
}

/* What its report says is wrong, since then; a program that is connected has told what is over. */
static const char *trouble_since(const struct faces_one *face, int64_t begin_ns)
{
	bool old = face->since_ns || (face->trouble_ns && face->trouble_ns < begin_ns);

	return old ? "" : face->trouble;
}

static void print_faces(const char *instance, int64_t begin_ns)
{
	struct faces_one faces[FACES_MOST];
	unsigned count = faces_read(instance, faces);

	while (!all_have_loaded(faces, count, begin_ns) && ows_now() - begin_ns < FACES_NS) {
		ctl_nap();
		count = faces_read(instance, faces);
	}
	for (unsigned i = 0; i < count; i++) {
		const struct faces_one *face = &faces[i];
		const char *trouble = trouble_since(face, begin_ns);

		if (faces_silent(face, begin_ns))
			printf("%s: does not run\n", face->program);
		else if (face->loaded_ns < begin_ns)
			printf("%s: has not reloaded yet: restart it, or look into its log\n",
			       face->program);
		else if (*face->refused)
			printf("%s: goes on as before: %s\n", face->program, face->refused);
		else
			printf("%s: reloaded%s%s\n", face->program, *trouble ? "; " : "", trouble);
	}
}

int verb_reload(struct ctl *ctl, int argc, char **argv)
{
	int64_t limit_ns = WAIT_NS, begin_ns = ows_now();
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
	if (err)
		return reload_fail(ctl->instance, err);
	if (*why)
		printf("owsd %s: reloaded, with %s; owsd --check and owsctl doctor show all\n",
		       ctl->instance, why);
	else
		printf("owsd %s: reloaded\n", ctl->instance);
	print_faces(ctl->instance, begin_ns);
	return CTL_DONE;
}
