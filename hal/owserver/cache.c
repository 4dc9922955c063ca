/* SPDX-License-Identifier: MIT */
/* The age of what an owserver answers from its cache: its setting timeout/volatile, in seconds. */
#include <stdlib.h>
#include <string.h>

#include "hal/bus/time.h"
#include "hal/owserver/cache.h"

#define DAY_S 86400

int cache_ask(struct talk *talk, int64_t deadline_ns, int64_t *cache_ns)
{
	uint8_t text[32] = "";
	const struct talk_request request = {.type = FRAME_READ,
	                                     .path = "/settings/timeout/volatile",
	                                     .room = text,
	                                     .size = sizeof(text) - 1,
	                                     .limit = sizeof(text) - 1};
	int err = talk_exchange(talk, &request, deadline_ns);
	long seconds;
	char *end;

	*cache_ns = 0;
	if (err || talk->reader.header.type < 0)
		return err;
	seconds = strtol((const char *)text, &end, 10);
	if (end != (const char *)text && strspn(end, " \n") == strlen(end) && seconds > 0 &&
	    seconds <= DAY_S)
		*cache_ns = seconds * NS_PER_S;
	return 0;
}
