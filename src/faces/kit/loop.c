/* SPDX-License-Identifier: MIT */
/* The program of a face: its start, its loop, its end. */
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "hal/base/time.h"
#include "src/config/read/load.h"
#include "src/faces/kit/look.h"
#include "src/faces/kit/loop.h"
#include "src/ground/service/command_age.h"
#include "src/ground/service/resident.h"
#include "src/ground/service/streams.h"
#include "src/ground/service/unix_signals.h"

#define REPORT_NS (5 * NS_PER_S)

/* --- The report ------------------------------------------------------------------------------ */

/*
 * A small file in which a face says how it does, for `owsctl stats`. It is RUNTIME_DIRECTORY/status
 * of a service, else OWS_DIR/INSTANCE.PROGRAM; without either there is none. Lines of a word and
 * its value: pid, beat (the boot time of the report, ns), status, loaded (that of the
 * configuration), refused (why it does not count); what face_ops.report writes: since (a boot
 * time), trouble (the last one counts), troubled (its boot time), count NAME NUMBER.
 */
static void report_open(struct face *face)
{
	const char *own = getenv("RUNTIME_DIRECTORY"), *all = getenv("OWS_DIR");
	size_t size = sizeof(face->report);
	int len = 0;

	if (own && *own == '/')
		len = snprintf(face->report, size, "%s/status", own);
	else if (all && *all == '/')
		len = snprintf(face->report, size, "%s/%s.%s", all, face->arguments->instance,
		               face->ops->program);
	if (len >= (int)size)
		face->report[0] = '\0';
}

/* When it is due, or the status is another. It is replaced in one step; an error is not logged. */
static void report_write(struct face *face, int64_t now_ns)
{
	char fresh[sizeof(face->report) + 4];
	FILE *out;
	int fd;

	if (!*face->report || now_ns < face->report_ns)
		return;
	face->report_ns = now_ns + REPORT_NS;
	snprintf(fresh, sizeof(fresh), "%s.new", face->report);
	unlink(fresh);
	fd = open(fresh, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0640);
	out = fd < 0 ? NULL : fdopen(fd, "w");
	if (!out) {
		if (fd >= 0)
			close(fd);
		return;
	}
	/* the umask of a service may keep the group out, which may read the signals */
	fchmod(fd, 0640);
	fprintf(out, "pid %ld\nbeat %lld\nstatus %s\n", (long)getpid(), (long long)now_ns,
	        face->status);
	fprintf(out, "loaded %lld\n", (long long)face->loaded_ns);
	if (*face->refused)
		fprintf(out, "refused %s\n", face->refused);
	if (face->ops->report)
		face->ops->report(face, out);
	if (*face->shut)
		fprintf(out, "trouble %s%s\n", face->shut, face->shut_remedy);
	if (fclose(out) || rename(fresh, face->report))
		unlink(fresh);
}

int face_watch(struct face *face, int fd, short events)
{
	if (face->fd_count == FACE_DESCRIPTORS)
		return -ENOSPC;
	face->fds[face->fd_count] = fd;
	face->came_ns[face->fd_count] = 0;
	face->wanted[face->fd_count++] = events;
	return 0;
}

void face_ignore(struct face *face, int fd)
{
	for (unsigned i = 0; i < face->fd_count; i++)
		if (face->fds[i] == fd) {
			face->fd_count--;
			face->fds[i] = face->fds[face->fd_count];
			face->wanted[i] = face->wanted[face->fd_count];
			face->came_ns[i] = face->came_ns[face->fd_count];
			return;
		}
}

void face_watch_anew(void *face, int fd, short events)
{
	face_ignore(face, fd);
	if (events && face_watch(face, fd, events))
		log_err(((struct face *)face)->log, "too many descriptors");
}

int64_t face_came(const struct face *face, int fd)
{
	for (unsigned i = 0; i < face->fd_count; i++)
		if (face->fds[i] == fd)
			return face->came_ns[i];
	return 0;
}

void face_status(struct face *face, const char *format, ...)
{
	char text[sizeof(face->status)];
	va_list args;
	int len;

	va_start(args, format);
	len = vsnprintf(text, sizeof(text), format, args);
	va_end(args);
	if (*face->shut && len >= 0 && len < (int)sizeof(text))
		snprintf(text + len, sizeof(text) - (size_t)len, "; %s", face->shut);
	if (strcmp(text, face->status) == 0)
		return;
	memcpy(face->status, text, sizeof(text));
	face->report_ns = 0;
	notify_status(&face->notify, "%s", text);
}

static void feed(struct face *face, int64_t now_ns)
{
	if (!face->notify.watchdog_ns || now_ns - face->fed_ns < face->notify.watchdog_ns / 4)
		return;
	face->fed_ns = now_ns;
	notify_send(&face->notify, NOTIFY_WATCHDOG);
}

