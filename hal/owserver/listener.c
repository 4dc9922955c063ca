/* SPDX-License-Identifier: MIT */
/* Finds whose program is at the other end of a connection within this machine. */
#include <errno.h>
#include <inttypes.h>
#include <netinet/in.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "hal/owserver/listener.h"

#define LINES 16384         /* of a file at most; the listeners stand first */
#define FIRST_PERSON 1000   /* UID_MIN of Debian; below: system users */
#define FIRST_DYNAMIC 61184 /* DynamicUser of systemd */
#define LAST_DYNAMIC 65519
#define NOBODY 65534 /* in a user namespace: whoever has no number there */
#define END_TEXT 38

/* One of the fourth version is mapped. */
struct end {
	uint32_t words[4];
	unsigned port;
};

enum { EXACT, ANY, NONE };

struct found {
	unsigned form; /* in which the address of the listener stands there */
	uid_t listener, owner;
	bool taken;   /* a program has the connection, and is of owner */
	bool unclear; /* nobody has it, or there is more to see */
};

static void end_of(const struct sockaddr *at, struct end *end)
{
	struct sockaddr_in v4;
	struct sockaddr_in6 v6;

	*end = (struct end){.words = {0, 0, htonl(0xffff), 0}};
	if (at->sa_family == AF_INET) {
		memcpy(&v4, at, sizeof(v4));
		end->words[3] = v4.sin_addr.s_addr;
		end->port = ntohs(v4.sin_port);
	} else {
		memcpy(&v6, at, sizeof(v6));
		memcpy(end->words, &v6.sin6_addr, sizeof(end->words));
		end->port = ntohs(v6.sin6_port);
	}
}

static bool is_v4(const struct end *end)
{
	return !end->words[0] && !end->words[1] && end->words[2] == htonl(0xffff);
}

/* Of an address of this machine the kernel takes the same one for both ends, or 127.0.0.1. */
static bool is_here(const struct end *end, const struct end *client)
{
	return memcmp(end->words, client->words, sizeof(end->words)) == 0 ||
	       (is_v4(end) && ntohl(end->words[3]) >> 24 == IN_LOOPBACKNET);
}

/* As tcp has it, or tcp6. */
static void print_end(const struct end *end, bool v6, bool any, char text[END_TEXT])
{
	static const uint32_t none[4];
	const uint32_t *words = any ? none : end->words;

	if (v6)
		snprintf(text, END_TEXT,
		         "%08" PRIX32 "%08" PRIX32 "%08" PRIX32 "%08" PRIX32 ":%04X", words[0],
		         words[1], words[2], words[3], end->port);
	else
		snprintf(text, END_TEXT, "%08" PRIX32 ":%04X", words[3], end->port);
}

/* One file, line by line: listeners come first, and with one of them the others are not needed. */
static void look_in(const char *folder, bool v6, const struct end *at, const struct end *from,
                    struct found *found)
{
	char path[256], line[512], forms[2][END_TEXT], client[END_TEXT];
	FILE *file;
	int n = 0;

	print_end(at, v6, false, forms[EXACT]);
	print_end(at, v6, true, forms[ANY]);
	print_end(from, v6, false, client);
	snprintf(path, sizeof(path), "%s/tcp%s", folder, v6 ? "6" : "");
	file = fopen(path, "re");
	for (; file && n < LINES && fgets(line, sizeof(line), file); n++) {
		char here[END_TEXT], there[END_TEXT], state[3], uid[11], inode[21];

		if (sscanf(line, " %*[0-9]: %37s %37s %2s %*s %*s %*s %10[0-9] %*s %20[0-9]", here,
		           there, state, uid, inode) != 5)
			continue;
		if (strcmp(state, "0A") == 0) {
			for (unsigned form = 0; form < found->form; form++)
				if (strcmp(here, forms[form]) == 0) {
					found->form = form;
					found->listener = (uid_t)strtoul(uid, NULL, 10);
				}
		} else if (found->form < NONE) {
			break;
		} else if (strcmp(here, forms[EXACT]) == 0 && strcmp(there, client) == 0) {
			found->taken = strcmp(inode, "0") != 0;
			found->unclear = !found->taken;
			found->owner = (uid_t)strtoul(uid, NULL, 10);
		}
	}
	found->unclear |= n == LINES;
	if (file)
		fclose(file);
}

int listener_user(const char *folder, const struct sockaddr *at, const struct sockaddr *from,
                  uid_t *user)
{
	struct found found = {.form = NONE};
	struct end end, client;

	end_of(at, &end);
	end_of(from, &client);
	if (!is_here(&end, &client))
		return -ENOENT;
	if (memcmp(&end, &client, sizeof(end)) == 0)
		return -ECONNREFUSED;
	if (is_v4(&end))
		look_in(folder, false, &end, &client, &found);
	look_in(folder, true, &end, &client, &found);
	*user = found.form < NONE ? found.listener : found.owner;
	if (found.form < NONE || found.taken)
		return 0;
	return found.unclear ? -ECONNREFUSED : -ENOENT;
}

bool listener_is_trusted(uid_t user)
{
	return user < FIRST_PERSON || user == geteuid() ||
	       (user >= FIRST_DYNAMIC && user <= LAST_DYNAMIC) || user == NOBODY;
}
