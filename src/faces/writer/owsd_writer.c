/* SPDX-License-Identifier: MIT */
/* owsd-writer: the one program that may write the configuration of an owsd for others. */
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "hal/base/time.h"
#include "src/config/read/config.h"
#include "src/config/read/load.h"
#include "src/config/read/rio.h"
#include "src/daemon/host/target.h"
#include "src/faces/kit/arguments.h"
#include "src/faces/writer/store.h"
#include "src/faces/writer/visit.h"
#include "src/faces/writer/visitors.h"
#include "src/ground/service/listen.h"
#include "src/ground/service/notify.h"
#include "src/ground/service/streams.h"
#include "src/ground/service/unix_signals.h"
#include "src/ground/text/log.h"
#include "src/memory/shm/owner.h"
#include "src/memory/shm/peer.h"
#include "src/public/ows.h"

#define PROGRAM "owsd-writer"
#define GROUP "owsd-config"
#define SERVICE "owsd" /* its user */
#define LOOK_MS 100    /* how often it looks which visits have ended */
#define IDLE_MS 30000  /* then the service manager waits in its place */

/* The socket of the service manager, path then is ""; else that of -l, or in this user's place. */
static int writer_socket(const struct face_arguments *a, char path[FACE_PATH])
{
	int fd, count = listen_inherited(&fd, 1);

	*path = '\0';
	if (count < 0) {
		face_complain(PROGRAM, "expected one socket of the service manager: %s",
		              strerror(-count));
		return count;
	}
	if (count)
		return fd;
	if (a->option)
		snprintf(path, FACE_PATH, "%s", a->option);
	else if (face_socket(a, "config", path))
		return -ENOENT;
	fd = listen_at_path(path, 0600, (gid_t)-1); /* for this user alone */
	if (fd < 0)
		face_complain(PROGRAM, "%s: %s%s", path, strerror(-fd),
		              fd == -EADDRINUSE ? "; another " PROGRAM " listens there" : "");
	return fd;
}

/* Of a user's own writer the group does not count. */
static void find_group(struct writer *writer)
{
	uid_t uid;

	writer->has_group = (geteuid() == 0 || (owner_user(PROGRAM, &uid) && uid == geteuid())) &&
	                    owner_group(GROUP, &writer->group);
	if (!owner_user(SERVICE, &writer->owsd))
		writer->owsd = (uid_t)-1;
}

/*
 * In a process of its own, which keeps no other connection waiting, and which ends with all that
 * the peer has sent along: the kernel lets no connection linger in a process that ends.
 */
static _Noreturn void attend(const struct writer *writer, int fd, int begin, bool may, int prefix)
{
	sigset_t ends;
	char byte;

	sigemptyset(&ends);
	sigaddset(&ends, SIGTERM);
	sigaddset(&ends, SIGINT);
	sigprocmask(SIG_UNBLOCK, &ends, NULL);
	/* owsd-writer closes its copy first: none of those of this process is closed before */
	while (read(begin, &byte, 1) < 0 && errno == EINTR)
		;
	visit(writer, fd, may);
	log_drain(writer->log, STDERR_FILENO, prefix);
	exit(EXIT_SUCCESS);
}

static void take_one(const struct writer *writer, struct visitors *visitors, int listener,
                     int prefix)
{
	const struct timespec pause = {.tv_nsec = LISTEN_PAUSE_NS};
	struct sockaddr_storage from = {0};
	socklen_t len = sizeof(from);
	struct peer peer = {0};
	int fd = listen_accept(listener, (struct sockaddr *)&from, &len), begin[] = {-1, -1};
	bool may;
	pid_t pid;

	if (listen_is_full(fd))
		nanosleep(&pause, NULL);
	if (fd < 0)
		return;
	peer_look_into(fd, &peer, NULL, 0);
	visitors_look(visitors, ows_now()); /* one that has ended meanwhile has left its place */
	may = visitors_may(visitors, peer.uid);
	pid = pipe2(begin, O_CLOEXEC) ? -1 : fork();
	if (pid == 0) {
		close(begin[1]);
		attend(writer, fd, begin[0], may, prefix);
	}
	if (pid < 0)
		log_warning(writer->log, "no process for a request: %s", strerror(errno));
	else
		visitors_add(visitors, pid, peer.uid, ows_now());
	close(fd);
	close(begin[0]);
	close(begin[1]);
}

