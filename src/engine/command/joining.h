/* SPDX-License-Identifier: MIT */
/* A controller as it joins the engine. */
#pragma once

#include "src/shm/controller.h"

/* What the control room knows of a controller; copied. */
struct engine_controller {
	struct controller_memory memory; /* built and LIVE, of the engine's generation */
	struct ows_who who;              /* serial, uid, pid, name (cleaned); person is empty */
	uint8_t token[16]; /* of its welcome: that of the hello, if it had one, else a new one */
	/* bit r: it may command record r (bit 0: reset the driver); NULL: all. Lives as long as
	   memory */
	const uint32_t *rights;
};
