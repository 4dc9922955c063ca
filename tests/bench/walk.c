/* SPDX-License-Identifier: MIT */
/* A client that looks at all devices of a server of owserver's protocol; see walk.h. */
#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include "hal/sim/slave.h"
#include "tests/bench/aid.h"
#include "tests/bench/walk.h"

/* owserver's protocol: a head of six words, then the path; of the answer the first three count */
enum { TYPE_READ = 2, TYPE_DIRALLSLASH = 9 };
enum { FLAGS = 0x104 }; /* kept connection, from a program of owserver's users */
enum { WORD_PAYLOAD = 1, WORD_TYPE = 2, WORD_FLAGS = 3, WORD_SIZE = 4, WORDS = 6 };
enum { ROOM = 1 << 20, /* of an answer */ READ_MOST = 65535, TIMEOUT_S = 60, DEEPEST = 5 };

void walk_init(struct walk *walk, uint16_t port)
{
	memset(walk, 0, sizeof(*walk));
	walk->port = port;
	walk->fd = -1;
}

static void hang_up(struct walk *walk)
{
	if (walk->fd >= 0)
		close(walk->fd);
	walk->fd = -1;
}

void walk_end(struct walk *walk)
{
	hang_up(walk);
}

static bool send_request(struct walk *walk, uint32_t type, const char *path)
{
	static const struct timeval timeout = {.tv_sec = TIMEOUT_S};
	char frame[WORDS * sizeof(uint32_t) + WALK_PATH];
	uint32_t words[WORDS] = {0};
	size_t len = strlen(path) + 1;

	if (walk->fd < 0) {
		walk->fd = bench_socket(walk->port);
		if (walk->fd < 0)
			return false;
		setsockopt(walk->fd, SOL_SOCKET, SO_RCVTIMEO, &timeout, sizeof(timeout));
		walk->connections++;
	}
	words[WORD_PAYLOAD] = htonl((uint32_t)len);
	words[WORD_TYPE] = htonl(type);
	words[WORD_FLAGS] = htonl(FLAGS);
	words[WORD_SIZE] = htonl(READ_MOST);
	memcpy(frame, words, sizeof(words));
	memcpy(frame + sizeof(words), path, len);
	len += sizeof(words);
	return send(walk->fd, frame, len, MSG_NOSIGNAL) == (ssize_t)len;
}

static bool receive(struct walk *walk, char data[ROOM], int *ret)
{
	uint32_t words[WORDS];
	int32_t payload;

	do {
		if (recv(walk->fd, words, sizeof(words), MSG_WAITALL) != (ssize_t)sizeof(words))
			return false;
		payload = (int32_t)ntohl(words[WORD_PAYLOAD]);
	} while (payload < 0); /* "I am still at it" */
	if (payload >= ROOM ||
	    (payload > 0 && recv(walk->fd, data, (size_t)payload, MSG_WAITALL) != payload))
		return false;
	data[payload] = '\0';
	*ret = (int32_t)ntohl(words[WORD_TYPE]);
	if (*ret >= 0)
		*ret = payload;
	if (!(ntohl(words[WORD_FLAGS]) & 0x4))
		hang_up(walk);
	return true;
}

/* A server may end a kept connection between two requests: once more then. */
static int ask(struct walk *walk, uint32_t type, const char *path, char data[ROOM])
{
	int ret;

	for (int i = 0; i < 2; i++) {
		if (send_request(walk, type, path) && receive(walk, data, &ret))
			return ret;
		hang_up(walk);
	}
	return WALK_NO_SERVER;
}

static bool is_device(const char *entry)
{
	static const char hex[] = "0123456789ABCDEF";

	return strspn(entry, hex) == 2 && entry[2] == '.' && strspn(entry + 3, hex) >= 12;
}

int walk_scan(struct walk *walk, bool fresh, char *names, size_t size)
{
	const char *root = fresh ? "/uncached/" : "/";
	size_t skip = strlen(root);
	static char list[ROOM];
	char *rest, *entry;
	int64_t begun = bench_now();
	int ret = ask(walk, TYPE_DIRALLSLASH, fresh ? "/uncached" : "/", list);
	size_t len = 0;

	walk->scan_ns = bench_now() - begun;
	walk->devices = 0;
	names[0] = '\0';
	if (ret < 0)
		return ret;
	for (entry = strtok_r(list, ",", &rest); entry; entry = strtok_r(NULL, ",", &rest)) {
		if (strncmp(entry, root, skip) != 0 || !is_device(entry + skip))
			continue;
		len += (size_t)snprintf(names + len, size - len, "%s%.15s", len ? "," : "",
		                        entry + skip);
		if (len >= size)
			return WALK_NO_SERVER;
		walk->devices++;
	}
	return (int)walk->devices;
}

/*
 * A memory of more than 512 bytes, whole: all of them are minutes of the wire, and say nothing that
 * those with less do not. Their first page is read.
 */
