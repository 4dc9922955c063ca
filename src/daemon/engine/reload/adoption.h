/* SPDX-License-Identifier: MIT */
/*
 * What stays over a reload: a pure comparison of two configurations, made on the supervisor's
 * thread.
 */
#pragma once

#include <stdint.h>

#include "src/config/read/config.h"

#define ADOPT_NEW UINT32_MAX

struct adoption {
	/*
	 * of each new row: the old one of the same path and type, and of the same name or, if it
	 * was renamed, of the same identity; ADOPT_NEW: there is none
	 */
	uint32_t *rows;
	uint32_t *successors; /* the other way round: of each old row the new one, or ADOPT_NEW */
	/* of each new target: the old one that goes on as it is; -1: it has to be opened anew */
	int *ports;
	int *port_successors; /* the other way round: of each old target the new one, or -1 */
	uint32_t kept_rows;
	unsigned kept_ports;
};

/*
 * Ways to one wire stay all or none: their texts, their order and their options have to be the
 * same. 0 or -ENOMEM.
 */
int adoption_plan(struct adoption *plan, const struct config *config, const struct config *before);
void adoption_free(struct adoption *plan);
