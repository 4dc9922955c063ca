/* SPDX-License-Identifier: MIT */
/* The profile "homeassistant": plain, and what has Home Assistant make devices of it. */
#include "src/mqtt/plain.h"

const struct profile profile_homeassistant = {
	.name = "homeassistant",
	.birth = plain_birth,
	.value = plain_value,
	.state = plain_state,
	.alarm = plain_alarm,
	.listen = plain_listen,
	.heard = plain_heard,
};
