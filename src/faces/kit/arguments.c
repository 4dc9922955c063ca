/* SPDX-License-Identifier: MIT */
/* The command line of a face, and the messages about it. */
#include <errno.h>
#include <getopt.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "src/config/read/load.h"
#include "src/faces/kit/arguments.h"
#include "src/ground/service/resident.h"
#include "src/ground/service/streams.h"
#include "src/ground/text/printable.h"
#include "src/ground/text/refused.h"
#include "src/memory/shm/dir.h"
#include "src/memory/shm/segment.h"

#define OPT_CHECK 256 /* it has no letter */

void face_complain(const char *program, const char *format, ...)
{
	va_list args;
	char *text;

	va_start(args, format);
	text = printable_line(format, args);
	va_end(args);
	fprintf(stderr, "%s: %s\n", program, text ? text : format);
	free(text);
}

static void print_usage(FILE *out, const char *program, const struct face_option *own)
{
	fprintf(out, "usage: %s [-c FILE] [-n NAME]", program);
	if (own->letter && own->value)
		fprintf(out, " [-%c %s]", own->letter, own->value);
	else if (own->letter)
		fprintf(out, " [--%s]", own->word);
	fputs(" [--check] [-v] [-V] [-h]\n"
	      "  -c, --config FILE   configuration, that of owsd (" CONFIG_DIR "/NAME.rio)\n"
	      "  -n, --name NAME     instance of owsd (OWS)\n",
	      out);
	if (own->letter && own->value)
		fprintf(out, "  -%c, --%s %s %s\n", own->letter, own->word, own->value, own->help);
	else if (own->letter)
		fprintf(out, "  -%c, --%-13s %s\n", own->letter, own->word, own->help);
	fputs(own->more ? own->more : "", out);
	fputs("      --check         report what is wrong with the configuration, and end\n"
	      "  -v, --verbose       log more; twice: debugging\n"
	      "  -V, --version       version\n"
	      "  -h, --help          this text\n",
	      out);
}

static int finish_output(const char *program)
{
	errno = 0;
	if (fflush(stdout) == 0 && !ferror(stdout))
		return EXIT_SUCCESS;
	face_complain(program, "cannot write: %s", strerror(errno ? errno : EIO));
	return FACE_EXIT_RUN;
}

static int arguments_refuse(int option, const struct option *words, const struct face_option *own,
                            char *const *argv, const char *program)
{
	char why[1024];

	refused_option(option, words, argv, why, sizeof(why));
	face_complain(program, "%s", why);
	print_usage(stderr, program, own);
	return FACE_EXIT_USAGE;
}

static int arguments_check(struct face_arguments *a)
{
	if (!segment_name_ok(a->instance)) {
		face_complain(a->program, "instance name '%s': " SEGMENT_NAME_WANTED, a->instance);
		return FACE_EXIT_USAGE;
	}
	if (a->file)
		return -1;
	snprintf(a->default_file, sizeof(a->default_file), CONFIG_DIR "/%s.rio", a->instance);
	a->file = a->default_file;
	return -1;
}

int face_start(const char *program, const struct face_option *own, int argc, char **argv,
               struct face_arguments *a)
{
	const struct option words[] = {
		{"config", required_argument, NULL, 'c'},
		{"name", required_argument, NULL, 'n'},
		{"check", no_argument, NULL, OPT_CHECK},
		{"verbose", no_argument, NULL, 'v'},
		{"version", no_argument, NULL, 'V'},
		{"help", no_argument, NULL, 'h'},
		{own->word, own->value ? required_argument : no_argument, NULL, own->letter},
		{0},
	};
	/* the leading ':' makes getopt distinguish a missing argument from an unknown option */
	char letters[] = ":c:n:vVh?:"; /* '?': the letter of the face */
	int option, err;

	heap_give_back();
	err = standard_open();
	if (err) {
		face_complain(program, "/dev/null: %s", strerror(-err));
		return FACE_EXIT_RUN;
	}
	*a = (struct face_arguments){
		.program = program, .instance = "OWS", .level = LOG_LEVEL_NOTICE};
	letters[sizeof(letters) - 3] = own->letter;
	if (!own->value)
		letters[sizeof(letters) - 2] = '\0';
	opterr = 0;
	while ((option = getopt_long(argc, argv, letters, words, NULL)) != -1) {
		if (own->letter && option == own->letter)
			a->option = own->value ? optarg : "";
		else if (option == OPT_CHECK)
			a->check = true;
		else if (option == 'c')
			a->file = optarg;
		else if (option == 'n')
			a->instance = optarg;
		else if (option == 'v')
			a->level += a->level < LOG_LEVEL_DEBUG;
		else if (option == 'V') {
			printf("%s %s\n", program, OWSD_VERSION);
			return finish_output(program);
		} else if (option == 'h') {
			print_usage(stdout, program, own);
			return finish_output(program);
		} else {
			return arguments_refuse(option, words, own, argv, program);
		}
	}
	if (optind < argc) {
		face_complain(program, "unexpected argument '%s' (a file is given with -c)",
		              argv[optind]);
		return FACE_EXIT_USAGE;
	}
	return arguments_check(a);
}

int face_socket(const struct face_arguments *a, const char *kind, char path[FACE_PATH])
{
	char fault[DIR_FAULT];
	struct shm_dir dir;
	int err = dir_make(&dir);

	if (err) {
		face_complain(a->program, "%s", dir_fault(&dir, err, fault));
		return err;
	}
	snprintf(path, FACE_PATH, "%s/%s.%s", dir.path, a->instance, kind);
	dir_close(&dir);
	return 0;
}
