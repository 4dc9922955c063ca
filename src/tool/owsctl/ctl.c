/* SPDX-License-Identifier: MIT */
/*
 * What the verbs of owsctl have in common: options, messages, opening an instance, ending. A verb
 * that cannot go on ends by longjmp() in ctl_end(), so that no function has to pass the status up.
 * The process ends after it: what the verb has open is not closed.
 */
#include <errno.h>
#include <getopt.h>
#include <poll.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "hal/base/time.h"
#include "src/faces/show/names.h"
#include "src/faces/show/text.h"
#include "src/faces/show/when.h"
#include "src/ground/text/printable.h"
#include "src/ground/text/refused.h"
#include "src/memory/libows/open.h"
#include "src/memory/shm/dir.h"
#include "src/memory/shm/segment.h"
#include "src/tool/owsctl/ctl.h"
#include "src/tool/owsctl/running.h"

enum { JSON = 256 };

__attribute__((format(printf, 1, 0))) static void print_error(const char *format, va_list args)
{
	char *text = printable_line(format, args);

	fprintf(stderr, "owsctl: %s\n", text ? text : format);
	free(text);
}

int ctl_say(int status, const char *format, ...)
{
	va_list args;

	va_start(args, format);
	print_error(format, args);
	va_end(args);
	return status;
}

void ctl_report(void *ctx, bool is_error, const char *message)
{
	if (is_error || ctx)
		ctl_tell("%s", message);
}

int ctl_usage(const struct ctl *ctl, const char *format, ...)
{
	va_list args;

	va_start(args, format);
	print_error(format, args);
	va_end(args);
	fprintf(stderr, "usage: owsctl %s %s\n", ctl->verb->name, ctl->verb->usage);
	return CTL_USAGE;
}

static jmp_buf verb_end;
static int verb_status;

int ctl_run(struct ctl *ctl, int argc, char **argv)
{
	if (setjmp(verb_end))
		return verb_status;
	optind = 0;
	return ctl->verb->run(ctl, argc, argv);
}

void ctl_end(int status)
{
	verb_status = status;
	longjmp(verb_end, 1);
}

void *ctl_need(void *memory)
{
	if (!memory)
		ctl_end(ctl_fail("no memory"));
	return memory;
}

/* The long options of a verb, whose short ones are `options`. */
static const struct option *longs_of(const char *options)
{
	static const struct option longs[] = {
		{"json", no_argument, NULL, JSON},
		{"help", no_argument, NULL, 'h'},
		{"all", no_argument, NULL, 'a'},
		{"rio", no_argument, NULL, 'r'},
		{"alias", required_argument, NULL, 'L'},
		{"bits", no_argument, NULL, 'B'},
		{"merge", required_argument, NULL, 'M'},
		{"replace", required_argument, NULL, 'R'},
		{"within", required_argument, NULL, 'W'},
		{"as", required_argument, NULL, 'A'},
		{"host", required_argument, NULL, 'H'},
		{"follow", no_argument, NULL, 'f'},
		{"since", required_argument, NULL, 's'},
		{"until", required_argument, NULL, 'u'},
		{"csv", no_argument, NULL, 'C'},
		{"influx", no_argument, NULL, 'I'},
		{"mbdrv", no_argument, NULL, 'm'},
		{"directory", required_argument, NULL, 'd'},
		{"dry-run", no_argument, NULL, 'D'},
		{"fix", no_argument, NULL, 'F'},
		{"root", required_argument, NULL, 'O'},
		{"anonymous", no_argument, NULL, 'N'},
		{"for", required_argument, NULL, 'E'},
		{"i2c", no_argument, NULL, 'Q'},
	};
	static struct option had[sizeof(longs) / sizeof(longs[0]) + 1];
	struct option *next = had;

	for (size_t i = 0; i < sizeof(longs) / sizeof(longs[0]); i++)
		if (longs[i].val == JSON || longs[i].val == 'h' || strchr(options, longs[i].val))
			*next++ = longs[i];
	*next = (struct option){0};
	return had;
}

void ctl_help(const struct verb *verb, FILE *out)
{
	fprintf(out, "usage: owsctl %s%s%s\n", verb->name, *verb->usage ? " " : "", verb->usage);
	fprintf(out, "%s\n%s", verb->brief, verb->options ? verb->options : "");
	if (verb->example)
		fprintf(out, "example: owsctl %s\n", verb->example);
	fputs("man owsctl has more\n", out);
}

static const char *long_given; /* the name of the last option, if it was a long one */