static bool is_large(const char *path)
{
	static const char codes[][3] = {"0A", "0B", "0C", "0F", "37", "43", "8B", "8F"};
	size_t len = strlen(path);

	for (size_t i = 0; i < sizeof(codes) / sizeof(codes[0]); i++)
		if (strncmp(path + 1, codes[i], 2) == 0)
			return (len > 7 && strcmp(path + len - 7, "/memory") == 0) ||
			       strstr(path, "/page.") != NULL;
	return strstr(path, "/eeprom/page.") != NULL;
}

/* Is this "PIO.3", and the list has "PIO.ALL"? */
static bool is_element(const char *path, const char *list)
{
	const char *dot = strrchr(path, '.'), *slash = strrchr(path, '/');
	char all[WALK_PATH + 8];

	if (!dot || dot < slash || strcmp(dot, ".ALL") == 0 || strcmp(dot, ".BYTE") == 0)
		return false;
	snprintf(all, sizeof(all), "%.*s.ALL", (int)(dot - path), path);
	return strstr(list, all) != NULL;
}

static bool is_first(const char *path)
{
	size_t len = strlen(path);

	return len > 2 && strcmp(path + len - 2, ".0") == 0;
}

static void list_one(struct walk *walk, const char *path, unsigned depth)
{
	char *list = malloc(ROOM), *copy = malloc(ROOM), *rest, *entry;
	int64_t begun = bench_now();
	int ret = list && copy ? ask(walk, TYPE_DIRALLSLASH, path, list) : WALK_NO_SERVER;

	/* without what is made of it here */
	walk->list_ns += bench_now() - begun;

	walk->directories++;
	if (ret < 0) {
		if (!walk->unlisted++)
			snprintf(walk->why, sizeof(walk->why), "%s: %d", path, ret);
		free(list);
		free(copy);
		return;
	}
	memcpy(copy, list, (size_t)ret + 1);
	for (entry = strtok_r(list, ",", &rest); entry; entry = strtok_r(NULL, ",", &rest)) {
		size_t len = strlen(entry);
		bool directory = len > 1 && entry[len - 1] == '/';

		if (directory)
			entry[--len] = '\0';
		if (strncmp(entry, path, strlen(path)) != 0)
			continue;
		if (directory) {
			/* what is behind a coupler is none of its properties */
			if (depth < DEEPEST && !is_device(strrchr(entry, '/') + 1))
				list_one(walk, entry, depth + 1);
		} else if (len < WALK_PATH && walk->properties < WALK_MOST &&
		           (is_large(entry) ? is_first(entry) : !is_element(entry, copy))) {
			memcpy(walk->property[walk->properties++].path, entry, len + 1);
		}
	}
	free(list);
	free(copy);
}

void walk_list(struct walk *walk, const char *names)
{
	walk->properties = walk->directories = walk->unlisted = 0;
	walk->list_ns = 0;
	while (*names) {
		char path[WALK_PATH];
		size_t len = strcspn(names, ",");

		snprintf(path, sizeof(path), "/%.*s", (int)len, names);
		list_one(walk, path, 0);
		names += len + (names[len] == ',');
	}
}

int walk_read_one(struct walk *walk, const char *path)
{
	static char data[ROOM];

	return ask(walk, TYPE_READ, path, data);
}

void walk_read(struct walk *walk)
{
	walk->read_ns = 0;
	for (unsigned i = 0; i < walk->properties; i++) {
		struct walk_property *p = &walk->property[i];
		int64_t begun = bench_now();

		p->ret = walk_read_one(walk, p->path);
		p->ns = bench_now() - begun;
		walk->read_ns += p->ns;
		if (p->ret == WALK_NO_SERVER)
			walk->properties = i + 1;
	}
}

/* From here on a code has boards of one maker, which differ in what they measure. */
#define FIRST_SHARED 0x7e

static const struct sim_family *stands_for_it(const struct sim_family *family)
{
	const struct sim_family *const *f = sim_families;

	while ((*f)->code != family->code)
		f++;
	return *f;
}

unsigned walk_scenario(FILE *file, unsigned khz)
{
	unsigned count = 0;

	fprintf(file, "i2c speed %u\nchip DS2482-100 0x18\n", khz);
	for (const struct sim_family *const *f = sim_families; *f; f++) {
		const char *more = "";

		if ((*f)->code < FIRST_SHARED && stands_for_it(*f) != *f)
			continue;
		if (strcmp((*f)->name, "DS28E17") == 0 || strcmp((*f)->name, "DS28E18") == 0)
			more = "  sht4x 0x44";
		count++;
		/* Ids differ in all bits, as those of a real delivery do. */
		fprintf(file, "%s %02X.%08X%04X%s\n", (*f)->name, (*f)->code, count * 2654435761u,
		        count, more);
	}
	return count;
}
