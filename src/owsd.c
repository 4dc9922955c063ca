/* SPDX-License-Identifier: MIT */
/* owsd: start-up, supervision and end. */
#include "board/board.h"
#include "config/report.h"
#include "hal/bus.h"
#include "hal/gpio/line.h"
#include "host.h"
#include "libows/ows.h"
#include "log.h"
#include "notify.h"
#include "printable.h"
#include "shm/segment.h"
#include "standard.h"
#include "target.h"

#include <errno.h>
#include <getopt.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define DEFAULT_DIR   "/etc/owsd"
#define LISTENS_MAX   16
#define STOP_NS       2000000000LL
#define SUPERVISE_NS  500000000LL
#define AGAIN_NS      20000000LL /* a reload that has to wait */
#define EXIT_RUN      1
#define EXIT_USAGE    2

struct options {
	const char *file, *instance;
	char default_file[sizeof(DEFAULT_DIR "/.rio") + SEGMENT_NAME_MAX];
	const char *targets[CONFIG_TARGETS_MAX];
	unsigned target_count;
	const char *listens[LISTENS_MAX];
	unsigned listen_count;
	enum log_level level;
	int rt_priority;
	bool check, board;
	const char *board_id, *root;
};

static volatile sig_atomic_t stop_signal, hangup;
static uint32_t *supervisor_word;

static void on_signal(int number)
{
	if (number == SIGHUP)
		hangup = 1;
	else
		stop_signal = number;
	/* so that a wait that is just beginning returns at once */
	if (supervisor_word)
		__atomic_fetch_add(supervisor_word, 1, __ATOMIC_SEQ_CST);
}

/* Names come from outside: nothing in them may steer a terminal. */
static void complain(const char *format, ...) __attribute__((format(printf, 1, 2)));
static void complain(const char *format, ...)
{
	char text[1024];
	va_list args;

	va_start(args, format);
	vsnprintf(text, sizeof(text), format, args);
	va_end(args);
	text[printable(text, strlen(text))] = '\0';
	fprintf(stderr, "owsd: %s\n", text);
}