int ctl_option(struct ctl *ctl, int argc, char **argv, const char *options)
{
	const struct option *longs = longs_of(options);
	char all[32], why[1024];
	int c, index = -1;

	snprintf(all, sizeof(all), "%s:h%s%s", *options == '+' ? "+" : "",
	         ctl->verb->opens ? "t:" : "", options + (*options == '+'));
	opterr = 0;
	while ((c = getopt_long(argc, argv, all, longs, &index)) == JSON ||
	       (c == 't' && ctl->verb->opens)) {
		if (c == JSON)
			ctl->json = true;
		else
			ctl->target = optarg;
		index = -1;
		if (c == 't' && !*optarg)
			ctl_end(ctl_usage(ctl, CTL_NO_TARGET));
	}
	if (c == 'h') {
		ctl_help(ctl->verb, stdout);
		ctl_end(CTL_DONE);
	}
	if (c == ':' || c == '?') {
		refused_option(c, longs, argv, why, sizeof(why));
		if (optopt == 'n' && c == '?')
			ctl_end(ctl_usage(ctl,
			                  "%s; -n NAME stands before the verb: owsctl -n NAME %s",
			                  why, ctl->verb->name));
		ctl_end(ctl_usage(ctl, "%s", why));
	}
	long_given = index < 0 ? NULL : longs[index].name;
	return c;
}

int64_t ctl_moment(const struct ctl *ctl, int c, const struct when *now)
{
	const char short_given[] = {(char)c, '\0'};
	int64_t wall_ns;
	const char *why = when_moment(now, optarg, &wall_ns);

	if (why)
		ctl_end(ctl_usage(ctl, "-%s%s %s: %s", long_given ? "-" : "",
		                  long_given ? long_given : short_given, ctl_word(optarg), why));
	return wall_ns;
}

int64_t ctl_option_seconds(const struct ctl *ctl, int c)
{
	int64_t ns;

	if (!ctl_seconds(optarg, &ns))
		ctl_end(ctl_usage(ctl, "-%c wants a number of seconds, not %s", c,
		                  ctl_word(optarg)));
	return ns;
}

const char *ctl_word(const char *word)
{
	return *word ? word : "\"\"";
}

bool ctl_seconds(const char *text, int64_t *ns)
{
	char *end;
	double seconds = strtod(text, &end);

	if (end == text || *end || !(seconds >= 0) || seconds > 366 * 86400.0)
		return false;
	*ns = (int64_t)(seconds * 1e9);
	return true;
}

bool ctl_count(const char *text, int64_t least, int64_t most, int64_t *count)
{
	char *end;

	errno = 0;
	*count = strtoll(text, &end, 10);
	return end != text && !*end && !errno && *count >= least && *count <= most;
}

/* Print what is wrong with the directories where instances are; CTL_DONE: nothing is. */
static int check_dirs(int err)
{
	char dirs[DIRS][DIR_PATH], fault[DIR_FAULT];
	struct shm_dir dir = {.fd = -1};
	int count = dir_list(dirs);

	if (count < 0)
		return ctl_fail("%s", dir_fault(&dir, count, fault));
	for (int i = 0; i < count; i++) {
		if (dir_open(dirs[i], &dir) == err)
			return ctl_fail("%s", dir_fault(&dir, err, fault));
		dir_close(&dir);
	}
	return CTL_DONE;
}

/* Print why an instance cannot be commanded that can be read; CTL_DONE: it cannot. */
static int check_control(const char *name, int err)
{
	struct ows *h;

	if (ows_open(name, OWS_READ, &h))
		return CTL_DONE;
	ows_close(h);
	switch (-err) {
	case ENOENT:
		return ctl_fail("owsd is not running: nothing was set");
	case EACCES:
		return ctl_fail("no right to set the signals of %s: that is for group "
		                "owsd-control, or for whom ControlAllow names",
		                name);
	case ENOSPC:
		return ctl_fail("owsd %s has no place for another program that commands: owsctl "
		                "who lists them",
		                name);
	case ETIMEDOUT:
		return ctl_fail("owsd does not answer: nothing was set");
	}
	return CTL_DONE;
}

