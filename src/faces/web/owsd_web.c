/* SPDX-License-Identifier: MIT */
/* owsd-web: shows the signals of an owsd in a browser. */
#include <errno.h>
#include <math.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#include "hal/base/bell.h"
#include "hal/base/time.h"
#include "src/faces/kit/look.h"
#include "src/faces/kit/loop.h"
#include "src/faces/show/newest.h"
#include "src/faces/web/edit.h"
#include "src/faces/web/events.h"
#include "src/faces/web/http.h"
#include "src/faces/web/others.h"
#include "src/faces/web/paths.h"
#include "src/faces/web/show.h"
#include "src/faces/web/stream.h"
#include "src/faces/web/web.h"
#include "src/faces/web/wire.h"
#include "src/ground/service/listen.h"
#include "src/ground/signal/hash.h"

/* Connections, files that are sent, what the porter has not yet taken, and a few more */
#define DESCRIPTORS (3 * DOORS_CONNECTIONS)
#define TICK_NS NS_PER_S
/* Streams have a pace of their own: that of the face is for what comes in bursts */
#define PACE_NS (20 * NS_PER_MS)
#define ENDING_NS (300 * NS_PER_MS) /* slow clients keep no end waiting for longer */
#define MIX 0x9e3779b97f4a7c15u

/* No signal changes when owsd refuses its file: pages are told of it here. */
static void look_for_refusal(struct web *web)
{
	struct ows_log_line line = {.number = 0};

	if (web->face->live && look_is_current(web->face))
		ows_refused_reload(web->face->ows, &line);
	if (line.number == web->refused)
		return;
	web->refused = line.number;
	stream_wake_all(web);
}

/*
 * Something may have happened: changes go out that are due, libmicrohttpd has its turn, and says
 * when it wants the next.
 */
static void owsd_web_run(struct web *web)
{
	int64_t now_ns = ows_now(), begin = clock_ns(CLOCK_THREAD_CPUTIME_ID);

	/* changes may come so often that there is no tick between them */
	if (now_ns >= web->alive_ns) {
		web->alive_ns = now_ns + EVENTS_ALIVE_S * NS_PER_S / 5;
		stream_wake_all(web);
	}
	look_for_refusal(web);
	if (pace_send(&web->pace, now_ns, web->recent.newest))
		stream_wake_all(web);
	http_run(web);
	wire_run(now_ns);
	face_status(web->face, "%u streams, %d signals%s", web->stream_count, web->recent.count,
	            web->face->live ? "" : ", owsd is not running");
	pace_spent(&web->pace, clock_ns(CLOCK_THREAD_CPUTIME_ID) - begin);
	now_ns = ows_now();
	web->face->tick_ns = earlier_ns(
		earlier_ns(now_ns + TICK_NS, pace_due(&web->pace)),
		earlier_ns(http_next(web, now_ns), doors_next(&web->doors)));
	web->face->tick_ns = earlier_ns(web->face->tick_ns, wire_next(now_ns));
}

/* --- Doors ----------------------------------------------------------------------------------- */

static int open_socket(struct web *web)
{
	char path[FACE_PATH];
	int err = face_socket(web->face->arguments, "web", path);

	if (err)
		return err;
	err = doors_socket(&web->doors, path);
	if (err)
		face_complain("owsd-web", "%s: %s%s", path, strerror(-err),
		              err == -EADDRINUSE ? "; another owsd-web serves the page there" : "");
	else
		log_notice(web->face->log, "the page is at the socket %s", path);
	return err;
}

static const char *serves(const struct config_web *options)
{
	return options->proxy_at.bits ? ": for the proxy alone"
	       : options->configure   ? ": whoever reaches it may configure"
	       : options->write       ? ": whoever reaches it may command"
	                              : ": whoever reaches it may look";
}

static void tell_address(struct face *face, const struct listen_address *address, bool served)
{
	const struct web *web = face->own;
	bool local = listen_is_loopback(address), proxy = face->config->web.proxy_at.bits;
	char text[LISTEN_TEXT_MAX];

	listen_print(address, text);
	if (served)
		log_at(face->log, local || proxy ? LOG_LEVEL_NOTICE : LOG_LEVEL_WARNING,
		       "the page is at http://%s/%s", text, local && !proxy ? "" : web->serves);
	else
		log_notice(face->log, "the page is no longer at http://%s/", text);
}

/* What Listen says now: doors of the socket and of the service manager stay, as does that of -l. */
static void follow_addresses(struct web *web)
{
	const struct config_web *options = &web->face->config->web;

	if (!web->face->arguments->option)
		listeners_follow(&web->doors.listeners, options->addresses, options->address_count,
		                 ows_now());
}

/* Option -l, else Listen of the block. */
static int open_addresses(struct web *web)
{
	const char *given = web->face->arguments->option, *why = "";
	struct listen_address addresses[2];
	int n = given ? listen_parse(given, strlen(given), addresses, &why) : 0;

	if (n < 0)
		face_complain("owsd-web", "-l %s: %s", given, why);
	else if (given)
		listeners_follow(&web->doors.listeners, addresses, (unsigned)n, ows_now());
	follow_addresses(web);
	return n < 0 ? n : 0;
}

