/* SPDX-License-Identifier: MIT */
/* owsctl: look at the signals of owsd and set them; look at devices without owsd. */
#include <errno.h>
#include <getopt.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "src/ground/service/streams.h"
#include "src/ground/text/distance.h"
#include "src/ground/text/refused.h"
#include "src/memory/shm/segment.h"
#include "src/tool/owsctl/ctl.h"
#include "src/tool/owsctl/running.h"
#include "src/tool/owsctl/verbs.h"

static int verb_help(struct ctl *ctl, int argc, char **argv);

/* Of the verbs that open a target. */
#define TARGET_OPTIONS \
	"  -t TARGET   localhost:4304, i2c:/dev/i2c-1, w1, ...; default: the owsd that\n" \
	"              runs, else localhost:4304\n" \
	"  -w SECONDS  how long an answer may take, 20\n"

static const struct verb verbs[] = {
	{"list", "[-a] [PATTERN...]", "all signals with value, quality, age and path", verb_list,
         .options = "  -a  the readable signals of the driver too\n", .example = "list 'temp*'",
         .finds = true},
	{"get", "NAME...", "values alone, one line for each name", verb_get, .example = "get room1",
         .finds = true},
	{"set", "[-w SECONDS] NAME VALUE [NAME VALUE]...", "set outputs and writable attributes",
         verb_set,
         .options = "  -w SECONDS  wait until the devices have the values, at most so long\n",
         .example = "set -w 2 light on"},
	{"control", "[--as NAME]", "command by lines of standard input, one answer for each",
         verb_control,
         .options = "  --as NAME  the name that owsctl who and owsctl journal show\n"
                    "  lines: NAME=VALUE, beat MILLISECONDS, for PERSON, ack NAME,\n"
                    "         shelve NAME SECONDS [WHY], quit\n",
         .example = "control --as heating"},
	{"who", "[PATTERN...]", "programs that may command, and who set each output", verb_who,
         .example = "who", .finds = true},
	{"watch", "[-al] [-c COUNT] [-t SECONDS] [PATTERN...]", "follow values as they change",
         verb_watch,
         .options = "  -a          the readable signals of the driver too\n"
                    "  -l          lines, not a table; in a pipe always\n"
                    "  -c COUNT    end after so many lines\n"
                    "  -t SECONDS  end after that time\n"
                    "  keys: arrows and page keys move, / searches, !: bad first, q ends\n",
         .example = "watch -l 'temp*'", .finds = true},
	{"wait", "[-t SECONDS] NAME [OP VALUE]", "sleep until a value changes or a condition holds",
         verb_wait,
         .options = "  -t SECONDS  give up after that time, with status 1\n"
                    "  OP          = != < <= > >= ; quote it\n",
         .example = "wait -t 60 door '=' 1", .finds = true},
	{"alarms", "[PATTERN...] | history | ack | shelve | unshelve ...",
         "alarms that stand, and those since the start", verb_alarms,
         .options = "  [PATTERN...]                          the alarms that stand\n"
                    "  history [PATTERN...]                  those since the start of owsd\n"
                    "  ack NAME... | -a                      acknowledge limit alarms; -a: all\n"
                    "  shelve NAME TIME [REASON]             keep one quiet, for 30m, 8h or 2d\n"
                    "  unshelve NAME...                      end that\n",
         .example = "alarms ack boiler", .finds = true},
	{"journal", "[-f] [-c COUNT] [-s TIME] [-d DIR] [PATTERN...]",
         "who did what and when: alarms and commands, also of the history", verb_journal,
         .options = "  -f        follow what comes (--follow)\n"
                    "  -c COUNT  the last so many\n"
                    "  -s TIME   since when (--since), as 2h, 7d, today\n"
                    "  -d DIR    where owsd-recorder keeps the history (--directory)\n",
         .example = "journal -s 1d boiler", .finds = true},
	{"trend", "[-s TIME] [-u TIME] [-d DIR] [--csv | --influx] NAME...",
         "draw what signals had, from the history of owsd-recorder", verb_trend,
         .options = "  -s TIME         from when (--since): 24h, yesterday, 2026-11-26T14:30\n"
                    "  -u TIME         until when (--until), likewise; else until now\n"
                    "  -d DIR          where owsd-recorder keeps the history (--directory)\n"
                    "  --csv --influx  each record in a line; --json too\n",
         .example = "trend -s 7d room1"},
	{"stats", "", "owsd itself, its targets and counters", verb_stats, .example = "stats",
         .finds = true},
	{"metrics", "[-p] [PATTERN...]", "values, quality, targets and counters as OpenMetrics",
         verb_metrics, .options = "  -p  the older text format of Prometheus\n",
         .example = "metrics -p", .finds = true},
	{"doctor", "[--fix] [--root DIR]", "what is wrong on this machine, and what mends it",
         verb_doctor,
         .options = "  --fix       run the commands that are safe, as root, and look again\n"
                    "  --root DIR  look at the files of a machine that was recorded there\n",
         .example = "doctor"},
	{"enable", "[--dry-run] web|mqtt|history|...", "switch a program beside owsd on",
         verb_enable, .options = "  --dry-run  print the commands alone\n",
         .example = "enable web"},
	{"disable", "[--dry-run] web|mqtt|history|...", "switch a program beside owsd off",
         verb_disable, .options = "  --dry-run  print the commands alone\n",
         .example = "disable web"},
	{"modbus-map", "[-d DIR] [--as FORM] [--host HOST[:PORT]]",
         "at which addresses owsd-modbus serves each signal", verb_modbus_map,
         .options = "  -d DIR       where owsd-modbus keeps the map (--directory)\n"
                    "  --as FORM    for the import of another program: csv, plcopen (CODESYS,\n"
                    "               TwinCAT), scl (Siemens), node-red, openplc, mb2hal, mbpoll;\n"
                    "               map: the file that the key Map of the Modbus block names\n"
                    "  --host HOST  where that program reaches owsd-modbus; 127.0.0.1:502\n",
         .example = "modbus-map --as node-red --host 192.168.1.10", .finds = true},
	{"convert", "[-d DIR] --mbdrv FILE",
         "the items of a configuration for REXYGEN's Modbus driver", verb_convert,
         .options = "  -d DIR   where owsd-modbus keeps the map (--directory)\n"
                    "  --mbdrv  as the .rio file of MbDrv, which asks owsd-modbus\n",
         .example = "convert --mbdrv plant.rio"},
	{"instances", "", "list the owsd that run here, and those that have run", verb_instances,
         .example = "instances"},
	{"remove", "NAME...", "remove the files of an instance that has ended", verb_remove,
         .example = "remove demo-sim"},
	{"config", "FILE list|show|add|set|rename|unset|remove|move ...",
         "look at a configuration and edit it", verb_config,
         .options =
                 "  list [PATTERN...]                     a table of the items\n"
                 "  show NAME...                          items with all their fields\n"
                 "  add NAME PATH [KEY=VALUE]...          a new item; makes the file if need be\n"
                 "  set NAME KEY=VALUE...                 change; the NAME OwsDrv is the driver\n"
                 "  rename NAME NEW                       and what names it in the file\n"
                 "  unset NAME KEY...                     take keys out\n"
                 "  remove NAME...                        remove items\n"
                 "  move NAME --before | --after OTHER    change the order\n"
                 "  owsctl reload has owsd load the file again\n",
         .example = "config plant.rio rename temperature1 kitchen"},
	{"reload", "[-w SECONDS]", "have owsd load its configuration again, and wait for that",
         verb_reload, .options = "  -w SECONDS  how long that may take\n", .example = "reload"},
	{"dir", "[-t TARGET] [-w SECONDS] [PATH]", "list a directory of a target", verb_dir,
         .options = TARGET_OPTIONS, .example = "dir /28.551DDF030000", .opens = true,
         .finds = true},
	{"read", "[-t TARGET] [-w SECONDS] PATH...", "properties of devices, one line for each",
         verb_read, .options = TARGET_OPTIONS, .example = "read /28.551DDF030000/temperature",
         .opens = true, .finds = true},
	{"write", "[-t TARGET] [-w SECONDS] PATH VALUE", "write a property of a device", verb_write,
         .options = TARGET_OPTIONS, .example = "write /29.B89115000000/PIO.0 1", .opens = true,
         .writes = true},
	{"scan", "[-t TARGET] [OPTION]... [DEVICE... | --rio [OPTION]...]",
         "list the devices, or print a configuration for them", verb_scan,
         .options = TARGET_OPTIONS
         "  --within SECONDS   end after that with what was read\n"
         "  --alias FILE       names from an alias file of OWFS\n"
         "  --rio              print a configuration for what is there\n"
         "  -i                 with --rio: inputs only, nothing is written\n"
         "  --bits             with --rio: a signal for each switch, not one for all\n"
         "  --merge FILE       add to that file what it has not; its names stay\n"
         "  --replace OLD=NEW  with --merge: NEW takes the place of the device OLD\n",
         .example = "-t i2c:/dev/i2c-1 scan --rio >plant.rio", .opens = true, .finds = true},
	{"record", "[-t TARGET] [--anonymous|--i2c] [--for S] FILE [VERB ...]",
         "record what goes over a wire while a verb looks at it, for a report", verb_record,
         .options = "  -t TARGET      as for scan\n"
                    "  --anonymous    other ids in place of those of your chips\n"
                    "  --i2c          the transactions of the I2C adapter of a DS2482\n"
                    "  --for S        do it again and again until that time is over\n"
                    "  VERB           scan (if you name none), dir, read or write\n"
                    "  replay:FILE is a target of the simulator, which answers as recorded\n",
         .example = "-t i2c:/dev/i2c-1 record --anonymous trouble.trace", .opens = true,
         .finds = true},
	{"help", "[VERB]", "this list, or what a verb takes", verb_help, .example = "help watch"},
};
enum { JSON = 256 };
#define VERBS (sizeof(verbs) / sizeof(verbs[0]))