/* Sleep until something is ready or the next thing is due, then give what is ready to the face. */
static void wait_and_take(struct face *face, struct unix_signals *signals, int64_t now_ns)
{
	struct pollfd fds[3 + FACE_DESCRIPTORS] = {
		{.fd = signals->fd, .events = POLLIN},
		{.fd = log_bell(face->log), .events = POLLIN},
		{.fd = look_descriptor(face, now_ns), .events = POLLIN},
	};
	unsigned count = face->fd_count;
	int64_t until = earlier_ns(face->tick_ns, look_next(face, now_ns)), left, looked_ns;
	struct timespec t;
	int ready;

	if (count)
		until = earlier_ns(until,
		                   now_ns + COMMAND_OLD_NS / 2); /* face_came() needs a look */
	if (*face->report)
		until = earlier_ns(until, face->report_ns);
	if (face->notify.watchdog_ns)
		until = earlier_ns(until, face->fed_ns + face->notify.watchdog_ns / 4);
	left = until > now_ns ? until - now_ns : 0;
	t = timespec_of(left);
	for (unsigned i = 0; i < count; i++)
		fds[3 + i] = (struct pollfd){.fd = face->fds[i], .events = face->wanted[i]};
	ready = ppoll(fds, 3 + count, &t, NULL);
	looked_ns = ows_now();
	/* was it stopped between the look and the clock? It never sleeps so long */
	if (looked_ns - now_ns > COMMAND_OLD_NS)
		looked_ns = now_ns;
	for (unsigned i = 0; ready >= 0 && i < count; i++)
		if (!fds[3 + i].revents)
			face->came_ns[i] = looked_ns;
	if (ready <= 0)
		return;
	if (fds[0].revents)
		unix_signals_take(signals);
	for (unsigned i = 3; i < 3 + count; i++)
		if (fds[i].revents)
			face->ops->event(face, &(struct face_event){.news = FACE_DESCRIPTOR,
			                                            .fd = fds[i].fd,
			                                            .ready = fds[i].revents});
}

static void loop(struct face *face, struct unix_signals *signals, int prefix)
{
	while (!signals->end) {
		int64_t now_ns = ows_now();

		if (signals->reload) {
			signals->reload = false;
			notify_send(&face->notify, NOTIFY_RELOADING);
			load_again(face);
			face->ops->event(face, &(struct face_event){.news = FACE_FILE});
			notify_send(&face->notify, NOTIFY_READY);
		}
		look(face, now_ns);
		if (now_ns >= face->tick_ns)
			face->ops->tick(face, now_ns);
		feed(face, now_ns);
		report_write(face, now_ns);
		log_drain(face->log, STDERR_FILENO, prefix);
		wait_and_take(face, signals, ows_now());
	}
	/* what changed within the face's pace, what waits, and before the end */
	face->look_ns = face->after_ns = 0;
	look(face, ows_now());
	log_notice(face->log, "%s ends: %s", face->ops->program,
	           signals->end == SIGTERM ? "SIGTERM" : "SIGINT");
}

static int loop_run(struct face *face, struct unix_signals *signals)
{
	int prefix = journal_is_stderr(), err;

	if (notify_open(&face->notify))
		log_warning(face->log, "NOTIFY_SOCKET cannot be used");
	err = face->ops->open(face);
	if (!err) {
		log_notice(face->log, "%s %s: instance %s, configuration %s", face->ops->program,
		           OWSD_VERSION, face->arguments->instance, face->arguments->file);
		notify_send(&face->notify, NOTIFY_READY);
		report_open(face);
		resident_drop_start();
		loop(face, signals, prefix);
		notify_send(&face->notify, NOTIFY_STOPPING);
		if (*face->report)
			unlink(face->report);
		face->ops->close(face);
	}
	log_finish(face->log, STDERR_FILENO, prefix);
	ows_close(face->ows);
	notify_close(&face->notify);
	return err ? FACE_EXIT_RUN : EXIT_SUCCESS;
}

int face_main(const struct face_ops *ops, int argc, char **argv)
{
	struct face_arguments arguments;
	struct unix_signals signals;
	struct face face = {.ops = ops,
	                    .arguments = &arguments,
	                    .tick_ns = INT64_MAX,
	                    .notify.fd = -1,
	                    .status = "starting"};
	int status;

	status = face_start(ops->program, &ops->option, argc, argv, &arguments);
	if (status >= 0)
		return status;
	if (load_first(&face))
		return FACE_EXIT_USAGE;
	if (arguments.check || (arguments.option && !ops->option.value)) {
		status = ops->check && ops->check(&face) ? FACE_EXIT_USAGE : EXIT_SUCCESS;
		config_free(face.config);
		return status;
	}
	face.log = log_create(arguments.level);
	status = unix_signals_open(&signals);
	if (!face.log || status) {
		face_complain(ops->program, "cannot start: %s",
		              face.log ? strerror(-status) : "no memory for the log");
		status = FACE_EXIT_RUN;
	} else {
		status = loop_run(&face, &signals);
		close(signals.fd);
	}
	log_destroy(face.log);
	config_free(face.config);
	return status;
}
