/* SPDX-License-Identifier: MIT */
/*
 * What an owserver says, as text to compare: one line for each property, its path, a tab, and the
 * answer as it came, escaped, or "ret=-N". Speaks the protocol by itself, so that it can judge
 * ours.
 *
 *   owdump PORT dir PATH...    the entries of each directory
 *   owdump PORT walk PATH...   every property below each directory, in the order of its listing
 *   owdump PORT read           the paths on standard input
 *   owdump PORT write          "PATH VALUE" lines on standard input; \xNN is a byte of VALUE
 */
#include <arpa/inet.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include "tests/kernel/lines.h"

enum { TYPE_READ = 2, TYPE_WRITE = 3, TYPE_DIRALL = 7 };
enum { FLAGS = 0x10a, ROOM = 65536, TIMEOUT_S = 60, DEEPEST = 4 };
enum { WORD_PAYLOAD = 1, WORD_TYPE = 2, WORD_FLAGS = 3, WORD_SIZE = 4, WORDS = 6 };
#define RET_IS_DIRECTORY (-21)
#define RET_NO_SERVER (-1000)

static uint16_t port;

static bool get(int fd, void *data, size_t len)
{
	return recv(fd, data, len, MSG_WAITALL) == (ssize_t)len;
}

static int answer(int fd, char *data, size_t *len)
{
	uint32_t words[WORDS];
	int32_t payload;

	do {
		if (!get(fd, words, sizeof(words)))
			return RET_NO_SERVER;
		payload = (int32_t)ntohl(words[WORD_PAYLOAD]);
	} while (payload == -1);
	if (payload < 0 || payload >= ROOM || !get(fd, data, (size_t)payload))
		return RET_NO_SERVER;
	data[payload] = '\0';
	*len = (size_t)payload;
	return (int32_t)ntohl(words[WORD_TYPE]);
}

static int ask(unsigned type, const char *path, const uint8_t *value, size_t value_len, char *data,
               size_t *len)
{
	static const struct timeval timeout = {.tv_sec = TIMEOUT_S};
	struct sockaddr_in address = {.sin_family = AF_INET, .sin_port = htons(port)};
	size_t path_len = strlen(path) + 1;
	uint32_t words[WORDS] = {0};
	int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
	int ret = RET_NO_SERVER;

	address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
	words[WORD_PAYLOAD] = htonl((uint32_t)(path_len + value_len));
	words[WORD_TYPE] = htonl(type);
	words[WORD_FLAGS] = htonl(FLAGS);
	words[WORD_SIZE] = htonl(type == TYPE_WRITE ? (uint32_t)value_len : ROOM - 1);
	*len = 0;
	setsockopt(fd, SOL_SOCKET, SO_RCVTIMEO, &timeout, sizeof(timeout));
	if (connect(fd, (struct sockaddr *)&address, sizeof(address)) == 0 &&
	    send(fd, words, sizeof(words), MSG_NOSIGNAL | MSG_MORE) == (ssize_t)sizeof(words) &&
	    send(fd, path, path_len, MSG_NOSIGNAL | (value_len ? MSG_MORE : 0)) ==
	            (ssize_t)path_len &&
	    (!value_len || send(fd, value, value_len, MSG_NOSIGNAL) == (ssize_t)value_len))
		ret = answer(fd, data, len);
	close(fd);
	return ret;
}

static int read_property(const char *path)
{
	char data[ROOM];
	size_t len;
	int ret = ask(TYPE_READ, path, NULL, 0, data, &len);

	if (ret == RET_IS_DIRECTORY)
		return ret;
	lines_answer(path, ret, data, len);
	return ret;
}

static int list(const char *path, char *data)
{
	size_t len;
	int ret = ask(TYPE_DIRALL, path, NULL, 0, data, &len);

	if (ret < 0)
		printf("%s\tret=%d\n", path, ret);
	return ret;
}

static int walk(const char *path, unsigned depth)
{
	char entries[ROOM], *rest, *entry;

	if (list(path, entries) < 0)
		return 1;
	for (entry = strtok_r(entries, ",", &rest); entry; entry = strtok_r(NULL, ",", &rest)) {
		if (read_property(entry) == RET_IS_DIRECTORY && depth < DEEPEST)
			walk(entry, depth + 1);
	}
	return 0;
}

static int dir(const char *path)
{
	char entries[ROOM], *rest, *entry;

	if (list(path, entries) < 0)
		return 1;
	for (entry = strtok_r(entries, ",", &rest); entry; entry = strtok_r(NULL, ",", &rest))
		puts(entry);
	return 0;
}

static void read_path(const char *path)
{
	read_property(path);
}

static void write_property(const char *path, const uint8_t *value, size_t len)
{
	char data[ROOM];
	size_t got;

	lines_written(path, ask(TYPE_WRITE, path, value, len, data, &got));
}

int main(int argc, char **argv)
{
	const char *verb = argc > 2 ? argv[2] : "";
	int failed = 0;

	port = argc > 2 ? (uint16_t)strtoul(argv[1], NULL, 10) : 0;
	if (strcmp(verb, "read") == 0) {
		lines_of_paths(read_path);
	} else if (strcmp(verb, "write") == 0) {
		lines_of_values(write_property);
	} else if (strcmp(verb, "dir") == 0 || strcmp(verb, "walk") == 0) {
		for (int i = 3; i < argc; i++)
			failed |= strcmp(verb, "dir") == 0 ? dir(argv[i]) : walk(argv[i], 0);
	} else {
		fputs("usage: owdump PORT dir|walk|read|write [PATH...]\n", stderr);
		failed = 2;
	}
	return failed;
}
