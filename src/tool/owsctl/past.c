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

/*
 * Does owsd call a signal so now? Then it is that one which counts, also where the recorder has not
 * written the name yet: *index is its index in the history. -ENOENT: the history has nothing of it,
 * and what it calls so has another name by now.
 */
static bool find_live(struct ows_history *h, const char *instance, const char *name, int *index)
{
	struct ows_history_signal known = {.identity = ""};
	bool is_live = false, is_another = false;
	struct ows *live = NULL;
	struct ows_info info;
	int now = -ENOENT;

	if (ows_open(instance, OWS_READ, &live))
		return false;
	if (*index >= 0)
		ows_history_signal(h, *index, &known);
	for (int i = 0; !ows_info(live, i, &info); i++)
		if (*info.identity && !strcmp(info.name, name)) {
			is_live = true;
			now = ows_history_find(h, info.identity);
		} else {
			is_another |= *info.identity && !strcmp(info.identity, known.identity);
		}
	ows_close(live);
	if (is_live && (now >= 0 || is_another))
		*index = now;
	return is_live;
}

int past_signal(struct ows_history *h, const char *instance, const char *name,
                struct ows_history_signal *known)
{
	size_t skip = strlen(instance);
	int index = ows_history_find(h, name), err;
	bool is_live;

	if (index == -ENOENT && !strncmp(name, instance, skip) && !strncmp(name + skip, "__", 2)) {
		name += skip + 2;
		index = ows_history_find(h, name);
	}
	is_live = find_live(h, instance, name, &index);
	err = index < 0 ? index : ows_history_signal(h, index, known);
	if (err)
		return err;
	if (is_live)
		known->name = name;
	return index;
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
