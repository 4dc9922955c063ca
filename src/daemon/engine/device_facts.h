/* SPDX-License-Identifier: MIT */
/* What is known and counted of each device that signals name, and the image of it. */
#pragma once

#include "src/daemon/engine/state.h"

/* 0 or -ENOMEM. */
int engine_facts_init(struct engine *e);
void engine_facts_free(struct engine *e);
/* A bus has answered a request for the row; each answer counts once, also one that came late. */
void engine_facts_answer(struct engine *e, const struct lane *lane, uint32_t row,
                         const struct bus_answer *answer);
/* A request for the signal ended well, with an error of the item. */
void engine_facts_good(struct engine *e, const struct signal *s);
void engine_facts_failed(struct engine *e, const struct signal *s);
/*
 * A reload: the facts of those devices that were there before. lanes: of each old lane the new one,
 * or -1.
 */
void engine_facts_adopt(struct engine *e, const struct engine *old, const int *lanes);
/* Put into the image what has changed. */
void engine_publish_devices(struct engine *e);
