/* SPDX-License-Identifier: MIT */
/* owsctl: look at the signals of owsd and set them; look at devices without owsd. */
#include <getopt.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>

#include "src/owsctl/ctl.h"
#include "src/owsctl/verbs.h"
#include "src/service/standard.h"
#include "src/text/refused.h"

static const struct verb verbs[] = {
	{"list", "[-a] [PATTERN...]", "all signals with value, quality, age and path", verb_list},
	{"get", "NAME...", "values alone, one line for each name", verb_get},
	{"set", "[-w SECONDS] NAME VALUE [NAME VALUE]...", "set outputs and writable attributes",
         verb_set},
	{"control", "[--as NAME]", "command by lines of standard input, one answer for each",
         verb_control},
	{"who", "[PATTERN...]", "programs that may command, and who set each output", verb_who},
	{"watch", "[-al] [-c COUNT] [-t SECONDS] [PATTERN...]", "follow values as they change",
         verb_watch},
	{"wait", "[-t SECONDS] NAME [OP VALUE]", "sleep until a value changes or a condition holds",
         verb_wait},
	{"alarms", "[PATTERN...] | history | ack | shelve | unshelve ...",
         "alarms that stand, and those since the start", verb_alarms},
	{"journal", "[-f] [-c COUNT] [PATTERN...]",
         "who did what and when: alarms and commands since the start", verb_journal},
	{"stats", "", "owsd itself, its targets and counters", verb_stats},
	{"metrics", "[-p] [PATTERN...]", "values, quality, targets and counters as OpenMetrics",
         verb_metrics},
	{"instances", "", "list the owsd that run here, and those that have run", verb_instances},
	{"remove", "NAME...", "remove the files of an instance that has ended", verb_remove},
	{"config", "FILE list | add | set | unset | remove | move ...",
         "look at a configuration and edit it", verb_config},
	{"reload", "[-w SECONDS]", "have owsd load its configuration again, and wait for that",
         verb_reload},
	{"dir", "[-t TARGET] [-w SECONDS] [PATH]", "list a directory of a target", verb_dir,
         .opens = true},
	{"read", "[-t TARGET] [-w SECONDS] PATH...", "properties of devices, one line for each",
         verb_read, .opens = true},
	{"write", "[-t TARGET] [-w SECONDS] PATH VALUE", "write a property of a device", verb_write,
         .opens = true, .writes = true},
	{"mission",
         "[-t TARGET] [-w SECONDS] start [-o] -i SECONDS | stop | status | download DEVICE",
         "the mission of a logger: DS1921, DS1922, DS1923", verb_mission, .opens = true,
         .writes = true},
	{"scan", "[-t TARGET] [-w SECONDS] [--alias FILE] [--rio [-i] [--merge FILE [--replace OLD=NEW]...]]",
         "list the devices, or print a configuration for them", verb_scan, .opens = true},
};
enum { JSON = 256 };
#define USAGE_WIDTH 46 /* a longer usage puts the meaning into the next line */
#define VERBS (sizeof(verbs) / sizeof(verbs[0]))

static void usage(FILE *out)
{
	fputs("usage: owsctl [-n NAME | -t TARGET] [--json] VERB ...\n", out);
	for (size_t i = 0; i < VERBS; i++)
		fprintf(out, "  %-9s %-*s%s%*s%s\n", verbs[i].name, USAGE_WIDTH, verbs[i].usage,
		        strlen(verbs[i].usage) > USAGE_WIDTH ? "\n" : "",
		        strlen(verbs[i].usage) > USAGE_WIDTH ? USAGE_WIDTH + 13 : 1, "",
		        verbs[i].brief);
	fputs("  -n NAME    instance, default OWS\n"
	      "  -t TARGET  what dir, read, write, mission and scan open; default: the instance where it\n"
	      "             serves them, else localhost:4304 (owserver)\n"
	      "  --json     print JSON\n"
	      "  -V -h      print the version; this help, with a verb in front: the verb's\n"
	      "exit status: 0 done, 1 failed, 2 wrong usage, 3 a value is not good,\n"
	      "             4 a scan found nothing\n",
	      out);
}

int main(int argc, char **argv)
{
	static const struct option longs[] = {
		{"json", no_argument, NULL, JSON},
		{"help", no_argument, NULL, 'h'},
		{"version", no_argument, NULL, 'V'},
		{0},
	};
	struct ctl ctl = {.instance = "OWS"};
	char why[1024];
	int c;

	/* a write to a pipe without reader fails with EPIPE */
	signal(SIGPIPE, SIG_IGN);
	c = standard_open();
	if (c)
		return ctl_fail("/dev/null: %s", strerror(-c));
	/* a write to a file beyond its limit fails with EFBIG */
	signal(SIGXFSZ, SIG_IGN);
	/* getopt would print the option itself, which may steer the terminal */
	opterr = 0;
	while ((c = getopt_long(argc, argv, "+:n:t:Vh", longs, NULL)) != -1) {
		switch (c) {
		case 'n':
			ctl.instance = optarg;
			ctl.named = true;
			break;
		case 't':
			ctl.target = optarg;
			if (*optarg)
				break;
			ctl_fail(CTL_NO_TARGET);
			usage(stderr);
			return CTL_USAGE;
		case JSON:
			ctl.json = true;
			break;
		case 'V':
			puts("owsctl " OWSD_VERSION);
			return ctl_flush(CTL_DONE);
		case 'h':
			usage(stdout);
			return ctl_flush(CTL_DONE);
		default:
			refused_option(c, longs, argv, why, sizeof(why));
			ctl_fail("%s", why);
			usage(stderr);
			return CTL_USAGE;
		}
	}
	if (optind == argc) {
		usage(stderr);
		return CTL_USAGE;
	}
	for (size_t i = 0; i < VERBS; i++) {
		if (strcmp(verbs[i].name, argv[optind]) == 0) {
			ctl.verb = &verbs[i];
			if (ctl.target && !verbs[i].opens)
				return ctl_usage(
					&ctl,
					"-t TARGET is for dir, read, write, mission and scan; "
					"%s looks at a running owsd",
					verbs[i].name);
			return ctl_flush(verbs[i].run(&ctl, argc - optind, argv + optind));
		}
	}
	ctl_fail("there is no verb %s", ctl_word(argv[optind]));
	usage(stderr);
	return CTL_USAGE;
}
