/* SPDX-License-Identifier: MIT */
/*
 * A reload: an engine of the changed configuration takes over from the one that runs. What stays is
 * planned from the two configurations on the supervisor's thread; the taking over itself neither
 * allocates nor searches and belongs to the engine's thread.
 */
#ifndef ENGINE_ADOPT_H
#define ENGINE_ADOPT_H

#include "engine.h"

#define ADOPT_NEW UINT32_MAX

struct adoption {
	/* of each new row: the old one of the same name, path and type; ADOPT_NEW: there is none */
	uint32_t *rows;
	uint32_t *successors; /* the other way round: of each old row the new one, or ADOPT_NEW */
	/* of each new target: the old one that goes on as it is; -1: it has to be opened anew */
	int *ports;
	uint32_t kept_rows;
	unsigned kept_ports;
};

/*
 * Ways to one wire stay all or none: their texts, their order and their options have to be the same.
 * 0 or -ENOMEM.
 */
int adoption_plan(struct adoption *plan, const struct config *config, const struct config *before);
void adoption_free(struct adoption *plan);

/*
 * e is as engine_create() made it, its image not shown and its commands empty; old has run until
 * now. The signals that stay go on with value, quality, alarms and retries, as do the targets that
 * stay with what they were lent: their answers are e's from here on. The commands of old are retired
 * and carried over. old serves no more; it may be destroyed when the buses that did not stay have
 * ended.
 */
void engine_adopt(struct engine *e, struct engine *old, const struct adoption *plan, int64_t now_ns);
/* The buses that did not stay have ended: what guests had lent to them is theirs again. */
void engine_abandon(struct engine *old);

#endif
