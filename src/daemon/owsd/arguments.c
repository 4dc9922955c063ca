/* SPDX-License-Identifier: MIT */
/* owsd's command line, and the messages about it. */
#include <errno.h>
#include <getopt.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/bus/bus.h"
#include "hal/gpio/line.h"
#include "src/daemon/owsd/arguments.h"
#include "src/ground/text/printable.h"
#include "src/ground/text/refused.h"

enum { OPT_CHECK = 256, OPT_STRICT, OPT_BOARD, OPT_ROOT, OPT_RT };

/* the leading ':' makes getopt distinguish a missing argument from an unknown option */
static const char letters[] = ":c:n:t:l:vVh";
static const struct option words[] = {
	{"config", required_argument, NULL, 'c'},
	{"name", required_argument, NULL, 'n'},
	{"target", required_argument, NULL, 't'},
	{"listen", required_argument, NULL, 'l'},
	{"check", no_argument, NULL, OPT_CHECK},
	{"strict", no_argument, NULL, OPT_STRICT},
	{"board", optional_argument, NULL, OPT_BOARD},
	{"root", required_argument, NULL, OPT_ROOT},
	{"rt", required_argument, NULL, OPT_RT},
	{"verbose", no_argument, NULL, 'v'},
	{"version", no_argument, NULL, 'V'},
	{"help", no_argument, NULL, 'h'},
	{0},
};

void complain(const char *format, ...)
{
	va_list args;
	char *text;

	va_start(args, format);
	text = printable_line(format, args);
	va_end(args);
	fprintf(stderr, "owsd: %s\n", text ? text : format);
	free(text);
}

int finish_output(void)
{
	errno = 0;
	if (fflush(stdout) == 0 && !ferror(stdout))
		return EXIT_SUCCESS;
	complain("cannot write: %s", strerror(errno ? errno : EIO));
	return EXIT_RUN;
}

static void usage(FILE *out)
{
	/* owsd-sim is another name of the same arguments */
	fprintf(out, "usage: %s", program_invocation_short_name);
	fputs(" [-c FILE] [-n NAME] [-t TARGET]... [-l [HOST:]PORT]...\n"
	      "            [--check [--strict]] [--board[=ID]] [--rt PRIO] [-v] [-V] [-h]\n"
	      "  -c, --config FILE   configuration (" CONFIG_DIR "/NAME.rio);\n"
	      "                      without that file -t and -l serve the devices, no signals\n"
	      "  -n, --name NAME     instance: signal prefix and name of the segments (OWS)\n"
	      "  -t, --target TARGET in place of TargetName; again for another wire\n"
	      "  -l, --listen ADDRESS in place of Listen: serve the owserver protocol at PORT of this\n"
	      "                      machine alone, or at HOST:PORT\n"
	      "      --check         print the configuration as understood, start nothing\n"
	      "      --strict        with --check: a warning counts as an error\n"
	      "      --board[=ID]    report the board, and what is missing there for a DS2482;\n"
	      "                      ID: a board that does not identify itself\n"
	      "      --root DIR      with --board: look at the files below DIR\n"
	      "      --rt PRIO       engine thread with SCHED_FIFO priority 1 to 99\n"
	      "  -v, --verbose       log more; twice: debugging; three times: each request too\n"
	      "  -V, --version       version and backends\n"
	      "  -h, --help          this text\n",
	      out);
}

static void version(void)
{
	printf("owsd %s\n", OWSD_VERSION);
	for (const struct bus_ops *const *b = bus_backends; *b; b++)
		printf("  %-10s %s\n", (*b)->scheme, (*b)->summary);
#ifdef OWSD_LIBI2C
	printf("with libi2c\n");
#else
	printf("without libi2c: no target i2c\n");
#endif
#ifdef OWSD_LIBUSB
	printf("with libusb\n");
#else
	printf("without libusb: no target usb\n");
#endif
	if (gpio_library)
		printf("with libgpiod %s\n", gpio_library->version());
	else
		printf("without libgpiod: no target gpio, no GPIO lines\n");
}

/* getopt would print the argument as it stands, and that may steer the terminal. */
static int arguments_refuse(int option, char *const *argv)
{
	char why[1024];

	refused_option(option, words, argv, why, sizeof(why));
	complain("%s", why);
	usage(stderr);
	return EXIT_USAGE;
}

static int take_target(struct arguments *a)
{
	/* what the file means by that is an owserver at localhost */
	if (!*optarg) {
		complain("-t: a target expected, as localhost:4304, i2c:/dev/i2c-1 or w1");
		return EXIT_USAGE;
	}
	if (a->target_count == CONFIG_TARGETS_MAX) {
		complain("-t %s: at most %d targets", optarg, CONFIG_TARGETS_MAX);
		return EXIT_USAGE;
	}
	a->targets[a->target_count++] = optarg;
	return -1;
}

static int take_listen(struct arguments *a)
{
	if (a->listen_count == ARGUMENTS_LISTENS) {
		complain("-l %s: at most %d addresses to listen at", optarg, ARGUMENTS_LISTENS);
		return EXIT_USAGE;
	}
	a->listens[a->listen_count++] = optarg;
	return -1;
}

static int take_priority(struct arguments *a)
{
	char *end;
	long priority = strtol(optarg, &end, 10);

	if (*end || end == optarg || priority < 1 || priority > 99) {
		complain("--rt %s: a number from 1 to 99 expected", optarg);
		return EXIT_USAGE;
	}
	a->rt_priority = (int)priority;
	return -1;
}

static int take_option(struct arguments *a, int option, char *const *argv)
{
	switch (option) {
	case 'c':
		a->file = optarg;
		return -1;
	case 'n':
		a->instance = optarg;
		return -1;
	case 't':
		return take_target(a);
	case 'l':
		return take_listen(a);
	case OPT_CHECK:
		a->check = true;
		return -1;
	case OPT_STRICT:
		a->strict = true;
		return -1;
	case OPT_BOARD:
		a->board = true;
		a->board_id = optarg;
		return -1;
	case OPT_ROOT:
		a->root = optarg;
		return -1;
	case OPT_RT:
		return take_priority(a);
	case 'v':
		if (a->level < LOG_LEVEL_TRACE)
			a->level++;
		return -1;
	case 'V':
		version();
		return finish_output();
	case 'h':
		usage(stdout);
		return finish_output();
	default:
		return arguments_refuse(option, argv);
	}
}

/* Checks that need all options. */
static int check_together(struct arguments *a)
{
	if (a->root && !a->board) {
		complain("--root goes with --board");
		return EXIT_USAGE;
	}
	if (a->strict && !a->check) {
		complain("--strict goes with --check");
		return EXIT_USAGE;
	}
	if (!segment_name_ok(a->instance)) {
		complain("instance name '%s': " SEGMENT_NAME_WANTED, a->instance);
		return EXIT_USAGE;
	}
	if (!a->file) {
		snprintf(a->default_file, sizeof(a->default_file), CONFIG_DIR "/%s.rio",
		         a->instance);
		a->file = a->default_file;
	}
	return -1;
}

int arguments_parse(int argc, char **argv, struct arguments *a)
{
	int option;

	*a = (struct arguments){.instance = "OWS", .level = LOG_LEVEL_NOTICE};
	opterr = 0;
	while ((option = getopt_long(argc, argv, letters, words, NULL)) != -1) {
		int status = take_option(a, option, argv);

		if (status >= 0)
			return status;
	}
	if (optind < argc) {
		complain("unexpected argument '%s' (a file is given with -c)", argv[optind]);
		return EXIT_USAGE;
	}
	return check_together(a);
}
