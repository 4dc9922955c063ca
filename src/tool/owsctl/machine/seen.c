/* SPDX-License-Identifier: MIT */
/*
 * What owsctl doctor reads of a machine. All paths begin with the folder `root`, and what commands
 * of the system print is a file there, so that a recorded machine is as good as its own.
 */
#include <errno.h>
#include <fnmatch.h>
#include <grp.h>
#include <stdio.h>
#include <string.h>

#include "hal/base/time.h"
#include "src/config/check/targets.h"
#include "src/config/read/config.h"
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

/* All users of owsd begin so. */
static bool is_person(const char *user)
{
	return strcmp(user, "owsd") != 0 && strncmp(user, "owsd-", 5) != 0;
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
			found |= user ? !strcmp(*member, user) : is_person(*member);
	if (in)
		fclose(in);
	return found;
}

bool seen_owserver(const char *root)
{
	static const char *const files[] = {"tcp", "tcp6"};
	char path[512], line[256], port[5], state[3];
	bool found = false;

	for (size_t i = 0; i < sizeof(files) / sizeof(files[0]); i++) {
		snprintf(path, sizeof(path), "%s/proc/net/%s", root, files[i]);
		FILE *in = fopen(path, "re");

		/* "  0: 0100007F:10D0 00000000:0000 0A": port 4304, and 0A is a listener */
		while (in && !found && fgets(line, sizeof(line), in))
			found = sscanf(line, " %*[0-9]: %*[0-9A-F]:%4[0-9A-F] %*s %2[0-9A-F]", port,
			               state) == 2 &&
			        !strcmp(port, "10D0") && !strcmp(state, "0A");
		if (in)
			fclose(in);
	}
	return found;
}

bool seen_automatic(const struct doctor *d)
{
	return d->config ? d->config->target_count && d->config->targets[0].automatic
	                 : d->err == -ENOENT;
}

bool seen_owserver_stopped(const struct doctor *d, const char *target)
{
	/* at another port it is maybe not that of the package */
	static const char *const local[] = {"owserver:localhost:4304", "owserver:127.*:4304",
	                                    "owserver:\\[::1]:4304"};
	const char *unit = seen_automatic(d) ? "systemd/system/*.wants/owserver.s*"
	                                     : "systemd/system/owserver.service";
	char text[TARGET_CANONICAL];
	bool is = false;
	glob_t found;

	target_canonical(target, text);
	for (size_t i = 0; i < sizeof(local) / sizeof(local[0]); i++)
		is |= !fnmatch(local[i], text, 0);
	is &= faces_files(d->root, unit, &found) > 0;
	globfree(&found);
	return is && !seen_owserver(d->root);
}
