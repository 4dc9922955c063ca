/* SPDX-License-Identifier: MIT */
/* Asks another program at its socket, without waiting for it. */
#include "src/faces/mqtt/errand.h"

#include <errno.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "hal/base/time.h"
#include "src/faces/kit/loop.h"
#include "src/memory/libows/open.h"

/* owsd-writer waits for others, for its lock and for the reload */
#define ERRAND_NS (75 * NS_PER_S)
#define ANSWER_MOST (1u << 20) /* bytes */

static int connect_to(const struct face *face, const char *what)
{
	struct sockaddr_un to = {.sun_family = AF_UNIX};
	int n, fd, err;

	if (!face->ows)
		return -ENOENT;
	n = snprintf(to.sun_path, sizeof(to.sun_path), "%s/%s.%s", open_dir(face->ows),
	             face->arguments->instance, what);
	if (n < 0 || (size_t)n >= sizeof(to.sun_path))
		return -ENAMETOOLONG;
	fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
	if (fd < 0)
		return -errno;
	if (!connect(fd, (const struct sockaddr *)&to, sizeof(to)))
		return fd;
	err = -errno;
	close(fd);
	return err;
}

/* Who asked, in memory of our own. False: no memory. */
static bool keep(struct broker_message *kept, const struct broker_message *message)
{
	*kept = (struct broker_message){.topic = strdup(message->topic)};
	if (message->reply)
		kept->reply = strdup(message->reply);
	if (message->correlation_len) {
		void *copy = malloc(message->correlation_len);

		if (copy)
			memcpy(copy, message->correlation, message->correlation_len);
		kept->correlation = copy;
		kept->correlation_len = message->correlation_len;
	}
	return kept->topic && !message->reply == !kept->reply &&
	       !message->correlation_len == !kept->correlation;
}

int errand_begin(struct errand *errand, enum errand_kind kind, struct face *face, const char *what,
                 const void *bytes, size_t len, const char *name,
                 const struct broker_message *message)
{
	int err = 0;

	if (errand->kind)
		return -EBUSY;
	errand->fd = connect_to(face, what);
	if (errand->fd < 0)
		return errand->fd;
	errand->kind = kind;
	snprintf(errand->name, sizeof(errand->name), "%s", name);
	ask_read(&errand->ask, message->text, message->len, false);
	errand->until_ns = ows_now() + ERRAND_NS;
	if (!keep(&errand->message, message))
		err = -ENOMEM;
	/* a socket that is new takes what is so short */
	else if (send(errand->fd, bytes, len, MSG_NOSIGNAL) != (ssize_t)len)
		err = -EIO;
	else
		err = face_watch(face, errand->fd, POLLIN);
	if (err)
		errand_end(errand, face);
	return err;
}

bool errand_ready(struct errand *errand, int fd)
{
	ssize_t n;

	if (!errand->kind || fd != errand->fd)
		return false;
	if (errand->room - errand->len < 4096 && errand->room < ANSWER_MOST) {
		char *more = realloc(errand->got, errand->room + 65536 + 1);

		if (!more)
			return true;
		errand->got = more;
		errand->room += 65536;
	}
	n = recv(fd, errand->got + errand->len, errand->room - errand->len, 0);
	if (n < 0 && (errno == EAGAIN || errno == EINTR))
		return false;
	errand->len += n > 0 ? (size_t)n : 0;
	errand->got[errand->len] = '\0';
	return n <= 0;
}

bool errand_late(const struct errand *errand, int64_t now_ns)
{
	return errand->kind && now_ns >= errand->until_ns;
}

void errand_end(struct errand *errand, struct face *face)
{
	if (!errand->kind)
		return;
	face_ignore(face, errand->fd);
	close(errand->fd);
	free(errand->got);
	free((void *)(uintptr_t)errand->message.topic);
	free((void *)(uintptr_t)errand->message.reply);
	free((void *)(uintptr_t)errand->message.correlation);
	*errand = (struct errand){.kind = ERRAND_NONE};
}
