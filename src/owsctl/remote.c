/* SPDX-License-Identifier: MIT */
/* Runs the same verb on another machine, over ssh. */
#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "src/owsctl/remote.h"
#include "src/owsctl/verbs.h"

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

/* HOST or USER@HOST, and nothing that ssh or a command of its configuration takes for more. */
static bool is_host(const char *host)
{
	const char *at = strrchr(host, '@'), *name = at ? at + 1 : host;

	return *name && *host != '-' && *name != '-' && *host != '@' &&
	       strspn(host, HOST_LETTERS) == strlen(host);
}

int remote_run(const struct ctl *ctl, int argc, char **argv)
{
	size_t name_len = strcspn(ctl->instance, "@"), size = 0;
	const char *host = ctl->instance + name_len + 1;
	bool screen = ctl->verb->run == verb_watch && isatty(STDIN_FILENO) && isatty(STDOUT_FILENO);
	/* a loop that reads names and runs owsctl for each keeps its input */
	const char *input = screen ? "-t" : ctl->verb->run == verb_control ? "-T" : "-n";
	char *text = NULL;
	FILE *command;
	bool whole;

	if (!is_host(host))
		return ctl_usage(ctl, "-n %s: expected NAME@HOST or NAME@USER@HOST", ctl->instance);
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