/* Print why an instance cannot be opened. */
static int refuse_open(const struct ctl *ctl, enum ows_mode mode, int err)
{
	const char *name = ctl->instance;
	char one[SEGMENT_NAME_MAX + 1], names[400];

	if (mode == OWS_CONTROL && check_control(name, err))
		return CTL_FAILED;
	if (err != -ENOENT && check_dirs(err))
		return CTL_FAILED;
	switch (-err) {
	case ENOENT:
		if (instances_running(one, names, sizeof(names)))
			return ctl_fail(
				"no owsd of the name %s has run here; running: %s (owsctl -n %s "
				"%s)",
				name, names, one, ctl->verb->name);
		return ctl_fail("no owsd of the name %s has run here (-n NAME chooses another)",
		                name);
	case EACCES:
		return ctl_fail("no right to see the signals of %s: that is for group owsd", name);
	case EPERM:
		return ctl_fail("the shared memory of %s belongs to another user, neither root nor "
		                "owsd: refused",
		                name);
	case EPROTO:
		return ctl_fail("the shared memory of %s is of another version of owsd, or not of "
		                "owsd",
		                name);
	case EINVAL:
		return ctl_fail("%s cannot be the name of an instance", ctl_word(name));
	}
	return ctl_fail("cannot open the shared memory of %s: %s", name, strerror(-err));
}

struct ows *ctl_open_as(const struct ctl *ctl, enum ows_mode mode, const char *program)
{
	struct ows *h;
	int err = ows_open_as(ctl->instance, mode, program, &h);

	if (err)
		ctl_end(refuse_open(ctl, mode, err));
	return h;
}

struct ows *ctl_open(const struct ctl *ctl, enum ows_mode mode)
{
	return ctl_open_as(ctl, mode, "owsctl");
}

bool ctl_alive(const struct ctl *ctl, struct ows *h, int64_t now_ns)
{
	struct ows_daemon daemon = {0};
	char span[WHEN_TEXT];

	ows_daemon(h, now_ns, &daemon);
	if (daemon.alive)
		return true;
	if (daemon.state == 3)
		ctl_fail("owsd %s of %s was stopped %s ago; these are its last values",
		         ctl->instance, open_dir(h), when_span(daemon.beat_age_ns, span));
	else if (!daemon.beat_age_ns)
		ctl_fail("owsd %s of %s is not running: its heartbeat lies in the future",
		         ctl->instance, open_dir(h));
	else
		ctl_fail("owsd %s of %s is not running: last heartbeat %s ago", ctl->instance,
		         open_dir(h), when_span(daemon.beat_age_ns, span));
	return false;
}

void ctl_refused(const struct ctl *ctl, struct ows *h, int64_t now_ns)
{
	struct ows_log_line line;
	char span[WHEN_TEXT];

	if (ows_refused_reload(h, &line) == 0)
		ctl_fail("owsd %s goes on with what it loaded before: a reload was refused %s ago: "
		         "%s",
		         ctl->instance, when_span(now_ns - line.time_ns, span), line.text);
}

void ctl_nap(void)
{
	const struct timespec nap = {.tv_nsec = 200 * NS_PER_MS};

	nanosleep(&nap, NULL);
}

void ctl_sleep(struct ows *h, uint32_t *news, int64_t timeout_ns)
{
	struct ows_daemon daemon = {0};
	int err = ows_wait(h, news, timeout_ns);

	if (err == 0)
		ows_daemon(h, ows_now(), &daemon);
	if (err == -ESTALE || (err == 0 && !daemon.alive)) {
		ctl_nap();
		if (ows_reopen(h) == 0)
			*news = 0;
	}
}

int ctl_unknown(struct ows *h, const char *name)
{
	const char *rest = strstr(name, "__");
	char nearest[NAMES_MAX];

	if (rest && rest != name && ows_find(h, rest + 2) >= 0)
		return ctl_fail("there is no %s: its prefix is of another instance; did you mean "
		                "%s, or -n %.*s?",
		                name, rest + 2, (int)(rest - name), name);
	if (names_nearest(h, name, nearest))
		return ctl_fail("there is no %s; did you mean %s?", ctl_word(name), nearest);
	return ctl_fail("there is no %s: owsctl list shows the names", ctl_word(name));
}

void ctl_value(const char *text, size_t len)
{
	static char clean[2 * CTL_VALUE];

	if (isatty(STDOUT_FILENO)) {
		text_clean(text, len, CTL_VALUE, clean, sizeof(clean));
		puts(clean);
	} else {
		fwrite(text, 1, len, stdout);
		putchar('\n');
	}
}

bool ctl_reader_gone(void)
{
	struct pollfd out = {.fd = STDOUT_FILENO};

	return poll(&out, 1, 0) > 0 && (out.revents & (POLLERR | POLLHUP));
}

static int output_errno;

bool ctl_flush_lines(void)
{
	int err = fflush(stdout) == 0 ? 0 : errno;

	if (!output_errno)
		output_errno = err;
	return !err && !ferror(stdout);
}

int ctl_flush(int status)
{
	if (ctl_flush_lines() || ctl_reader_gone())
		return status;
	return ctl_fail("cannot write: %s", strerror(output_errno ? output_errno : EIO));
}