static void print_verbs(FILE *out)
{
	fprintf(out, "usage: %s [-n NAME | -t TARGET] [--json] VERB ...\n",
	        program_invocation_short_name);
	for (size_t i = 0; i < VERBS; i++)
		fprintf(out, "  %-10s %s\n", verbs[i].name, verbs[i].brief);
	fputs("owsctl help VERB shows what a verb takes; before the verb there may be:\n"
	      "  -n NAME    instance; default: OWS_NAME of the environment, else OWS;\n"
	      "  -t TARGET  what dir, read, write, scan and record open\n"
	      "  --json     print JSON\n"
	      "  -V -h      print the version; this help\n"
	      "exit status: 0 done, 1 failed, 2 wrong usage, 3 a value is not good,\n"
	      "             4 a scan found nothing\n",
	      out);
}

static const struct verb *find_verb(const char *name)
{
	for (size_t i = 0; i < VERBS; i++)
		if (strcmp(verbs[i].name, name) == 0)
			return &verbs[i];
	return NULL;
}

/* Words of other programs, and of the documents, for what a verb does. */
/* clang-format off */
static const struct {
	const char *word, *verb;
} others[] = {
	{"ls", "list"}, {"signals", "list"}, {"names", "list"}, {"values", "list"},
	{"dump", "list"}, {"get-all", "list"}, {"getall", "list"}, {"read-all", "list"},
	{"put", "set"}, {"controllers", "who"}, {"givers", "who"}, {"clients", "who"},
	{"status", "stats"}, {"state", "stats"}, {"info", "stats"}, {"counters", "stats"},
	{"targets", "stats"}, {"monitor", "watch"}, {"top", "watch"}, {"tail", "watch"},
	{"follow", "watch"}, {"log", "journal"}, {"events", "journal"}, {"history", "trend"},
	{"plot", "trend"}, {"graph", "trend"}, {"export", "trend"}, {"ack", "alarms ack"},
	{"shelve", "alarms shelve"}, {"unshelve", "alarms unshelve"}, {"ps", "instances"},
	{"rm", "remove"}, {"edit", "config"}, {"rename", "config"}, {"add", "config"},
	{"check", "doctor"}, {"diagnose", "doctor"}, {"start", "enable"}, {"stop", "disable"},
	{"devices", "scan"}, {"search", "scan"}, {"trace", "record"}, {"find", "scan"}, {"tree", "dir"},
};
/* clang-format on */
#define OTHERS (sizeof(others) / sizeof(others[0]))

