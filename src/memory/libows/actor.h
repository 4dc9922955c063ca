/* SPDX-License-Identifier: MIT */
/* Who did something, as the image has it and as libows shows it. */
#pragma once

#include <string.h>

#include "src/public/ows.h"
#include "src/public/ows_layout.h"

static inline struct ows_by actor_of(const struct ows_who *who)
{
	struct ows_by by = {.serial = who->serial, .uid = who->uid, .pid = who->pid};

	memcpy(by.name, who->name, sizeof(by.name) - 1);
	memcpy(by.person, who->person, sizeof(by.person) - 1);
	return by;
}