static int open_doors(struct web *web)
{
	int n, err;

	web->doors.listeners.face = web->face;
	web->doors.listeners.tell = tell_address;
	n = doors_open(&web->doors);
	if (!n)
		n = doors_inherit(&web->doors);
	if (n < 0) {
		face_complain("owsd-web", "cannot listen: %s", strerror(-n));
		return n;
	}
	err = n ? 0 : open_socket(web);
	web->serves = serves(&web->face->config->web);
	return err ? err : open_addresses(web);
}

/* An address that stays may serve others now. */
static void follow_rights(struct web *web)
{
	const char *before = web->serves;

	web->serves = serves(&web->face->config->web);
	if (strcmp(before, web->serves) != 0)
		listeners_tell(&web->doors.listeners);
}

/* --- The page -------------------------------------------------------------------------------- */

#define FILES_PATH 1024

/*
 * Where Files says; else where this program was installed, or where it was built. path: where they
 * were looked for. As files_open().
 */
static int find_files(const char *given, char path[FILES_PATH])
{
	static const char *const beside[] = {"../share/owsd/web", "page"};
	char program[512];
	ssize_t len = readlink("/proc/self/exe", program, sizeof(program) - 1);
	int fd = -ENOENT;

	program[len > 0 ? len : 0] = '\0';
	if (strrchr(program, '/'))
		*strrchr(program, '/') = '\0';
	if (given) {
		snprintf(path, FILES_PATH, "%s", given);
		return files_open(path);
	}
	for (size_t i = 0; fd < 0 && i < sizeof(beside) / sizeof(beside[0]); i++) {
		snprintf(path, FILES_PATH, "%s/%s", program, beside[i]);
		fd = files_open(path);
	}
	return fd;
}

static void open_files(struct web *web)
{
	char path[FILES_PATH];

	web->files = find_files(web->face->config->web.files, path);
	if (web->files < 0)
		log_warning(web->face->log, "there are no files of the page in %s: %s", path,
		            strerror(-web->files));
}

static void close_files(const struct web *web)
{
	if (web->files >= 0)
		close(web->files);
}

static int check(const struct face *face)
{
	char path[FILES_PATH];
	int fd = find_files(face->config->web.files, path);

	if (fd < 0)
		face_complain(face->ops->program,
		              "there are no files of the page in %s: %s; without Files those of "
		              "the package are served",
		              path, strerror(-fd));
	else
		close(fd);
	return fd == -EACCES || fd >= 0 ? 0 : fd; /* the service may be another user */
}

/* The machines that Others names now. */
static void follow_others(struct web *web)
{
	const char *list = web->face->config->web.others;

	if (others_has(web->others, list))
		return;
	others_end(web->others);
	web->others = others_begin(list);
}

/* The configuration was read again: what was made of it at the start is made anew. */
static void follow_file(struct web *web)
{
	web->face->config->web.configure |= edit_is_on();
	follow_rights(web);
	follow_addresses(web);
	follow_others(web);
	close_files(web);
	open_files(web);
}

/* --- The face -------------------------------------------------------------------------------- */

static void raise_limit(void)
{
	struct rlimit limit;

	if (getrlimit(RLIMIT_NOFILE, &limit) || limit.rlim_cur >= DESCRIPTORS)
		return;
	limit.rlim_cur = limit.rlim_max < DESCRIPTORS ? limit.rlim_max : DESCRIPTORS;
	setrlimit(RLIMIT_NOFILE, &limit);
}

static int open_web(struct face *face)
{
	static struct web web;
	int err;

	web.doors.epoll = web.files = -1;
	web.face = face;
	web.since_ns = ows_now();
	web.route = api_find;
	face->own = &web;
	face->config->web.configure |= edit_is_on();
	face->pace_ns = PACE_NS;
	face->alarms_after_ns = face->commands_after_ns = face->tick_ns = ows_now();
	recent_make(&web.recent, 0);
	events_miss_alarms(&web);
	raise_limit();
	err = wire_open(face->log);
	if (err) {
		face_complain(face->ops->program, "cannot start the process for connections: %s",
		              strerror(-err));
		return err;
	}
	err = http_open(&web);
	if (err)
		face_complain(face->ops->program, "libmicrohttpd: %s", strerror(-err));
	if (!err)
		err = open_doors(&web);
	if (err) {
		doors_close(&web.doors); /* with the socket that one of them may have made */
		return err;
	}
	open_files(&web);
	follow_others(&web);
	web.bell = bell_open();
	if (web.bell >= 0)
		face_watch(face, web.bell, POLLIN);
	face_watch(face, web.epoll, POLLIN);
	face_watch(face, web.doors.epoll, POLLIN);
	return 0;
}