static void usage(FILE *out)
{
	fputs("usage: owsd [-c FILE] [-n NAME] [-t TARGET]... [-l [HOST:]PORT]...\n"
	      "            [--check] [--board[=ID]] [--rt PRIO] [-v] [-V] [-h]\n"
	      "  -c, --config FILE   configuration (" DEFAULT_DIR "/NAME.rio)\n"
	      "  -n, --name NAME     instance: signal prefix and name of the segments (OWS)\n"
	      "  -t, --target TARGET in place of TargetName; again for another wire\n"
	      "  -l, --listen ADDRESS in place of Listen: serve the owserver protocol at PORT of this\n"
	      "                      machine alone, or at HOST:PORT\n"
	      "      --check         print the configuration as understood, start nothing\n"
	      "      --board[=ID]    say which board this is and what is missing there for a DS2482;\n"
	      "                      ID: a board that does not tell; --root DIR: files below DIR\n"
	      "      --rt PRIO       engine thread with SCHED_FIFO priority 1 to 99\n"
	      "  -v, --verbose       say more; twice: everything\n"
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
	if (gpio_library)
		printf("with libgpiod %s\n", gpio_library->version());
	else
		printf("without libgpiod: no target gpio, no GPIO lines\n");
}

/* The exit status of what only prints. */
static int finish_output(void)
{
	errno = 0;
	if (fflush(stdout) == 0 && !ferror(stdout))
		return EXIT_SUCCESS;
	complain("cannot write: %s", strerror(errno ? errno : EIO));
	return EXIT_RUN;
}

/* -1: go on; else the exit status. */
static int parse_options(int argc, char **argv, struct options *o)
{
	enum { OPT_CHECK = 256, OPT_BOARD, OPT_ROOT, OPT_RT };
	static const struct option table[] = {
		{ "config", required_argument, NULL, 'c' },
		{ "name", required_argument, NULL, 'n' },
		{ "target", required_argument, NULL, 't' },
		{ "listen", required_argument, NULL, 'l' },
		{ "check", no_argument, NULL, OPT_CHECK },
		{ "board", optional_argument, NULL, OPT_BOARD },
		{ "root", required_argument, NULL, OPT_ROOT },
		{ "rt", required_argument, NULL, OPT_RT },
		{ "verbose", no_argument, NULL, 'v' },
		{ "version", no_argument, NULL, 'V' },
		{ "help", no_argument, NULL, 'h' },
		{ 0 },
	};
	char *end;
	long priority;
	int c;

	*o = (struct options){ .instance = "OWS", .level = LOG_LEVEL_NOTICE };
	while ((c = getopt_long(argc, argv, "c:n:t:l:vVh", table, NULL)) != -1) {
		switch (c) {
		case 'c':
			o->file = optarg;
			break;
		case 'n':
			o->instance = optarg;
			break;
		case 't':
			if (o->target_count == CONFIG_TARGETS_MAX) {
				complain("-t %s: at most %d targets", optarg, CONFIG_TARGETS_MAX);
				return EXIT_USAGE;
			}
			o->targets[o->target_count++] = optarg;
			break;
		case 'l':
			if (o->listen_count == LISTENS_MAX) {
				complain("at most %d addresses to listen at", LISTENS_MAX);
				return EXIT_USAGE;
			}
			o->listens[o->listen_count++] = optarg;
			break;
		case OPT_CHECK:
			o->check = true;
			break;
		case OPT_BOARD:
			o->board = true;
			o->board_id = optarg;
			break;
		case OPT_ROOT:
			o->root = optarg;
			break;
		case OPT_RT:
			priority = strtol(optarg, &end, 10);
			if (*end || end == optarg || priority < 1 || priority > 99) {
				complain("--rt %s: a number from 1 to 99 expected", optarg);
				return EXIT_USAGE;
			}
			o->rt_priority = (int)priority;
			break;
		case 'v':
			if (o->level < LOG_LEVEL_DEBUG)
				o->level++;
			break;
		case 'V':
			version();
			return finish_output();
		case 'h':
			usage(stdout);
			return finish_output();
		default:
			usage(stderr);
			return EXIT_USAGE;
		}
	}
	if (optind < argc) {
		complain("unexpected argument '%s' (a file is given with -c)", argv[optind]);
		return EXIT_USAGE;
	}
	if (o->root && !o->board) {
		complain("--root goes with --board");
		return EXIT_USAGE;
	}
	if (!segment_name_ok(o->instance)) {
		complain("instance name '%s': 1 to %d letters, digits, '-', '_', '.' expected, "
		         "not first a dot",
		         o->instance, SEGMENT_NAME_MAX);
		return EXIT_USAGE;
	}
	if (!o->file) {
		snprintf(o->default_file, sizeof(o->default_file), DEFAULT_DIR "/%s.rio",
		         o->instance);
		o->file = o->default_file;
	}
	return -1;
}

/* ctx: a log, or NULL */
static int tell_board(const struct options *o)
{
	struct board_report report;
	char folder[400], why[800];
	int status;

	board_folder(folder, sizeof(folder));
	if (board_look(o->root ? o->root : "", folder, o->board_id, &report, why, sizeof(why))) {
		complain("%s", why);
		return EXIT_USAGE;
	}
	board_print(&report, stdout);
	status = finish_output();
	return report.missing ? EXIT_RUN : status;
}

static void say(void *ctx, bool is_error, const char *message)
{
	if (!ctx)
		fprintf(stderr, "%s\n", message);
	else if (is_error)
		log_err(ctx, "%s", message);
	else
		log_warning(ctx, "%s", message);
}

static int check_target(const struct config *config, const struct config_target *target,
                        struct config_report *report)
{
	struct place place = {target->line ? config->file : NULL, target->line, target->column};
	char why[256];
	int err = target_check(target->text, why, sizeof(why));

	if (err)
		report_error(report, place, "target \"%s\": %s", target->text, why);
	return err;
}

static int load(const struct options *o, struct log *log, struct config **config)
{
	struct config_report report = { .line = say, .ctx = log };
	int err = config_load(o->file, &report, config);

	if (err)
		return err;
	if (o->target_count)
		err = config_set_targets(*config, o->targets, o->target_count, &report);
	if (!err && o->listen_count)
		err = config_set_listens(*config, o->listens, o->listen_count, &report);
	if (!err)
		err = config_check_own(*config, &report);
	for (unsigned i = 0; !err && i < (*config)->target_count; i++)
		err = check_target(*config, &(*config)->targets[i], &report);
	if (!err)
		err = target_check_options(*config, &report);
	if (!err) {
		config_check_buses(*config, &report);
		return 0;
	}
	config_free(*config);
	return err;
}

/* Does stderr go to the journal, which reads levels from "<4>" prefixes? */
static int stderr_is_journal(void)
{
	const char *stream = getenv("JOURNAL_STREAM");
	unsigned long long device, inode;
	struct stat st;

	/* NOLINTNEXTLINE(cert-err34-c): a number out of range is none of ours either */
	return stream && sscanf(stream, "%llu:%llu", &device, &inode) == 2 &&
	       fstat(STDERR_FILENO, &st) == 0 && st.st_dev == device && st.st_ino == inode;
}

static void catch_signals(void)
{
	struct sigaction action = { .sa_handler = on_signal };

	sigemptyset(&action.sa_mask);
	sigaction(SIGTERM, &action, NULL);
	sigaction(SIGINT, &action, NULL);
	sigaction(SIGHUP, &action, NULL);
	action.sa_handler = SIG_IGN;
	sigaction(SIGPIPE, &action, NULL);
}

/* As in the file; what does not fit is counted. */
static void name_targets(const struct config *config, char *text, size_t size)
{
	size_t used = 0;

	for (unsigned i = 0; i < config->target_count; i++) {
		const struct config_target *target = &config->targets[i];
		const char *before = target->relation == CONFIG_FIRST   ? ""
		                     : target->relation == CONFIG_COMMA ? ", "
		                                                        : " | ";
		int n = snprintf(text + used, size - used, "%s%s", before, target->text);

		if (n < 0 || (size_t)n + 24 >= size - used) {
			snprintf(text + used, size - used, "%s%u%s", i ? " and " : "",
			         config->target_count - i, i ? " more" : " of them");
			return;
		}
		used += (size_t)n;
	}
}

/* What the service manager and the log are told of what is served. */
static void tell(const struct host *host, const struct options *o, struct log *log,
                 const struct notify *notify)
{
	const struct config *config = host_config(host);
	char targets[160];

	name_targets(config, targets, sizeof(targets));
	log_notice(log, "owsd %s: instance %s, %u signals from %s, target %s", OWSD_VERSION,
	           o->instance, config->item_count, o->file, targets);
	notify_status(notify, "%u signals, target %s", config->item_count, targets);
}

/* A file that is refused changes nothing. */
static void reload(struct host *host, const struct options *o, struct log *log,
                   const struct notify *notify)
{
	struct config *config;
	struct stat st;
	char why[512];

	/* a pipe would keep the supervisor from its work until somebody writes */
	if (stat(o->file, &st) == 0 && !S_ISREG(st.st_mode)) {
		log_err(log, "reload: %s is no regular file: all goes on as before", o->file);
		return;
	}
	if (load(o, log, &config)) {
		log_err(log, "reload: %s is refused: all goes on as before", o->file);
		return;
	}
	if (host_reload(host, config, why, sizeof(why))) {
		config_free(config);
		log_err(log, "reload: %s: all goes on as before", why);
		return;
	}
	tell(host, o, log, notify);
}

/* Write the log, feed the watchdog while the engine's heart beats, until a signal ends it. */
static void supervise(struct host *host, const struct options *o, struct log *log,
                      const struct notify *notify, int prefix)
{
	int64_t fed_ns = 0, wait_ns = SUPERVISE_NS;

	if (notify->watchdog_ns && notify->watchdog_ns / 4 < wait_ns)
		wait_ns = notify->watchdog_ns / 4;
	while (!stop_signal) {
		uint32_t seen = __atomic_load_n(log_word(log), __ATOMIC_ACQUIRE);
		int64_t now_ns, period_ns;

		if (hangup && host_may_reload(host)) {
			hangup = 0; /* one that comes from here on means a newer file */
			notify_send(notify, NOTIFY_RELOADING);
			reload(host, o, log, notify);
			notify_send(notify, NOTIFY_READY);
		}
		now_ns = ows_now();
		period_ns = host_config(host)->period_ns;
		/* the heart beats once a period, which may be longer than the watchdog's time */
		if (notify->watchdog_ns && now_ns - fed_ns >= notify->watchdog_ns / 4 &&
		    now_ns - host_beat(host) <= 2 * period_ns + notify->watchdog_ns / 4) {
			fed_ns = now_ns;
			notify_send(notify, NOTIFY_WATCHDOG);
		}
		host_tend(host);
		log_drain(log, STDERR_FILENO, prefix);
		if (!stop_signal)
			segment_wait(log_word(log), seen, hangup ? AGAIN_NS : wait_ns);
	}
}

static int run(const struct options *o, struct config *config, struct log *log)
{
	struct host_setup setup = {
		.config = config,
		.instance = o->instance,
		.log = log,
		.rt_priority = o->rt_priority,
	};
	int prefix = stderr_is_journal();
	struct notify notify;
	struct host *host;
	char why[512];
	bool ended;

	if (notify_open(&notify))
		log_warning(log, "NOTIFY_SOCKET cannot be used");
	if (host_start(&setup, &host, why, sizeof(why))) {
		log_finish(log, STDERR_FILENO, prefix);
		complain("%s", why);
		return EXIT_RUN;
	}
	tell(host, o, log, &notify);
	notify_send(&notify, NOTIFY_READY);
	supervise(host, o, log, &notify, prefix);
	log_notice(log, "owsd ends: %s", stop_signal == SIGTERM ? "SIGTERM" : "SIGINT");
	notify_send(&notify, NOTIFY_STOPPING);
	ended = host_stop(host, STOP_NS);
	if (!ended)
		log_err(log, "a bus is stuck in the kernel; owsd leaves it behind");
	log_finish(log, STDERR_FILENO, prefix);
	if (!ended)
		_exit(EXIT_SUCCESS);
	notify_close(&notify);
	return EXIT_SUCCESS;
}

int main(int argc, char **argv)
{
	struct config *config;
	struct options o;
	struct log *log;
	bool stolen = false;
	pid_t owner = 0;
	int status, lock;

#ifdef __GLIBC__
	/* What is used little of a large block stays zero pages. Else the limit rises by itself */
	mallopt(M_MMAP_THRESHOLD, 64 * 1024);
#endif
	status = standard_open();
	if (status) {
		complain("/dev/null: %s", strerror(-status));
		return EXIT_RUN;
	}
	/* a file that may not grow is an error of the write like another */
	signal(SIGXFSZ, SIG_IGN);
	status = parse_options(argc, argv, &o);
	if (status >= 0)
		return status;
	if (o.board)
		return tell_board(&o);
	if (load(&o, NULL, &config))
		return EXIT_USAGE;
	if (o.check) {
		config_print(config, stdout);
		config_free(config);
		return finish_output();
	}
	log = log_create(o.level);
	if (!log) {
		complain("no memory for the log");
		return EXIT_RUN;
	}
	supervisor_word = log_word(log);
	catch_signals();
	lock = segment_lock(o.instance, &owner, &stolen);
	if (lock == -EBUSY) {
		complain("instance %s is already served by process %d; end it or choose another "
		         "name with -n",
		         o.instance, (int)owner);
		return EXIT_RUN;
	}
	if (lock < 0) {
		complain("cannot lock instance %s: %s%s", o.instance, strerror(-lock),
		         lock == -EPERM    ? " (a file of another user, or none that is plain, is in "
		                             "the way in /dev/shm)"
		         : lock == -ENOSPC ? " (/dev/shm is full)"
		                           : "");
		return EXIT_RUN;
	}
	if (stolen)
		log_warning(log, "the owsd before cannot die (stuck in the kernel): its lock is left");
	status = run(&o, config, log);
	close(lock);
	log_destroy(log);
	return status;
}
