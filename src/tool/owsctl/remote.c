/* SPDX-License-Identifier: MIT */
/* Runs the same verb on another machine, over ssh. */
#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "src/tool/owsctl/remote.h"
#include "src/tool/owsctl/verbs.h"

#define HOST_LETTERS "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_.-:%@"

/* ssh hands one text to the shell of the other machine: every word stands in quotes. */
static void quote(FILE *command, const char *word, size_t len)
{
	fputs(" '", command);
	for (size_t i = 0; i < len; i++)
		if (word[i] == '\'')
			fputs("'\\''", command);
		else
			putc(word[i], command);
	putc('\'', command);
}

/*
 * HOST or USER@HOST, and nothing that ssh or a command of its configuration takes for more. Else
 * why has the part that is wrong.
 */
static bool is_host(const char *host, char *why, size_t size)
{
	const char *at = strrchr(host, '@'), *name = at ? at + 1 : host;
	const char *colon = strchr(name, ':'), *odd = host + strspn(host, HOST_LETTERS);

	if (*host == '@' || *host == '-')
		snprintf(why, size, "%s",
		         *host == '@' ? "a user is missing" : "the host begins with -");
	else if (!*name || *name == '-')
		snprintf(why, size, "the host %s", *name ? "begins with -" : "is missing");
	else if (*odd)
		snprintf(why, size, "no host has \"%.1s\" in its name", odd);
	else if (colon && !strchr(colon + 1, ':')) /* more of them: IPv6 */
		snprintf(why, size,
		         "%s is no host; write the port into ~/.ssh/config, for Host %.*s", name,
		         (int)(colon - name), name);
	else
		return true;
	return false;
}

int remote_run(const struct ctl *ctl, int argc, char **argv)
{
	size_t name_len = strcspn(ctl->instance, "@"), size = 0;
	const char *host = ctl->instance + name_len + 1;
	bool screen = ctl->verb->run == verb_watch && isatty(STDIN_FILENO) && isatty(STDOUT_FILENO);
	/* a loop that reads names and runs owsctl for each keeps its input */
	const char *input = screen ? "-t" : ctl->verb->run == verb_control ? "-T" : "-n";
	char *text = NULL, why[400];
	FILE *command;
	bool whole;

	if (!is_host(host, why, sizeof(why)))
		return ctl_usage(ctl, "-n %s: expected NAME@HOST or NAME@USER@HOST: %s",
		                 ctl->instance, why);
	command = open_memstream(&text, &size);
	if (!command)
		return ctl_fail("%s", strerror(errno));
	fputs("owsctl", command);
	if (name_len) {
		fputs(" -n", command);
		quote(command, ctl->instance, name_len);
	}
	if (ctl->target) {
		fputs(" -t", command);
		quote(command, ctl->target, strlen(ctl->target));
	}
	if (ctl->json)
		fputs(" --json", command);
	for (int i = 0; i < argc; i++)
		quote(command, argv[i], strlen(argv[i]));
	whole = !ferror(command);
	if (fclose(command) || !whole) {
		free(text);
		return ctl_fail("%s", strerror(ENOMEM));
	}
	signal(SIGPIPE, SIG_DFL);
	signal(SIGXFSZ, SIG_DFL);
	execlp("ssh", "ssh", input, "--", host, text, (char *)NULL);
	ctl_fail("ssh: %s", strerror(errno));
	free(text);
	return CTL_FAILED;
}
