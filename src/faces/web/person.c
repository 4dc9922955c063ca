/* SPDX-License-Identifier: MIT */
/* Rights: by the credentials of the peer, or by what a reverse proxy says. */
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "src/config/read/config.h"
#include "src/faces/web/person.h"
#include "src/ground/signal/hash.h"
#include "src/ground/signal/utf8.h"
#include "src/memory/shm/owner.h"
#include "src/memory/shm/peer.h"

static void print(const struct sockaddr_storage *address, char text[PERSON_ADDRESS])
{
	struct listen_address at;

	text[0] = '\0';
	if (listen_of((const struct sockaddr *)address, &at))
		listen_print_host(&at, text);
}

bool person_is_tcp(int fd, char local[PERSON_ADDRESS])
{
	struct sockaddr_storage address = {0};
	socklen_t len = sizeof(address);

	local[0] = '\0';
	/* what cannot be asked has the stricter rules */
	if (getsockname(fd, (struct sockaddr *)&address, &len))
		return true;
	print(&address, local);
	return address.ss_family != AF_UNIX;
}

/* A name that may stand in a journal. */
static bool is_name(const char *name)
{
	size_t len = name ? strlen(name) : 0;

	if (!len || len >= PERSON)
		return false;
	while (len) {
		int32_t c = utf8_next(&name, &len);

		if (c <= ' ' || utf8_disturbs(c))
			return false;
	}
	return true;
}

static void name_user(uid_t uid, char person[PERSON])
{
	char name[OWNER_NAME];

	owner_name(uid, name);
	snprintf(person, PERSON, "%.*s", (int)strcspn(name, " "), name);
}

/* What each deed needs. */
static const struct {
	const char *off, *group, *for_group;
} deeds[] = {
	[PERSON_WRITE] = {"writing is off: Write on in the block Web switches it on",
                          "owsd-control", "writing is for the group owsd-control"},
	[PERSON_CONFIGURE] = {"editing is off: Configure on in the block Web switches it on",
                              "owsd-config", "editing is for the group owsd-config"},
};

/* At an address. True: the peer is the proxy. */
static bool is_proxy_at(int fd, const struct config_web *options, char address[PERSON_ADDRESS])
{
	struct sockaddr_storage peer = {0};
	struct listen_address at;
	socklen_t len = sizeof(peer);

	address[0] = '\0';
	if (getpeername(fd, (struct sockaddr *)&peer, &len) ||
	    !listen_of((const struct sockaddr *)&peer, &at))
		return false;
	listen_print_host(&at, address);
	return options->proxy_at.bits &&
	       listen_peers_have(&options->proxy_at, 1, at.is_v6, at.bytes);
}

static bool is_proxy_user(const struct peer *peer, const struct config_web *options)
{
	return options->has_proxy && peer->uid == options->proxy_uid;
}

/* Is the peer the proxy? And its address, or its user, in words. */
static bool look(int fd, const struct config_web *options, char words[PERSON_ADDRESS])
{
	struct peer peer = {0};
	bool proxy;

	if (person_is_tcp(fd, words))
		return is_proxy_at(fd, options, words);
	proxy = peer_look(fd, &peer) == 0 && is_proxy_user(&peer, options);
	snprintf(words, PERSON_ADDRESS, "%lu", (unsigned long)peer.uid);
	peer_forget(&peer);
	return proxy;
}

bool person_is_proxy(int fd, const struct config_web *options)
{
	return look(fd, options, (char[PERSON_ADDRESS]){0});
}

uint64_t person_number(int fd, const struct config_web *options, const char *named)
{
	char words[PERSON_ADDRESS] = {0};

	if (!look(fd, options, words) || !is_name(named))
		named = words;
	return hash_text(HASH_BEGIN, named, strlen(named));
}

/* What the proxy says. */
static bool take_named(const char *named, const char *header, char person[PERSON], const char **why)
{
	*why = header;
	if (!is_name(named))
		return false;
	snprintf(person, PERSON, "%s", named);
	return true;
}

bool person_may_do(int fd, const struct config_web *options, enum person_deed deed,
                   const char *named, char person[PERSON], const char **why)
{
	char address[PERSON_ADDRESS];
	struct peer peer = {0};
	gid_t group;
	bool may;

	*why = deeds[deed].off;
	if (!(deed == PERSON_WRITE ? options->write : options->configure))
		return false;
	*why = "it cannot be seen who asks";
	if (person_is_tcp(fd, address)) {
		if (is_proxy_at(fd, options, address))
			return take_named(named,
			                  "the proxy has to name the person in X-Remote-User-Name, "
			                  "in at most 31 bytes",
			                  person, why);
		snprintf(person, PERSON, "%.*s", PERSON - 1, address);
		return *person;
	}
	if (peer_look(fd, &peer))
		return false;
	name_user(peer.uid, person);
	may = peer.uid == 0 || peer.uid == geteuid() ||
	      (owner_group(deeds[deed].group, &group) && peer_in_group(&peer, group));
	*why = deeds[deed].for_group;
	if (is_proxy_user(&peer, options))
		may = take_named(
			named,
			"the proxy has to name the person in X-Remote-User, in at most 31 bytes",
			person, why);
	peer_forget(&peer);
	return may;
}
