/* SPDX-License-Identifier: MIT */
/*
 * owsctl record: a recording of what a verb makes a target do. Each line is in the file at once;
 * where ids are made anonymous the file is written at the end, as all ids have to be known.
 */
#include <errno.h>
#include <fcntl.h>
#include <getopt.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>
#include <unistd.h>

#include "hal/base/time.h"
#include "hal/bus/backends.h"
#include "hal/trace/anonymous.h"
#include "hal/trace/tap.h"
#include "src/tool/owsctl/ctl.h"
#include "src/tool/owsctl/verbs.h"

#define SHOWN_NS (NS_PER_S / 5) /* the pause between two prints of how far it is */

static volatile sig_atomic_t interrupted;

static void interrupt(int signal)
{
	(void)signal;
	interrupted = true;
}

struct recording {
	struct trace trace; /* first */
	FILE *file;         /* that of the user */
	char *text;         /* what is to be made anonymous */
	size_t len;
	bool anonymous, i2c;
	int64_t until_ns, shown_ns;
};

/* On a terminal, how far it is. */
static void show_progress(const struct trace *trace)
{
	struct recording *recording = (struct recording *)(uintptr_t)trace;
	int64_t now_ns = ows_now();

	if (now_ns - recording->shown_ns < SHOWN_NS || !isatty(STDERR_FILENO))
		return;
	recording->shown_ns = now_ns;
	fprintf(stderr, "\rrecording: %u lines, %zu KiB, %.1f s\033[K", trace->lines,
	        (TRACE_MOST / 2 - trace->left) / 1024, (double)(now_ns - trace->since_ns) / 1e9);
}

static int open_recording(struct recording *recording, const char *name)
{
	int fd = open(name, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOCTTY, 0666);
	FILE *file;

	if (fd < 0 && errno == EEXIST)
		return ctl_fail("%s is there already: name a new file", ctl_word(name));
	recording->file = fd < 0 ? NULL : fdopen(fd, "w");
	if (!recording->file)
		return ctl_fail("%s: %s", ctl_word(name), strerror(errno));
	file = recording->anonymous ? open_memstream(&recording->text, &recording->len)
	                            : recording->file;
	if (!file)
		return ctl_fail("no memory");
	setvbuf(recording->file, NULL, _IOLBF, BUFSIZ);
	trace_record(&recording->trace, file, recording->i2c);
	recording->trace.progress = show_progress;
	return CTL_DONE;
}

/* A remark; with the target's kind alone where its address is to be hidden. */
static void write_command(const struct recording *recording, const struct ctl *ctl, int argc,
                          char **argv)
{
	const char *where, *target = ctl->target ? ctl->target : "owserver";
	FILE *file = recording->trace.file;

	if (recording->anonymous && strcmp(target, "auto") != 0)
		target = bus_backend(target, &where)->scheme;
	fprintf(file, "# owsctl " OWSD_VERSION " -t %s", target);
	for (int i = 0; i < argc; i++) {
		fputc(' ', file);
		for (const char *c = argv[i]; *c; c++)
			fputc((unsigned char)*c < ' ' ? '?' : *c, file);
	}
	fputc('\n', file);
}

static int close_recording(struct recording *recording, const char *name)
{
	uint8_t mask[TRACE_MASK];
	bool failed = false;

	trace_end(&recording->trace);
	if (recording->anonymous) {
		failed = fclose(recording->trace.file) ||
		         getrandom(mask, sizeof(mask), 0) != sizeof(mask);
		if (!failed) {
			trace_anonymous(recording->text, mask);
			fputs(recording->text, recording->file);
		}
		free(recording->text);
	}
	failed |= ferror(recording->file) || fclose(recording->file);
	if (recording->shown_ns)
		fputs("\r\033[K", stderr);
	if (failed)
		return ctl_fail("%s: cannot be written", name);
	if (!recording->trace.lines && !unlink(name))
		return ctl_fail("nothing went over a wire: there is no %s", name);
	ctl_tell("%s has %u lines%s%s", name, recording->trace.lines,
	         recording->anonymous ? ", without your ids" : "",
	         recording->trace.left ? "" : "; it is full: what followed is left out");
	return CTL_DONE;
}

/* The verb, once or until the time is over; what it prints the first time alone. */
static int record_verb(struct recording *recording, struct ctl *ctl, int argc, char **argv)
{
	int status = ctl_run(ctl, argc, argv);

	while (!interrupted && recording->trace.left && ows_now() < recording->until_ns) {
		if (!freopen("/dev/null", "w", stdout))
			break;
		int again = ctl_run(ctl, argc, argv);

		if (again == CTL_USAGE)
			break;
		status = status ? status : again;
	}
	return status;
}

int verb_record(struct ctl *ctl, int argc, char **argv)
{
	static char word[] = "scan", *scan[] = {word, NULL};
	static struct recording recording; /* too large for a stack */
	const char *name;
	int c, status;

	memset(&recording, 0, sizeof(recording));
	while ((c = ctl_option(ctl, argc, argv, "+NQE:")) != -1)
		if (c == 'N')
			recording.anonymous = true;
		else if (c == 'Q')
			recording.i2c = true;
		else
			recording.until_ns = ows_now() + ctl_option_seconds(ctl, c);
	if (optind == argc)
		return ctl_usage(ctl, "record to which file?");
	if (recording.i2c && recording.anonymous)
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
	status = open_recording(&recording, name);
	if (status)
		return status;
	write_command(&recording, ctl, argc, argv);
	ctl->tap = &recording.trace.tap;
	ctl->verb = verb;
	sigaction(SIGINT,
	          &(struct sigaction){.sa_handler = interrupt, .sa_flags = (int)SA_RESETHAND},
	          NULL);
	status = record_verb(&recording, ctl, argc, argv);
	c = close_recording(&recording, name);
	return status ? status : c;
}
