/* SPDX-License-Identifier: MIT */
/* An owserver to test against, whose plan misbehaves request by request. */
#include <arpa/inet.h>
#include <errno.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "unity.h"

#include "hal/owfs/frame.h"
#include "tests/unit/aid/peer.h"

static const struct {
	uint32_t type;
	const char *path, *text;
} answers[] = {
	{FRAME_READ, "/28.67C6697351FF/temperature", "     21.0625"},
	{FRAME_READ, "/28.67C6697351FF/type", "DS18B20"},
	{FRAME_READ, "/28.67C6697351FF/locator", ""},
	{FRAME_READ, "/boiler/address", "2867C6697351FF68"},
	{FRAME_READ, "/29.000029D60100/strange", "?"},
	{FRAME_READ, "/30.000029D60100/volt", "    -0.00488"},
	{FRAME_READ, "/30.000029D60100/present", "0"},
	{FRAME_READ, "/bus.0/interface/settings/name", "Simulated-Peer"},
	{FRAME_READ, "/settings/timeout/volatile", "          15"},
	{FRAME_WRITE, "/29.000029D60100/PIO.BYTE", ""},
	{FRAME_PRESENT, "/28.67C6697351FF", "12345678"},
	{FRAME_PRESENT, "/29.000029D60100", "12345678"},
	{FRAME_PRESENT, "/30.000029D60100", "12345678"},
	{FRAME_DIRALL, "/", "/boiler,/29.000029D60100,/bus.0,/settings"},
	{FRAME_DIRALL, "/alarm", "/alarm/boiler"},
	{FRAME_DIRALL, "/28.67C6697351FF", "/boiler/address,/boiler/type"},
	{FRAME_DIRALL, "/odd", "/stranger,/bad\nentry,,/29.000029D60100"},
};

bool peer_has_a_wire;

static void saw(unsigned *count)
{
	__atomic_add_fetch(count, 1, __ATOMIC_SEQ_CST);
}

unsigned peer_saw(const unsigned *count)
{
	return __atomic_load_n(count, __ATOMIC_SEQ_CST);
}

void peer_repeat(struct peer *peer)
{
	saw(&peer->repeat);
}

static int is_stopping(const struct peer *peer)
{
	return __atomic_load_n(&peer->stopping, __ATOMIC_SEQ_CST);
}

/* 1: readable, 0: the time is over, -1: the peer is stopped. */
static int wait_readable(const struct peer *peer, int fd, int ms)
{
	struct pollfd poll_fd = {.fd = fd, .events = POLLIN};

	for (int waited = 0; waited < ms; waited += 5) {
		if (is_stopping(peer))
			return -1;
		if (poll(&poll_fd, 1, 5) > 0)
			return 1;
	}
	return 0;
}

static int read_all(const struct peer *peer, int fd, uint8_t *bytes, size_t n)
{
	for (size_t got = 0; got < n;) {
		ssize_t part;

		if (wait_readable(peer, fd, 20000) <= 0)
			return -1;
		part = recv(fd, bytes + got, n - got, 0);
		if (part <= 0)
			return -1;
		got += (size_t)part;
	}
	return 0;
}

static void until_gone(const struct peer *peer, int fd, int pause_ms, const uint8_t *bytes,
                       size_t n)
{
	uint8_t byte;

	while (wait_readable(peer, fd, pause_ms) == 0)
		if (n && send(fd, bytes, n, MSG_NOSIGNAL) < 0)
			return;
	recv(fd, &byte, 1, 0);
}

static void send_all(int fd, const uint8_t *bytes, size_t n, size_t piece)
{
	for (size_t at = 0; at < n; at += piece) {
		size_t part = n - at < piece ? n - at : piece;

		if (send(fd, bytes + at, part, MSG_NOSIGNAL) < 0)
			return;
		if (piece < n)
			usleep(300); /* a peer that is slow */
	}
}

static size_t make_answer(uint8_t *out, const struct frame_header *request, const char *path)
{
	struct frame_header reply = {.flags = request->flags};
	const char *text = NULL;

	for (unsigned i = 0; i < sizeof(answers) / sizeof(answers[0]); i++)
		if (answers[i].type == (uint32_t)request->type &&
		    strcmp(answers[i].path, path) == 0)
			text = answers[i].text;
	if (peer_has_a_wire && text && strcmp(text, "Simulated-Peer") == 0)
		text = "DS2482-800(0)";
	if (!text && request->type != FRAME_NOP) {
		reply.type = strstr(path, "readonly") ? -95 : strstr(path, "directory") ? -21 : -1;
	} else if (text) {
		reply.payload = (int32_t)strlen(text);
		reply.type = request->type == FRAME_READ ? reply.payload : 0;
		reply.size = reply.payload;
	}
	if (reply.type >= 0 && request->type == FRAME_DIRALL)
		reply.payload++;
	if (request->type == FRAME_WRITE)
		reply.size = request->size > 8 ? 8 : request->size;
	frame_put_header(out, &reply);
	if (text)
		memcpy(out + FRAME_HEADER, text, strlen(text) + 1);
	return FRAME_HEADER + (size_t)reply.payload;
}

