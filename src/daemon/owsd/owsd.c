/* SPDX-License-Identifier: MIT */
/* owsd's main program: start-up, supervision, reload and end. */
#include <errno.h>

#include "hal/base/time.h"
#include "src/config/edit/print.h"
#include "src/config/read/buses.h"
#include "src/config/read/load.h"
#include "src/config/read/report.h"
#include "src/config/read/targets.h"
#include "src/daemon/host/host.h"
#include "src/daemon/host/reload.h"
#include "src/daemon/host/target.h"
#include "src/daemon/owsd/arguments.h"
#include "src/daemon/owsd/instance.h"
#include "src/ground/board/board.h"
#include "src/ground/board/look.h"
#include "src/ground/board/report.h"
#include "src/ground/service/notify.h"
#include "src/ground/service/resident.h"
#include "src/ground/service/streams.h"
#include "src/ground/service/unix_signals.h"
#include "src/ground/text/log.h"
#include "src/ground/text/shell.h"
#include "src/memory/control/control.h"
#include "src/memory/shm/porter.h"
#include "src/public/ows.h"
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

/* Five for each of 128 programs that command, 512 for clients of the served protocol, and some. */
#define DESCRIPTORS 1280
#define STOP_NS (2 * NS_PER_S)
/* How often the supervisor looks for the names of its files, and at a log that is stuck */
#define SUPERVISE_NS NS_PER_S
#define ADDRESSES_NS (2 * NS_PER_S)
/* after the start: all targets were asked for their first values, as far as they answer */
#define SETTLED_NS (10 * NS_PER_S)
#define AGAIN_NS (20 * NS_PER_MS) /* a reload that has to wait */
/* From the end of a reload to the next: reloads take at most a tenth of the time */
#define APART_LEAST_NS (200 * NS_PER_MS)
#define APART_MOST_NS (10 * NS_PER_S)

static int print_board(const struct arguments *a)
{
	struct board_report report;
	char folder[400], why[800];
	int status;

	board_folder(folder, sizeof(folder));
	if (board_look(a->root ? a->root : "", folder, a->board_id, &report, why, sizeof(why))) {
		complain("%s", why);
		return EXIT_USAGE;
	}
	board_print(&report, stdout);
	status = finish_output();
	return report.missing ? EXIT_RUN : status;
}

/* Where the messages about a configuration go. */
struct told {
	struct log *log; /* NULL: stderr, by line */
	char *why;       /* gets the first error; NULL: it is not wanted */
	size_t why_size;
	char warning[256]; /* the one that stands first in the file; "": there is none */
	int warning_line;
	struct config_report report;
	struct found {
		int line;
		char *message;
	} found[2 * (REPORT_MAX + 1)];
	unsigned count;
};

/* The file is gone through several times: what stands first in it is to be shown first. */
static void keep_line(struct told *told, const char *message)
{
	unsigned at = told->count;
	char *copy = at < sizeof(told->found) / sizeof(told->found[0]) ? strdup(message) : NULL;

	if (!copy) {
		fprintf(stderr, "%s\n", message);
		return;
	}
	for (; at && told->found[at - 1].line > told->report.at_line; at--)
		told->found[at] = told->found[at - 1];
	told->found[at] = (struct found){told->report.at_line, copy};
	told->count++;
}

static void print_lines(struct told *told)
{
	for (unsigned i = 0; i < told->count; i++) {
		fprintf(stderr, "%s\n", told->found[i].message);
		free(told->found[i].message);
	}
	told->count = 0;
}

static void report_line(void *ctx, bool is_error, const char *message)
{
	struct told *told = ctx;

	if (!told->log)
		keep_line(told, message);
	else if (is_error)
		log_err(told->log, "%s", message);
	else
		log_warning(told->log, "%s", message);
	if (is_error && told->why && !*told->why)
		snprintf(told->why, told->why_size, "%s", message);
	if (!is_error && (!*told->warning || told->report.at_line < told->warning_line)) {
		told->warning_line = told->report.at_line;
		snprintf(told->warning, sizeof(told->warning), "%s", message);
	}
}

