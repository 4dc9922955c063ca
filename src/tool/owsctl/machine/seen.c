/* SPDX-License-Identifier: MIT */
/*
 * What owsctl doctor reads of a machine. All paths begin with the folder `root`, and what commands
 * of the system print is a file there, so that a recorded machine is as good as its own.
 */
#include <errno.h>
#include <grp.h>
#include <stdio.h>
#include <stdlib.h>
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

bool seen_listens(const char *root, unsigned port)
{
	static const char *const files[] = {"tcp", "tcp6"};
	char path[512], line[256], at[5], state[3];
	bool found = false;

	for (size_t i = 0; i < sizeof(files) / sizeof(files[0]); i++) {
		snprintf(path, sizeof(path), "%s/proc/net/%s", root, files[i]);
		FILE *in = fopen(path, "re");

		/* "  0: 0100007F:10D0 00000000:0000 0A": 0A is a listener */
		while (in && !found && fgets(line, sizeof(line), in))
			found = sscanf(line, " %*[0-9]: %*[0-9A-F]:%4[0-9A-F] %*s %2[0-9A-F]", at,
			               state) == 2 &&
			        strtoul(at, NULL, 16) == port && !strcmp(state, "0A");
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
	const char *unit = seen_automatic(d) ? "systemd/system/*.wants/owserver.s*"
	                                     : "systemd/system/owserver.service";
	char text[TARGET_CANONICAL], *host = text + strlen("owserver:"), *port;
	glob_t found;
	bool installed;

	target_canonical(target, text);
	port = strrchr(text, ':');
	if (strncmp(text, "owserver:", strlen("owserver:")) != 0 || port <= host)
		return false;
	*port++ = '\0';
	/* at another port it is maybe not that of the package */
	if (strcmp(port, "4304") != 0)
		return false;
	if (strcmp(host, "localhost") != 0 && strncmp(host, "127.", 4) != 0 &&
	    strcmp(host, "[::1]") != 0)
		return false;
	installed = faces_files(d->root, unit, &found) > 0;
	globfree(&found);
	return installed && !seen_listens(d->root, (unsigned)strtoul(port, NULL, 10));
}