static void change(uint8_t *answer, size_t word, uint32_t value)
{
	for (int i = 0; i < 4; i++)
		answer[word * 4 + (size_t)i] = (uint8_t)(value >> (24 - 8 * i));
}

/* False: the connection has ended. */
static int act(const struct peer *peer, int fd, char letter, uint8_t *answer, size_t len)
{
	const struct linger reset = {.l_onoff = 1};
	uint8_t alive[FRAME_HEADER] = {0};

	change(alive, 1, UINT32_MAX);
	switch (letter) {
	case 'k':
		for (int i = 0; i < 3; i++)
			send_all(fd, alive, sizeof(alive), i == 1 ? 5 : sizeof(alive));
		break;
	case 'K':
		until_gone(peer, fd, 100, alive, sizeof(alive));
		return 0;
	case 'D':
		send_all(fd, answer, len, len);
		while (!is_stopping(peer) && !peer_saw(&peer->repeat))
			usleep(300); /* looks again */
		break;
	case 'x':
		return 0;
	case 'R':
		setsockopt(fd, SOL_SOCKET, SO_LINGER, &reset, sizeof(reset));
		return 0;
	case 'm':
		send_all(fd, answer, len / 2, len);
		return 0;
	case 'd':
		send_all(fd, answer, len / 2, len);
		until_gone(peer, fd, 100, NULL, 0);
		return 0;
	case 's':
		until_gone(peer, fd, 100, NULL, 0);
		return 0;
	case 'r':
		answer[15] &= (uint8_t)~FRAME_PERSIST;
		break;
	case 'g':
		memcpy(answer, "HTTP/1.1 400 Bad Request", FRAME_HEADER);
		break;
	case 'h':
		change(answer, 1, 0x7fffffff);
		break;
	case 'n':
		change(answer, 1, (uint32_t)-5);
		break;
	case 'v':
		change(answer, 0, 0x20000);
		break;
	case 'w':
		change(answer, 2, (uint32_t)len);
		break;
	case 'W':
		change(answer, 2, (uint32_t)len - FRAME_HEADER - 2);
		break;
	case 't':
		len += 3;
		break;
	case 'l':
		len = FRAME_HEADER + 60000;
		change(answer, 1, 60000);
		break;
	}
	send_all(fd, answer, len, letter == 'f' ? 1 : 100000);
	return letter != 'r' && letter != 'c';
}

/* Is it a NOP, or a question which buses the server has or how old its answers may be? */
static bool is_greeting(const struct frame_header *request, const char *path)
{
	return request->type == FRAME_NOP || strncmp(path, "/bus.", 5) == 0 ||
	       strncmp(path, "/settings/timeout/", 18) == 0;
}

static void serve(struct peer *peer, int fd)
{
	static uint8_t answer[100000], body[200000];
	uint8_t head[FRAME_HEADER];
	struct frame_header request;
	char letter = 'a';
	size_t len;
	int go_on;

	do {
		if (read_all(peer, fd, head, sizeof(head)))
			return;
		frame_get_header(head, &request);
		if (request.payload < 0 || request.payload >= (int32_t)sizeof(body) ||
		    read_all(peer, fd, body, (size_t)request.payload))
			return;
		body[request.payload] = '\0';
		memset(answer, 0, sizeof(answer));
		len = make_answer(answer, &request, (char *)body);
		if (is_greeting(&request, (char *)body)) {
			saw(&peer->greetings);
			letter = 'a';
			if (request.type == FRAME_READ && *peer->plan == 'z') {
				peer->plan++;
				usleep(1500000); /* a peer that is slow */
			}
		} else {
			letter = *peer->plan ? *peer->plan++ : 'a';
			peer->flags = request.flags;
			peer->size = request.size;
			snprintf(peer->path, sizeof(peer->path), "%.200s", (char *)body);
			if (request.type == FRAME_WRITE)
				saw(&peer->writes);
			saw(&peer->requests);
		}
		go_on = act(peer, fd, letter, answer, len);
		if (!is_greeting(&request, (char *)body))
			saw(&peer->done);
	} while (go_on);
}