static int no_verb(const char *name)
{
	unsigned best = text_too_far(name);
	const char *nearest = NULL;

	for (size_t i = 0; i < VERBS; i++)
		if (text_nearer(name, verbs[i].name, &best))
			nearest = verbs[i].name;
	for (size_t i = 0; i < OTHERS; i++)
		if (text_nearer(name, others[i].word, &best))
			nearest = others[i].verb;
	ctl_fail("there is no verb %s%s%s%s", ctl_word(name), nearest ? "; did you mean " : "",
	         nearest ? nearest : "", nearest ? "?" : "");
	fputs("owsctl --help lists the verbs\n", stderr);
	return CTL_USAGE;
}

static int verb_help(struct ctl *ctl, int argc, char **argv)
{
	const struct verb *verb;

	ctl_option(ctl, argc, argv, "");
	if (optind == argc) {
		print_verbs(stdout);
		return CTL_DONE;
	}
	verb = find_verb(argv[optind]);
	if (!verb)
		return no_verb(argv[optind]);
	ctl_help(verb, stdout);
	return CTL_DONE;
}

/* Does a verb that only looks act all the same, as alarms ack does, or ask what it takes? */
static bool acts(int argc, char **argv)
{
	static const char *const words[] = {"ack", "shelve", "unshelve", "-h", "--help"};

	for (int i = 1; i < argc; i++)
		for (size_t k = 0; k < sizeof(words) / sizeof(words[0]); k++)
			if (strcmp(argv[i], words[k]) == 0)
				return true;
	return false;
}