static bool has_file(const struct arguments *a)
{
	return access(a->file, F_OK) == 0 || errno != ENOENT;
}

static int read_config(const struct arguments *a, struct config_report *report,
                       struct config **config)
{
	static const char empty[] = "OwsDrv {\n}\n";

	if (!a->needs_no_file || has_file(a))
		return config_load(a->file, report, config);
	return config_parse("no file", empty, sizeof(empty) - 1, report, config);
}

static int owsd_load(const struct arguments *a, struct told *told, struct config **config)
{
	struct config_report *report = &told->report;

	*report = (struct config_report){.line = report_line, .ctx = told, .keeps_wrong = true};
	int err = read_config(a, report, config);

	if (!err && a->target_count)
		err = config_set_targets(*config, a->targets, a->target_count, report);
	if (!err && a->listen_count)
		err = config_set_listens(*config, a->listens, a->listen_count, report);
	/* of a file with errors its items: one run names all that is wrong */
	if (*config && (!err || err == -EINVAL))
		err = target_check_config(*config, report);
	if (!err && a->check)
		err = target_look(*config, report);
	print_lines(told);
	if (!err && a->strict && report->warnings) {
		complain("--strict: %u warning%s", report->warnings,
		         report->warnings == 1 ? "" : "s");
		err = -EINVAL;
	}
	if (!err)
		config_hash_files(*config);
	else
		config_free(*config);
	return err;
}

/* Use all descriptors that the hard limit allows. */
static void raise_descriptors(struct log *log)
{
	struct rlimit files;

	if (getrlimit(RLIMIT_NOFILE, &files) < 0)
		return;
	files.rlim_cur = files.rlim_max;
	if (setrlimit(RLIMIT_NOFILE, &files) < 0 && getrlimit(RLIMIT_NOFILE, &files) < 0)
		return;
	if (files.rlim_cur < DESCRIPTORS)
		log_warning(
			log,
			"at most %llu descriptors (RLIMIT_NOFILE): too few for all programs that "
			"may connect, which need %d",
			(unsigned long long)files.rlim_cur, DESCRIPTORS);
}

/* The targets as in the file; text ends with the number of those that do not fit. */
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

/* What `systemctl status` shows. */
struct shown {
	struct notify *notify;
	char state[600];
	unsigned absent; /* of host_absent() */
	char why[LISTEN_WHY_MAX];
};

static void show_state(const struct shown *shown)
{
	notify_status(shown->notify, "%s%s%s", shown->state, *shown->why ? "; " : "", shown->why);
}

/* Report to the log and to the service manager what owsd serves. */
static void report_served(const struct host *host, const struct arguments *a, struct log *log,
                          struct shown *shown)
{
	const struct config *config = host_config(host);
	char targets[160];

	name_targets(config, targets, sizeof(targets));
	log_notice(log, "owsd %s: instance %s, %u signal%s from %s, target %s", OWSD_VERSION,
	           a->instance, config->item_count, config->item_count == 1 ? "" : "s",
	           config->file, targets);
	snprintf(shown->state, sizeof(shown->state), "%u signal%s, target %s", config->item_count,
	         config->item_count == 1 ? "" : "s", targets);
	show_state(shown);
}

/* In why, for who asked: what the file that was taken over is warned of; "": of nothing. */
static void name_warnings(const struct told *told, const struct shown *shown, char *why,
                          size_t why_size)
{
	unsigned n = told->report.warnings + shown->absent;

	*why = '\0';
	if (n)
		snprintf(why, why_size, "%u warning%s; the first: %s", n, n == 1 ? "" : "s",
		         *told->warning ? told->warning : shown->why);
}

/* Load the file again and serve it; a file that is refused changes nothing. */
static int reload_file(struct host *host, const struct arguments *a, struct log *log,
                       const struct shown *shown, char *why, size_t why_size)
{
	struct told told = {.log = log, .why = why, .why_size = why_size};
	struct config *config;
	int err = owsd_load(a, &told, &config);

	if (err) {
		log_err(log, "reload: %s is refused: all goes on as before", a->file);
		return err;
	}
	err = host_reload(host, config, why, why_size);
	if (err) {
		config_free(config);
		log_err(log, "reload: %s: all goes on as before", why);
	} else {
		name_warnings(&told, shown, why, why_size);
	}
	return err;
}

