/* SPDX-License-Identifier: MIT */
/* A history is opened and closed, with words for what is wrong. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "src/config/read/config.h"
#include "src/config/read/load.h"
#include "src/ground/text/distance.h"
#include "src/tool/owsctl/past.h"
#include "src/tool/owsctl/running.h"

#define PLACE 512

static const char *advice_on_history(int err)
{
	return err == -ENOENT
	               ? "; does owsd-recorder run? -d DIR names its Directory, if it has one"
	       : err == -EBADMSG
	               ? "; history.sqlite is damaged, empty (was the disk full?) or no history"
	       : err == -EPROTONOSUPPORT
	               ? "; its file is of another version of owsd, or owsd-recorder has not run since"
	       : err == -ENOSYS ? "; this owsctl was built without SQLite"
	                        : "";
}

/* Where the recorder of the instance keeps it: as Directory says, or the default. */
static int find_history(const char *instance, char place[PLACE])
{
	struct config_report silent = {0};
	char file[INSTANCE_FIELD];
	struct config *config;
	int err = ows_history_place(instance, place, PLACE);

	if (err == -EINVAL)
		return err;
	instance_config(instance, file);
	if (config_load(file, &silent, &config))
		return err;
	if (config->recorder.directory)
		err = snprintf(place, PLACE, "%s", config->recorder.directory) < PLACE
		              ? 0
		              : -ENAMETOOLONG;
	config_free(config);
	return err;
}

int past_open(const struct ctl *ctl, const char *directory, struct ows_history **h)
{
	char place[PLACE];
	int err = 0;

	if (!directory) {
		err = find_history(ctl->instance, place);
		directory = err ? ctl->instance : place;
	}
	if (!err)
		err = ows_history_open(NULL, directory, h);
	if (err)
		return ctl_fail("%s: %s%s", directory, strerror(-err), advice_on_history(err));
	return CTL_DONE;
}

int past_look(const struct ctl *ctl, const char *directory, struct ows_history **h)
{
	char place[PLACE];
	int err;

	*h = NULL;
	if (directory)
		return past_open(ctl, directory, h);
	if (find_history(ctl->instance, place) != 0)
		return CTL_DONE;
	err = ows_history_open(NULL, place, h);
	if (err && err != -ENOENT && err != -ENOTDIR)
		ctl_fail("%s: %s", place, strerror(-err));
	return CTL_DONE;
}

/* The recorder may not have written yet what owsd calls so now. */
static int find_live(struct ows_history *h, const char *instance, const char *name)
{
	struct ows *live = NULL;
	struct ows_info info;
	int signal = -ENOENT;

	if (ows_open(instance, OWS_READ, &live))
		return -ENOENT;
	for (int i = 0; signal == -ENOENT && !ows_info(live, i, &info); i++)
		if (!strcmp(info.name, name) && *info.identity)
			signal = ows_history_find(h, info.identity);
	ows_close(live);
	return signal;
}

int past_signal(struct ows_history *h, const char *instance, const char *name,
                struct ows_history_signal *known)
{
	size_t skip = strlen(instance);
	int signal, live, err;

	if (!strncmp(name, instance, skip) && !strncmp(name + skip, "__", 2) &&
	    ows_history_find(h, name) == -ENOENT)
		name += skip + 2;
	live = find_live(h, instance, name);
	signal = live < 0 ? ows_history_find(h, name) : live;
	err = signal < 0 ? signal : ows_history_signal(h, signal, known);
	if (err)
		return err;
	if (live >= 0)
		known->name = name;
	return signal;
}

int past_unknown(const struct ctl *ctl, struct ows_history *h, const char *name)
{
	unsigned best = text_too_far(name);
	struct ows_history_signal signal;
	const char *nearest = NULL;
	struct ows *live = NULL;
	struct ows_info info;
	bool known = false;

	for (int i = 0; !ows_history_signal(h, i, &signal); i++)
		if (text_nearer(name, signal.name, &best))
			nearest = signal.name;
	/* what owsd has, the recorder may not have written yet */
	if (ows_open(ctl->instance, OWS_READ, &live) == 0)
		for (int i = 0; !ows_info(live, i, &info); i++) {
			known |= !strcmp(info.name, name);
			if (text_nearer(name, info.name, &best))
				nearest = info.name;
		}
	if (known)
		ctl_fail("the history has nothing of %s yet: owsd-recorder writes every ten "
		         "minutes, or as Flush says",
		         name);
	else if (nearest)
		ctl_fail("the history has no signal %s; did you mean %s?", name, nearest);
	else
		ctl_fail("the history has no signal %s", ctl_word(name));
	ows_close(live);
	return CTL_FAILED;
}

const char *past_word(const struct ows_history_item *item)
{
	return item->known ? ows_quality_text(item->quality)
	                   : ows_history_reason_text(item->reason);
}

int past_fail(const char *what, int err)
{
	return ctl_fail("%s: %s", what, strerror(-err));
}
