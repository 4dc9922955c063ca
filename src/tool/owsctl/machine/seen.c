/* SPDX-License-Identifier: MIT */
/*
 * What owsctl doctor reads of a machine. All paths begin with the folder `root`, and what commands
 * of the system print is a file there, so that a recorded machine is as good as its own.
 */
#include <grp.h>
#include <stdio.h>
#include <string.h>

#include "hal/base/time.h"
#include "src/tool/owsctl/machine/command.h"
#include "src/tool/owsctl/machine/seen.h"

/* A systemd that hangs is no reason to say nothing of the rest. */
#define COMMAND_NS (30 * NS_PER_S)

bool seen_output(struct doctor *d, const char *name, const char *const words[])
{
	char path[512];
	size_t len;
	FILE *in;

	if (!*d->root)
		return command_output(words, ows_now() + COMMAND_NS, d->text, sizeof(d->text));
	snprintf(path, sizeof(path), "%s/recorded/%s", d->root, name);
	in = fopen(path, "re");
	len = in ? fread(d->text, 1, sizeof(d->text) - 1, in) : 0;
	d->text[len] = '\0';
	if (in)
		fclose(in);
	return in != NULL;
}

bool seen_in_group(const char *root, const char *user, const char *group)
{
	char path[512];
	struct group *entry;
	bool found = false;
	FILE *in;

	snprintf(path, sizeof(path), "%s/etc/group", root);
	in = fopen(path, "re");
	while (in && !found && (entry = fgetgrent(in)))
		for (char **member = entry->gr_mem; !strcmp(entry->gr_name, group) && *member;
		     member++)
			found |= !strcmp(*member, user);
	if (in)
		fclose(in);
	return found;
}
