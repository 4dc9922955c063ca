/* SPDX-License-Identifier: MIT */
/* Asks an owserver how old its answers may be, and whether its buses are simulated. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/time.h"
#include "hal/owserver/server.h"

#define DAY_S 86400
#define BUSES_MAX 16
#define TEXT_MAX 127
#define PREFIX "Simulated"

/* *known: the server has the property; then text is what it says. */
static int server_ask(struct talk *talk, const char *path, int64_t deadline_ns,
                      char text[TEXT_MAX + 1], bool *known)
{
	const struct talk_request request = {.type = FRAME_READ,
	                                     .path = path,
	                                     .room = (uint8_t *)text,
	                                     .size = TEXT_MAX,
	                                     .limit = TEXT_MAX};
	int err;

	memset(text, 0, TEXT_MAX + 1);
	err = talk_exchange(talk, &request, deadline_ns);
	*known = !err && talk->reader.header.type >= 0;
	return err;
}

int server_ask_cache(struct talk *talk, int64_t deadline_ns, int64_t *cache_ns)
{
	char text[TEXT_MAX + 1], *end;
	long seconds;
	bool known;
	int err = server_ask(talk, "/settings/timeout/volatile", deadline_ns, text, &known);

	*cache_ns = 0;
	if (!known)
		return err;
	seconds = strtol(text, &end, 10);
	if (end != text && strspn(end, " \n") == strlen(end) && seconds > 0 && seconds <= DAY_S)
		*cache_ns = seconds * NS_PER_S;
	return 0;
}

int server_ask_simulated(struct talk *talk, int64_t deadline_ns, bool *simulated)
{
	bool all = true, known = true;
	unsigned n;

	*simulated = false;
	for (n = 0; n < BUSES_MAX && all; n++) {
		char path[48], text[TEXT_MAX + 1];
		int err;

		snprintf(path, sizeof(path), "/bus.%u/interface/settings/name", n);
		err = server_ask(talk, path, deadline_ns, text, &known);
		if (err)
			return err;
		if (!known)
			break;
		all = strncmp(text, PREFIX, strlen(PREFIX)) == 0;
	}
	*simulated = all && n > 0;
	return 0;
}
