/* SPDX-License-Identifier: MIT */
/* Asks an owserver whether its buses are simulated. */
#include <stdio.h>
#include <string.h>

#include "hal/owserver/simulated.h"

#define BUSES_MAX 16
#define PREFIX "Simulated"

int simulated_ask(struct talk *talk, int64_t deadline_ns, bool *simulated)
{
	bool all = true;
	unsigned n;

	*simulated = false;
	for (n = 0; n < BUSES_MAX && all; n++) {
		char path[48];
		uint8_t name[128];
		struct talk_request request = {.type = FRAME_READ,
		                               .path = path,
		                               .room = name,
		                               .size = sizeof(name),
		                               .limit = sizeof(name)};
		int err;

		snprintf(path, sizeof(path), "/bus.%u/interface/settings/name", n);
		err = talk_exchange(talk, &request, deadline_ns);
		if (err)
			return err;
		if (talk->reader.header.type < 0)
			break;
		all = talk->reader.header.payload >= (int32_t)strlen(PREFIX) &&
		      memcmp(name, PREFIX, strlen(PREFIX)) == 0;
	}
	*simulated = all && n > 0;
	return 0;
}
