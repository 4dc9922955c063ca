/* SPDX-License-Identifier: MIT */
/*
 * owsctl record: a recording of what a verb makes a target do. Each line is in the file at once;
 * where ids are made anonymous the file is written at the end, as all ids have to be known.
 */
#include <errno.h>
#include <getopt.h>
#include <signal.h>
#include <string.h>
#include <unistd.h>

#include "hal/base/time.h"
#include "hal/bus/backends.h"
#include "hal/trace/trace.h"
#include "src/tool/owsctl/ctl.h"
#include "src/tool/owsctl/verbs.h"

#define SHOWN_NS (NS_PER_S / 5) /* the pause between two prints of how far it is */
#define FAILED_NS NS_PER_S      /* ... and after a failure: a target may be refused at once */

static volatile sig_atomic_t interrupted;

static void interrupt(int signal)
{
	(void)signal;
	interrupted = true;
}

/* On a terminal, how far it is. */
static void show_progress(const struct trace *trace)
{
	static int64_t shown_ns;
	int64_t now_ns = ows_now();

	if (now_ns - shown_ns < SHOWN_NS || !isatty(STDERR_FILENO))
		return;
	shown_ns = now_ns;
	fprintf(stderr, "\rrecording: %u lines, %zu KiB, %.1f s\033[K\r", trace->lines,
	        (TRACE_MOST - trace->left) / 1024, (double)(now_ns - trace->since_ns) / 1e9);
}

/* A remark; with the target's kind alone where its address is to be hidden. */
static void write_command(FILE *file, const struct ctl *ctl, bool anonymous, char **argv)
{
	const char *target = ctl->target ? ctl->target : "owserver";

	if (anonymous && strcmp(target, "auto") != 0)
		target = bus_backend(target, NULL)->scheme;
	fprintf(file, "# owsctl " OWSD_VERSION " -t %s", target);
	for (; *argv; argv++) {
		fputc(' ', file);
		for (const char *c = *argv; *c; c++)
			fputc((unsigned char)*c < ' ' ? '?' : *c, file);
	}
	fputc('\n', file);
}

/* The verb, once or until the time is over; its results are printed the first time alone. */
static int record_verb(const struct trace *trace, int64_t until_ns, struct ctl *ctl, int argc,
                       char **argv)
{
	int status = ctl_run(ctl, argc, argv), last = status;

	while (last != CTL_USAGE && !interrupted && trace->left && ows_now() < until_ns) {
		if (last)
			clock_pause(FAILED_NS);
		if (interrupted || !freopen("/dev/null", "w", stdout))
			break;
		last = ctl_run(ctl, argc, argv);
		status = status ? status : last;
	}
	return status;
}

static int end_recording(struct trace *trace, FILE *file, const char *name, bool anonymous)
{
	bool is_full = !trace->left;
	int lines = trace_end(trace);

	if (isatty(STDERR_FILENO))
		fputs("\033[K", stderr);
	if (ferror(file) || fclose(file) || lines < 0)
		return ctl_fail("%s: cannot be written", name);
	if (!lines && !unlink(name))
		return ctl_fail("nothing went over a wire: there is no %s", name);
	ctl_tell("%s has %d lines%s%s", name, lines, anonymous ? ", without your ids" : "",
	         is_full ? "; it is full: what followed is left out" : "");
	return CTL_DONE;
}

int verb_record(struct ctl *ctl, int argc, char **argv)
{
	static char word[] = "scan", *scan[] = {word, NULL};
	bool anonymous = false, i2c = false;
	int64_t until_ns = 0;
	struct trace *trace;
	const char *name;
	FILE *file;
	int c, status;

	while ((c = ctl_option(ctl, argc, argv, "+NQE:")) != -1)
		if (c == 'E')
			until_ns = ows_now() + ctl_option_seconds(ctl, c);
		else
			*(c == 'N' ? &anonymous : &i2c) = true;
	if (optind == argc)
		return ctl_usage(ctl, "record to which file?");
	if (i2c && anonymous)
		return ctl_usage(ctl, "--i2c shows ids byte by byte: leave it out or --anonymous");
	name = argv[optind++];
	argc -= optind;
	argv = argc ? argv + optind : scan;
	argc += !argc;
	const struct verb *verb = ctl->find(argv[0]);
	if (!verb || !verb->opens || verb == ctl->verb)
		return ctl_usage(ctl, "%s opens no target: name scan, dir, read or write",
		                 ctl_word(argv[0]));
	/* the remark has these words, and no address */
	for (int i = 1; i < argc; i++)
		if (argv[i][0] == '-' && argv[i][1] != '-' && strchr(argv[i], 't'))
			return ctl_usage(ctl, "-t stands before the file");
	file = fopen(name, "wxe");
	if (!file && errno == EEXIST)
		return ctl_fail("%s is there already: name a new file", ctl_word(name));
	if (!file)
		return ctl_fail("%s: %s", ctl_word(name), strerror(errno));
	setvbuf(file, NULL, _IOLBF, BUFSIZ);
	trace = ctl_need(trace_record(file, i2c, anonymous));
	trace->progress = show_progress;
	write_command(trace->file, ctl, anonymous, argv);
	ctl->tap = &trace->tap;
	ctl->verb = verb;
	sigaction(SIGINT,
	          &(struct sigaction){.sa_handler = interrupt, .sa_flags = (int)SA_RESETHAND},
	          NULL);
	status = record_verb(trace, until_ns, ctl, argc, argv);
	c = end_recording(trace, file, name, anonymous);
	return status ? status : c;
}
