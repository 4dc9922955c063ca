/* SPDX-License-Identifier: MIT */
/* The socket over which the scripts of the guest command the simulator. */
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/un.h>
#include <unistd.h>

#include "tests/kernel/control.h"

#define SOCKET_PATH "/run/simchip"
#define LINE_MAX_BYTES 1024
/* A caller who has no processor for so long as who serves waits for him finds the line closed. */
#define ATTEMPTS 50

/* The first byte of an answer. */
enum { DONE = '+', REFUSED = '-' };

static int open_socket(struct sockaddr_un *address)
{
	int fd = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);

	*address = (struct sockaddr_un){.sun_family = AF_UNIX, .sun_path = SOCKET_PATH};
	return fd < 0 ? -errno : fd;
}

int control_listen(void)
{
	struct sockaddr_un address;
	int fd = open_socket(&address);

	if (fd < 0)
		return fd;
	unlink(SOCKET_PATH);
	if (bind(fd, (struct sockaddr *)&address, sizeof(address)) || listen(fd, 4)) {
		int err = -errno;

		close(fd);
		return err;
	}
	return fd;
}

void control_serve(int fd, control_command *command, void *ctx)
{
	static const struct timeval patience = {.tv_usec = 100000};
	char line[LINE_MAX_BYTES], answer[LINE_MAX_BYTES];
	int caller = accept4(fd, NULL, NULL, SOCK_CLOEXEC);
	ssize_t got;

	if (caller < 0)
		return;
	setsockopt(caller, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
	got = recv(caller, line, sizeof(line) - 1, 0);
	if (got > 0) {
		line[got] = '\0';
		answer[0] = command(ctx, line, answer + 1, sizeof(answer) - 1) ? REFUSED : DONE;
		send(caller, answer, 1 + strlen(answer + 1), MSG_NOSIGNAL);
	}
	close(caller);
}

/* The bytes of the answer; 0: who serves had no patience and has done nothing; -1 for good. */
static ssize_t ask(const char *line, size_t length, char *answer, size_t room)
{
	struct sockaddr_un address;
	int fd = open_socket(&address);
	ssize_t got = -1;

	if (fd >= 0 && connect(fd, (struct sockaddr *)&address, sizeof(address)) == 0) {
		if (send(fd, line, length, MSG_NOSIGNAL) == (ssize_t)length)
			got = recv(fd, answer, room, 0);
		if (got < 0 && (errno == EPIPE || errno == ECONNRESET))
			got = 0;
	}
	if (got < 0)
		perror("simchip");
	if (fd >= 0)
		close(fd);
	return got;
}

int control_tell(int words, char **word)
{
	char line[LINE_MAX_BYTES] = "", answer[LINE_MAX_BYTES];
	size_t used = 0;
	ssize_t got = 0;

	for (int i = 0; i < words && used < sizeof(line); i++)
		used += (size_t)snprintf(line + used, sizeof(line) - used, i ? " %s" : "%s",
		                         word[i]);
	if (used >= sizeof(line))
		return 1;
	for (int i = 0; i < ATTEMPTS && got == 0; i++)
		got = ask(line, used, answer, sizeof(answer) - 1);
	if (got < 1)
		return 1;
	answer[got] = '\0';
	fputs(answer + 1, answer[0] == DONE ? stdout : stderr);
	return answer[0] != DONE;
}
