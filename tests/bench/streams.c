/* SPDX-License-Identifier: MIT */
/* Clients of the events of owsd-web. */
#include "tests/bench/streams.h"

#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "tests/bench/many.h"

#define TEXT 65536
#define ROW 64 /* at most, of the probe */
#define LATENCIES 100000

struct client {
	int fd;
	size_t kept; /* the end of what came: the start of a row, perhaps */
	char text[TEXT + ROW + 1];
};

static struct {
	struct client *clients;
	unsigned count;
	int epoll;
	pthread_t thread;
	bool stop;
	pthread_mutex_t lock;
	uint64_t bytes;
	double ms[LATENCIES];
	size_t latencies;
} streams = {.lock = PTHREAD_MUTEX_INITIALIZER};

/* Rows of the probe, [0,TIME,...: no other row of the events begins so. */
static void find_probes(const char *text, double now)
{
	for (const char *at = text; (at = strstr(at, "[0,"));) {
		char *end;
		double then = strtod(at + 3, &end);

		if (end > at + 3 && *end == ',' && streams.latencies < LATENCIES)
			streams.ms[streams.latencies++] = now - then;
		at = end > at ? end : at + 3;
	}
}

static bool take(struct client *client)
{
	ssize_t n = recv(client->fd, client->text + client->kept, TEXT, MSG_DONTWAIT);
	char *begin, *comma;
	size_t len;

	if (n <= 0)
		return false;
	len = client->kept + (size_t)n;
	client->text[len] = '\0';
	pthread_mutex_lock(&streams.lock);
	streams.bytes += (uint64_t)n;
	find_probes(client->text, many_now());
	pthread_mutex_unlock(&streams.lock);
	/* a row that has not come with its whole value was not found */
	begin = memrchr(client->text, '[', len);
	comma = begin ? strchr(begin, ',') : NULL;
	client->kept = 0;
	if (begin && (!comma || !strchr(comma + 1, ',')) && client->text + len - begin < ROW)
		client->kept = (size_t)(client->text + len - begin);
	memmove(client->text, client->text + len - client->kept, client->kept);
	return true;
}

static void *follow(void *ctx)
{
	struct epoll_event events[16];

	(void)ctx;
	while (!__atomic_load_n(&streams.stop, __ATOMIC_RELAXED)) {
		int n = epoll_wait(streams.epoll, events, 16, 100);

		for (int i = 0; i < n; i++)
			if (!take(&streams.clients[events[i].data.u32]))
				epoll_ctl(streams.epoll, EPOLL_CTL_DEL,
				          streams.clients[events[i].data.u32].fd, NULL);
	}
	return NULL;
}

static int connect_one(const char *path)
{
	static const char request[] = "GET /api/events HTTP/1.1\r\nHost: localhost\r\n\r\n";
	struct sockaddr_un address = {.sun_family = AF_UNIX};
	int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);

	snprintf(address.sun_path, sizeof(address.sun_path), "%.100s", path);
	if (connect(fd, (struct sockaddr *)&address, sizeof(address)) == 0 &&
	    send(fd, request, sizeof(request) - 1, MSG_NOSIGNAL) == sizeof(request) - 1)
		return fd;
	close(fd);
	return -1;
}

unsigned streams_open(const char *path, unsigned count)
{
	streams.clients = calloc(count, sizeof(*streams.clients));
	streams.epoll = epoll_create1(EPOLL_CLOEXEC);
	streams.count = 0;
	streams.stop = false;
	for (unsigned i = 0; streams.clients && i < count; i++) {
		struct epoll_event wanted = {.events = EPOLLIN, .data.u32 = i};
		int fd = connect_one(path);

		if (fd < 0)
			break;
		streams.clients[i].fd = fd;
		epoll_ctl(streams.epoll, EPOLL_CTL_ADD, fd, &wanted);
		streams.count++;
	}
	streams_begin();
	pthread_create(&streams.thread, NULL, follow, NULL);
	return streams.count;
}

void streams_begin(void)
{
	pthread_mutex_lock(&streams.lock);
	streams.bytes = 0;
	streams.latencies = 0;
	pthread_mutex_unlock(&streams.lock);
}

uint64_t streams_bytes(void)
{
	uint64_t bytes;

	pthread_mutex_lock(&streams.lock);
	bytes = streams.bytes;
	pthread_mutex_unlock(&streams.lock);
	return bytes;
}

size_t streams_latencies(double *ms, size_t most)
{
	size_t n;

	pthread_mutex_lock(&streams.lock);
	n = streams.latencies < most ? streams.latencies : most;
	memcpy(ms, streams.ms, n * sizeof(*ms));
	pthread_mutex_unlock(&streams.lock);
	return n;
}

void streams_close(void)
{
	__atomic_store_n(&streams.stop, true, __ATOMIC_RELAXED);
	pthread_join(streams.thread, NULL);
	for (unsigned i = 0; i < streams.count; i++)
		close(streams.clients[i].fd);
	close(streams.epoll);
	free(streams.clients);
	streams.clients = NULL;
}