static void reload(struct host *host, const struct arguments *a, struct log *log,
                   struct shown *shown)
{
	char why[512] = "";
	int err;

	notify_send(shown->notify, NOTIFY_RELOADING);
	control_take_askers(host_control(host));
	err = reload_file(host, a, log, shown, why, sizeof(why));
	if (!err) {
		report_served(host, a, log, shown);
	} else {
		host_refused(host, err, why);
		snprintf(shown->state, sizeof(shown->state),
		         "reload refused, all goes on as before: %s", why);
		show_state(shown);
	}
	control_answer(host_control(host), err, why);
	notify_send(shown->notify, NOTIFY_READY);
}

/* Addresses of this machine come and go. */
static void look_for_addresses(struct host *host, struct shown *shown)
{
	char why[LISTEN_WHY_MAX];

	shown->absent = host_absent(host, why);
	if (strcmp(why, shown->why) == 0)
		return;
	memcpy(shown->why, why, sizeof(why));
	show_state(shown);
}

/* When the next reload may begin. */
static int64_t reload_after(int64_t begun_ns)
{
	int64_t now_ns = ows_now(), apart_ns = 10 * (now_ns - begun_ns);

	if (apart_ns < APART_LEAST_NS)
		apart_ns = APART_LEAST_NS;
	return now_ns + (apart_ns < APART_MOST_NS ? apart_ns : APART_MOST_NS);
}

/*
 * Write the log and feed the watchdog while the engine's heart beats. Returns true when a signal
 * ends owsd, false when another owsd has the instance.
 */
static bool supervise(struct host *host, const struct arguments *a, struct instance *instance,
                      struct log *log, struct shown *shown, int prefix,
                      struct unix_signals *signals)
{
	struct notify *notify = shown->notify;
	const int bells[] = {log_bell(log), control_asked_bell(host_control(host))};
	int64_t fed_ns = 0, reload_ns = 0, wait_ns = SUPERVISE_NS, drop_ns = ows_now() + SETTLED_NS,
		look_ns = 0;
	bool wanted;

	if (notify->watchdog_ns && notify->watchdog_ns / 4 < wait_ns)
		wait_ns = notify->watchdog_ns / 4;
	while (!signals->end) {
		int64_t now_ns = ows_now();

		wanted = control_asked(host_control(host)) || signals->reload;
		if (wanted && now_ns >= reload_ns && host_may_reload(host)) {
			signals->reload = wanted = false;
			reload(host, a, log, shown);
			reload_ns = reload_after(now_ns);
		}
		now_ns = ows_now();
		/* the engine's heart may beat less often than the watchdog's time */
		if (notify->watchdog_ns && now_ns - fed_ns >= notify->watchdog_ns / 4 &&
		    now_ns - host_beat(host) <=
		            2 * host_beats_apart(host) + notify->watchdog_ns / 4) {
			fed_ns = now_ns;
			notify_send(notify, NOTIFY_WATCHDOG);
		}
		if (now_ns >= drop_ns) {
			drop_ns = INT64_MAX;
			resident_drop_start();
		}
		if (!instance_keep(instance, log))
			return false;
		host_tend(host);
		if (now_ns >= look_ns) {
			look_ns = now_ns + ADDRESSES_NS;
			look_for_addresses(host, shown);
		}
		log_drain(log, STDERR_FILENO, prefix);
		unix_signals_wait(signals, bells, wanted ? AGAIN_NS : wait_ns);
	}
	return true;
}

static int owsd_run(const struct arguments *a, struct config *config, struct instance *instance,
                    struct log *log, struct porter *porter, struct unix_signals *signals)
{
	struct host_setup setup = {
		.config = config,
		.instance = a->instance,
		.dir = &instance->dir,
		.log = log,
		.porter = porter,
		.rt_priority = a->rt_priority,
	};
	int prefix = journal_is_stderr();
	struct notify notify;
	struct shown shown = {.notify = &notify};
	struct host *host;
	char why[512];
	bool ended, ours;