/* Until a signal ends it, or no client comes for a while and the service manager listens. */
static void serve(struct writer *writer, struct visitors *visitors, int listener, bool may_leave,
                  struct unix_signals *signals, int prefix)
{
	while (!signals->end) {
		struct pollfd fds[] = {{.fd = signals->fd, .events = POLLIN},
		                       {.fd = listener, .events = POLLIN}};
		unsigned there = visitors_look(visitors, ows_now());
		int n;

		if (there == VISITORS)
			fds[1].fd = -1;
		n = poll(fds, 2, there ? LOOK_MS : may_leave ? IDLE_MS : -1);
		unix_signals_take(signals);
		if (n == 0 && !there)
			return;
		if (fds[1].revents && !signals->end) {
			find_group(writer); /* it may have been made meanwhile */
			take_one(writer, visitors, listener, prefix);
		}
		log_drain(writer->log, STDERR_FILENO, prefix);
	}
}

static int owsd_writer_run(const struct face_arguments *a, struct unix_signals *signals)
{
	struct visitors visitors = {0};
	struct writer writer = {.file = a->file, .instance = a->instance};
	int prefix = journal_is_stderr(), listener;
	char path[FACE_PATH];
	struct listen_file own;
	struct notify notify;

	writer.log = log_create(a->level);
	if (!writer.log) {
		face_complain(PROGRAM, "no memory or no descriptor for the log");
		return FACE_EXIT_RUN;
	}
	listener = writer_socket(a, path);
	if (listener < 0) {
		log_destroy(writer.log);
		return FACE_EXIT_RUN;
	}
	own = listen_file_at(AT_FDCWD, path);
	if (notify_open(&notify))
		log_warning(writer.log, "NOTIFY_SOCKET cannot be used");
	if (*path)
		log_notice(writer.log, PROGRAM " %s: %s is written for who asks at %s",
		           OWSD_VERSION, a->file, path);
	log_drain(writer.log, STDERR_FILENO, prefix);
	notify_send(&notify, NOTIFY_READY);
	serve(&writer, &visitors, listener, !*path, signals, prefix);
	notify_send(&notify, NOTIFY_STOPPING);
	visitors_end(&visitors);
	listen_remove(AT_FDCWD, path, &own);
	/* the listener ends with the process: what was sent to it may be slow to close */
	notify_close(&notify);
	log_finish(writer.log, STDERR_FILENO, prefix);
	log_destroy(writer.log);
	return 0;
}

static void report_line(void *ctx, bool is_error, const char *message)
{
	(void)ctx, (void)is_error;
	fprintf(stderr, "%s\n", message);
}

/* As owsd --check does, and without printing the configuration. */
static int check_file(const char *file)
{
	struct config_report report = {.line = report_line};
	struct config *config;
	int err;

	if (config_load(file, &report, &config))
		return FACE_EXIT_USAGE;
	err = target_check_config(config, &report);
	config_free(config);
	return err ? FACE_EXIT_USAGE : EXIT_SUCCESS;
}

/*
 * For owsd-web, which runs this as itself: a configuration at standard input, and its warnings of
 * items at standard output, as an answer. Nothing that it names is read.
 */
static int check_draft(void)
{
	struct answer answer = {.status = ANSWER_ERROR};
	char *text = malloc(RIO_FILE_MAX + 1), *printed = NULL;
	size_t len = text ? fread(text, 1, RIO_FILE_MAX + 1, stdin) : 0, printed_len = 0;

	if (text && len <= RIO_FILE_MAX) {
		answer.status = ANSWER_DONE;
		store_check_items(text, len, &answer);
		printed = answer_print(&answer, &printed_len);
	}
	if (printed)
		fwrite(printed, 1, printed_len, stdout);
	free(printed);
	free(text);
	answer_free(&answer);
	return printed_len && fflush(stdout) == 0 ? EXIT_SUCCESS : FACE_EXIT_RUN;
}

int main(int argc, char **argv)
{
	static const struct face_option listens = {
		'l', "listen", "PATH",
		"the socket, for this user alone (NAME.config in the directory of owsd)"};
	struct face_arguments a;
	struct unix_signals signals;
	int status;

	if (argc == 2 && strcmp(argv[1], "--draft") == 0)
		return check_draft();
	status = face_start(PROGRAM, &listens, argc, argv, &a);
	if (status >= 0)
		return status;
	if (a.check)
		return check_file(a.file);
	status = unix_signals_open(&signals);
	if (status) {
		face_complain(PROGRAM, "cannot take signals: %s", strerror(-status));
		return FACE_EXIT_RUN;
	}
	return owsd_writer_run(&a, &signals);
}