/*
 * The user named no instance, and none of the name OWS has run here: the instance that runs is
 * meant. owsctl says so, as the next call may find two.
 */
static void find_instance(struct ctl *ctl, int argc, char **argv)
{
	static char found[SEGMENT_NAME_MAX + 1];
	struct ows *h;

	if (ctl->named || ctl->target || acts(argc, argv))
		return;
	for (int i = 1; i < argc && ctl->verb->opens; i++)
		if (strncmp(argv[i], "-t", 2) == 0)
			return;
	if (ows_open(ctl->instance, OWS_READ, &h) == 0)
		ows_close(h);
	else if (instances_running(found, NULL, 0) == 1) {
		ctl_tell("no %s has run here; this is %s", ctl->instance, found);
		ctl->instance = found;
		ctl->named = !ctl->verb->opens;
	}
}

int main(int argc, char **argv)
{
	static const struct option longs[] = {
		{"json", no_argument, NULL, JSON},
		{"help", no_argument, NULL, 'h'},
		{"version", no_argument, NULL, 'V'},
		{0},
	};
	const char *name = getenv("OWS_NAME");
	struct ctl ctl = {.instance = name && *name ? name : "OWS",
	                  .named = name && *name,
	                  .find = find_verb};
	char why[1024];
	int c;

	/* a write to a pipe without reader fails with EPIPE */
	signal(SIGPIPE, SIG_IGN);
	c = standard_open();
	if (c)
		return ctl_fail("/dev/null: %s", strerror(-c));
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
			print_verbs(stderr);
			return CTL_USAGE;
		case JSON:
			ctl.json = true;
			break;
		case 'V':
			puts("owsctl " OWSD_VERSION);
			return ctl_flush(CTL_DONE);
		case 'h':
			print_verbs(stdout);
			return ctl_flush(CTL_DONE);
		default:
			refused_option(c, longs, argv, why, sizeof(why));
			ctl_fail("%s", why);
			print_verbs(stderr);
			return CTL_USAGE;
		}
	}
	if (optind == argc) {
		print_verbs(stderr);
		return CTL_USAGE;
	}
	argc -= optind;
	argv += optind;
	ctl.verb = find_verb(argv[0]);
	if (!ctl.verb)
		return no_verb(argv[0]);
	if (ctl.target && !ctl.verb->opens)
		return ctl_usage(
			&ctl,
			"-t TARGET is for dir, read, write, scan and record; %s looks at a running owsd",
			ctl.verb->name);
	if (ctl.verb->finds)
		find_instance(&ctl, argc, argv);
	return ctl_flush(ctl_run(&ctl, argc, argv));
}
