/* SPDX-License-Identifier: MIT */
/* A history is opened and closed, with words for what is wrong. */
#include <errno.h>
#include <string.h>

#include "src/owsctl/past.h"

#define PLACE 512

static const char *advice(int err)
{
	return err == -ENOENT            ? "; does owsd-recorder run?"
	       : err == -EPROTONOSUPPORT ? "; its file is of a newer owsd"
	       : err == -ENOSYS          ? "; this owsctl was built without SQLite"
	                                 : "";
}

int past_open(const struct ctl *ctl, const char *directory, struct ows_history **h)
{
	char place[PLACE];
	int err = 0;

	if (!directory) {
		err = ows_history_place(ctl->instance, place, sizeof(place));
		directory = err ? ctl->instance : place;
	}
	if (!err)
		err = ows_history_open(NULL, directory, h);
	if (err)
		return ctl_fail("%s: %s%s", directory, strerror(-err), advice(err));
	return CTL_DONE;
}

int past_look(const struct ctl *ctl, const char *directory, struct ows_history **h)
{
	char place[PLACE];
	int err;

	*h = NULL;
	if (directory)
		return past_open(ctl, directory, h);
	if (ows_history_place(ctl->instance, place, sizeof(place)) != 0)
		return CTL_DONE;
	err = ows_history_open(NULL, place, h);
	if (err && err != -ENOENT && err != -ENOTDIR)
		ctl_fail("%s: %s", place, strerror(-err));
	return CTL_DONE;
}

int past_signal(struct ows_history *h, const char *name, struct ows_history_signal *known)
{
	int signal = ows_history_find(h, name);
	int err = signal < 0 ? signal : ows_history_signal(h, signal, known);

	return err ? err : signal;
}

int past_fail(const char *what, int err)
{
	return ctl_fail("%s: %s", what, strerror(-err));
}
