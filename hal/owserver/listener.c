/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <netinet/in.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "hal/owserver/listener.h"

#define LISTENS "0A"
#define LINES 4096          /* the listeners stand first */
#define FIRST_PERSON 1000   /* UID_MIN of Debian; below: system users */
#define FIRST_DYNAMIC 61184 /* DynamicUser of systemd */
#define LAST_DYNAMIC 65519
#define NOBODY 65534 /* in a user namespace: whoever has no number there */

/* The forms of an address in these files, best first: itself, all addresses. */
struct wanted {
	const char *file;
	char address[33];
};

static void print_v6(char *out, const uint32_t *words)
{
	snprintf(out, 33, "%08" PRIX32 "%08" PRIX32 "%08" PRIX32 "%08" PRIX32, words[0], words[1],
	         words[2], words[3]);
}

/* What may listen there, the most exact first, as the kernel picks it. Returns their number. */
static int forms_of(const struct sockaddr *at, struct wanted *forms, unsigned *port)
{
	const uint32_t any[4] = {0};
	int n = 0;

	if (at->sa_family == AF_INET) {
		struct sockaddr_in v4;
		uint32_t mapped[4] = {0, 0, htonl(0xffff)};

		memcpy(&v4, at, sizeof(v4));
		*port = ntohs(v4.sin_port);
		mapped[3] = v4.sin_addr.s_addr;
		forms[n].file = forms[n + 1].file = "tcp";
		snprintf(forms[n++].address, 33, "%08" PRIX32, mapped[3]);
		snprintf(forms[n++].address, 33, "%08X", 0U);
		forms[n].file = "tcp6";
		print_v6(forms[n++].address, mapped);
	} else {
		struct sockaddr_in6 v6;
		uint32_t words[4];

		memcpy(&v6, at, sizeof(v6));
		memcpy(words, &v6.sin6_addr, sizeof(words));
		*port = ntohs(v6.sin6_port);
		forms[n].file = "tcp6";
		print_v6(forms[n++].address, words);
	}
	forms[n].file = "tcp6";
	print_v6(forms[n++].address, any);
	return n;
}

/* One file, line by line, until its listeners end. Returns 0, or -ENOENT. */
static int look_in(const char *folder, const struct wanted *form, unsigned port, uid_t *user)
{
	char path[256], line[512];
	int found = -ENOENT;
	FILE *file;

	snprintf(path, sizeof(path), "%s/%s", folder, form->file);
	file = fopen(path, "re");
	if (!file)
		return -ENOENT;
	for (int n = 0; found && n < LINES && fgets(line, sizeof(line), file); n++) {
		char address[33], its_port[5], state[3], uid[11];

		if (sscanf(line,
		           " %*[0-9]: %32[0-9A-F]:%4[0-9A-F] %*s %2[0-9A-F] %*s %*s %*s %10[0-9]",
		           address, its_port, state, uid) != 4)
			continue;
		if (strcmp(state, LISTENS) != 0)
			break;
		if (strtoul(its_port, NULL, 16) == port && strcmp(address, form->address) == 0) {
			*user = (uid_t)strtoul(uid, NULL, 10);
			found = 0;
		}
	}
	fclose(file);
	return found;
}

int listener_user(const char *folder, const struct sockaddr *at, uid_t *user)
{
	struct wanted forms[4];
	unsigned port = 0;
	int n = forms_of(at, forms, &port), err = -ENOENT;

	for (int i = 0; i < n && err; i++)
		err = look_in(folder, &forms[i], port, user);
	return err;
}

bool listener_is_trusted(uid_t user)
{
	return user < FIRST_PERSON || user == geteuid() ||
	       (user >= FIRST_DYNAMIC && user <= LAST_DYNAMIC) || user == NOBODY;
}