static void *run(void *arg)
{
	struct peer *peer = arg;
	const int on = 1;

	while (!is_stopping(peer)) {
		int fd;

		if (wait_readable(peer, peer->listen_fd, 1000) <= 0)
			continue;
		fd = accept(peer->listen_fd, NULL, NULL);
		if (fd < 0)
			continue;
		setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof(on));
		saw(&peer->connections);
		serve(peer, fd);
		close(fd);
		saw(&peer->closed);
	}
	return NULL;
}

static int bind_to_port(const struct peer *peer, int fd)
{
	struct sockaddr_in in = {.sin_family = AF_INET,
	                         .sin_port = htons(peer->port),
	                         .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
	struct sockaddr_in6 in6 = {.sin6_family = AF_INET6,
	                           .sin6_port = htons(peer->port),
	                           .sin6_addr = IN6ADDR_LOOPBACK_INIT};
	const int on = 1;

	setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &on, sizeof(on));
	return peer->family == AF_INET ? bind(fd, (struct sockaddr *)&in, sizeof(in))
	                               : bind(fd, (struct sockaddr *)&in6, sizeof(in6));
}

static void note_port(struct peer *peer)
{
	struct sockaddr_storage here;
	socklen_t len = sizeof(here);

	TEST_ASSERT_EQUAL_INT(0, getsockname(peer->listen_fd, (struct sockaddr *)&here, &len));
	peer->port = peer->family == AF_INET ? ntohs(((struct sockaddr_in *)&here)->sin_port)
	                                     : ntohs(((struct sockaddr_in6 *)&here)->sin6_port);
}

/*
 * Bind a second socket to the port without listening: after peer_stop() a client is refused, and no
 * other program gets the port until peer_restart().
 */
static void hold_port(struct peer *peer)
{
	peer->hold_fd = socket(peer->family, SOCK_STREAM | SOCK_CLOEXEC, 0);
	TEST_ASSERT_GREATER_THAN_INT(0, peer->hold_fd);
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, bind_to_port(peer, peer->hold_fd), strerror(errno));
}

static void begin(struct peer *peer)
{
	struct sockaddr_un local = {.sun_family = AF_UNIX};
	int err;

	peer->listen_fd = socket(peer->family, SOCK_STREAM | SOCK_CLOEXEC, 0);
	TEST_ASSERT_GREATER_OR_EQUAL_INT(0, peer->listen_fd);
	if (peer->family == AF_UNIX) {
		snprintf(local.sun_path, sizeof(local.sun_path), "%s", peer->path_of_socket);
		unlink(local.sun_path);
		err = bind(peer->listen_fd, (struct sockaddr *)&local, sizeof(local));
	} else {
		err = bind_to_port(peer, peer->listen_fd);
	}
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, err, strerror(errno));
	if (peer->family != AF_UNIX && !peer->hold_fd) {
		note_port(peer);
		hold_port(peer);
	}
	TEST_ASSERT_EQUAL_INT(0, listen(peer->listen_fd, 8));
	peer->stopping = 0;
	TEST_ASSERT_EQUAL_INT(0, pthread_create(&peer->thread, NULL, run, peer));
}

void peer_start(struct peer *peer, int family, const char *plan)
{
	*peer = (struct peer){.family = family, .plan = plan};
	snprintf(peer->path_of_socket, sizeof(peer->path_of_socket), "/tmp/owsd-unit-%d.sock",
	         (int)getpid());
	begin(peer);
	if (family == AF_UNIX) {
		snprintf(peer->target, sizeof(peer->target), "owserver:%s", peer->path_of_socket);
		return;
	}
	snprintf(peer->target, sizeof(peer->target),
	         family == AF_INET ? "127.0.0.1:%u" : "[::1]:%u", peer->port);
}

void peer_restart(struct peer *peer, const char *plan)
{
	peer->plan = plan;
	begin(peer);
}

void peer_leave(struct peer *peer)
{
	__atomic_store_n(&peer->stopping, 1, __ATOMIC_SEQ_CST);
	pthread_join(peer->thread, NULL);
}

void peer_stop(struct peer *peer)
{
	if (!is_stopping(peer))
		peer_leave(peer);
	close(peer->listen_fd);
	if (peer->family == AF_UNIX)
		unlink(peer->path_of_socket);
}

void peer_end(struct peer *peer)
{
	if (peer->hold_fd > 0)
		close(peer->hold_fd);
	peer->hold_fd = 0;
}