	if (notify_open(&notify))
		log_warning(log, "NOTIFY_SOCKET cannot be used");
	if (host_start(&setup, &host, why, sizeof(why))) {
		instance_abandon(instance);
		log_finish(log, STDERR_FILENO, prefix);
		complain("%s", why);
		return EXIT_RUN;
	}
	host_show_log(host, true);
	report_served(host, a, log, &shown);
	notify_send(&notify, NOTIFY_READY);
	ours = supervise(host, a, instance, log, &shown, prefix, signals);
	log_notice(log, "owsd ends: %s",
	           !ours                     ? "another process serves the instance"
	           : signals->end == SIGTERM ? "SIGTERM"
	                                     : "SIGINT");
	notify_send(&notify, NOTIFY_STOPPING);
	log_drain(log, STDERR_FILENO, prefix);
	host_show_log(host, false);
	ended = host_stop(host, STOP_NS);
	if (!ended)
		log_err(log, "a bus is stuck in the kernel; owsd gives it up");
	log_finish(log, STDERR_FILENO, prefix);
	if (!ended)
		_exit(ours ? EXIT_SUCCESS : EXIT_RUN);
	notify_close(&notify);
	return ours ? EXIT_SUCCESS : EXIT_RUN;
}

/* What is proposed works: a target that would be refused is reported instead. */
static void explain_no_file(const struct arguments *a, struct told *told)
{
	const char *target = a->target_count ? a->targets[0] : "auto";
	char first[TARGET_MAX + 1], word[SHELL_WORD];
	struct arguments devices = *a;
	struct config *config;

	devices.needs_no_file = true;
	if (owsd_load(&devices, told, &config))
		return;
	config_free(config);
	snprintf(first, sizeof(first), "%.*s", (int)strcspn(target, ",|"), target);
	complain("-c FILE names another; owsctl%s -t %s scan --rio makes one",
	         strncmp(target, "sim:", 4) == 0 ? "-sim" : "", shell_word(first, word));
	complain("to serve the devices without a configuration, give %s",
	         a->target_count   ? "-l PORT too"
	         : a->listen_count ? "-t TARGET too"
	                           : "-t TARGET and -l PORT");
}

int main(int argc, char **argv)
{
	struct told told = {0};
	struct config *config;
	struct arguments a;
	struct instance instance;
	struct unix_signals signals;
	struct porter *porter;
	struct log *log;
	char why[512];
	int status;

	heap_give_back();
	status = standard_open();
	if (status) {
		complain("/dev/null: %s", strerror(-status));
		return EXIT_RUN;
	}
	status = arguments_parse(argc, argv, &a);
	if (status >= 0)
		return status;
	if (a.board)
		return print_board(&a);
	/* decided once: when the file is removed later, a reload reports it as missing */
	a.needs_no_file = a.file == a.default_file && a.target_count && a.listen_count &&
	                  !has_file(&a);
	if (owsd_load(&a, &told, &config)) {
		if (a.file == a.default_file && !a.needs_no_file && !has_file(&a))
			explain_no_file(&a, &told);
		return EXIT_USAGE;
	}
	if (a.check) {
		config_print(config, stdout);
		config_free(config);
		return finish_output();
	}
	/* before the first thread, and before there is anything that only one process may have */
	status = porter_start(&porter);
	if (status) {
		complain("cannot start the process for connections: %s", strerror(-status));
		return EXIT_RUN;
	}
	log = log_create(a.level);
	if (!log) {
		complain("no memory or no descriptor for the log");
		return EXIT_RUN;
	}
	status = unix_signals_open(&signals);
	if (status) {
		complain("cannot take signals: %s", strerror(-status));
		return EXIT_RUN;
	}
	raise_descriptors(log);
	if (instance_take(&instance, a.instance, log, why, sizeof(why))) {
		complain("%s", why);
		return EXIT_RUN;
	}
	status = owsd_run(&a, config, &instance, log, porter, &signals);
	porter_end(porter);
	instance_leave(&instance);
	log_destroy(log);
	return status;
}