/* A number that is another one when the row of the signal is, its age included. */
static uint64_t mark_of(const struct web *web, int signal, int64_t now_ns)
{
	const struct show show = {.h = web->face->ows, .live = true, .ids = web->ids};
	char words[SHOW_ALARM];
	const char *alarm = show_alarm(&show, signal, words);
	struct face_value value;
	uint64_t mark;

	face_value(show.h, signal, true, now_ns, &value);
	mark = (face_value_print(&value.v, value.text) ^ (uint64_t)value.v.measured_ns) * MIX;
	mark = (mark ^ (uint32_t)value.v.err) * MIX;
	if (show_commanded(&show, signal, &value))
		mark = hash_text(mark, (const char *)&value.v.number, sizeof(value.v.number));
	return hash_text(mark, alarm, strlen(alarm));
}

static void changes(struct face *face, const int *signals, int n)
{
	struct web *web = face->own;
	int64_t now_ns = ows_now();
	uint64_t before = web->recent.newest;

	for (int i = 0; i < (signals ? n : web->recent.count); i++) {
		int signal = signals ? signals[i] : i;

		recent_change(&web->recent, signal, mark_of(web, signal, now_ns), now_ns);
	}
	web->pace.waits |= web->recent.newest != before;
	owsd_web_run(web);
}

/* To look a name up takes long where there are many. */
static int id_of(struct ows *h, int signal)
{
	struct ows_info info;

	if (ows_info(h, signal, &info) ||
	    (!info.output && !info.alarm && isnan(info.limit_hh) && isnan(info.limit_h) &&
	     isnan(info.limit_l) && isnan(info.limit_ll)))
		return -1;
	return ows_find(h, info.name);
}

/* The table of signals is new. */
static void owsd_web_find(struct web *web)
{
	struct ows_daemon daemon = {0};
	int count = ows_count(web->face->ows);

	ows_daemon(web->face->ows, ows_now(), &daemon);
	web->generation = daemon.generation;
	shared_forget(&web->shared);
	free(web->ids);
	web->ids = malloc((size_t)(count + 1) * sizeof(*web->ids));
	if (!web->ids || !recent_make(&web->recent, count)) {
		log_err(web->face->log, "no memory for %d signals", count);
		recent_make(&web->recent, 0);
		return;
	}
	for (int i = 0; i < count; i++)
		web->ids[i] = id_of(web->face->ows, i);
}

static void open_door(struct web *web)
{
	doors_empty(&web->doors, face_came(web->face, web->doors.epoll));
	doors_take(&web->doors, ows_now());
}

static void event(struct face *face, const struct face_event *event)
{
	struct web *web = face->own;

	switch (event->news) {
	case FACE_FOUND:
	case FACE_RELOADED:
		follow_file(web);
		owsd_web_find(web);
		break;
	case FACE_ALARM:
		events_alarm(web, event->alarm);
		break;
	case FACE_LOST:
		log_warning(face->log, "owsd is lost: no value is good");
		break;
	case FACE_ENTRIES_LOST:
		events_miss_alarms(web);
		break;
	case FACE_OVERRUN:
	case FACE_COMMAND:
		return;
	case FACE_FILE:
		follow_file(web);
		return;
	case FACE_DESCRIPTOR:
		if (event->fd == web->bell) {
			bell_clear(web->bell);
			http_done(web);
		}
		if (event->fd == web->doors.epoll)
			open_door(web);
		owsd_web_run(web);
		return;
	}
	stream_wake_all(web);
	owsd_web_run(web);
}

static void tick(struct face *face, int64_t now_ns)
{
	struct web *web = face->own;

	if (now_ns >= doors_next(&web->doors))
		open_door(web);
	owsd_web_run(web);
}

/* A request whose body comes then is refused. */
static void end_jobs(struct web *web)
{
	web->ends = true;
	for (int i = 0; i < WEB_WORKERS; i++) {
		if (!web->workers[i])
			continue;
		jobs_end(web->workers[i]);
		http_done(web);
		jobs_free(web->workers[i]);
		web->workers[i] = NULL;
	}
}

/* Each stream has a proper end: Cockpit's bridge of Debian 12 would wait for it for ever. */
static void end_streams(struct web *web)
{
	struct pollfd ready = {.fd = web->epoll, .events = POLLIN};
	int64_t until_ns = ows_now() + ENDING_NS;

	do {
		stream_wake_all(web);
		http_run(web);
	} while (web->streams && ows_now() < until_ns && poll(&ready, 1, 20) >= 0);
}

static void close_web(struct face *face)
{
	struct web *web = face->own;

	end_jobs(web);
	others_end(web->others);
	web->others = NULL;
	doors_close(&web->doors);
	end_streams(web);
	http_close(web);
	wire_end();
	events_forget_alarms(web);
	shared_forget(&web->shared);
	recent_free(&web->recent);
	free(web->ids);
	close(web->bell);
	close_files(web);
}

int main(int argc, char **argv)
{
	static const struct face_ops ops = {
		.program = "owsd-web",
		.option = {'l', "listen", "ADDRESS", "also serve there, in place of Listen",
	                   .more = EDIT_HELP},
		.check = check,
		.open = open_web,
		.changes = changes,
		.event = event,
		.tick = tick,
		.close = close_web,
	};

	return edit_begin(&argc, &argv) ? face_main(&ops, argc, argv) : FACE_EXIT_USAGE;
}
