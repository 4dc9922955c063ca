/* SPDX-License-Identifier: MIT */
/* The branches of couplers as channels: they come with the coupler, and go with it. */
#pragma once

#include "hal/native/state.h"

void branches_found(struct native *native, struct device *coupler);
/* True: it had branches; their channels are gone. */
bool branches_lost(struct native *native, const struct device *coupler);
/* Wire n has this link from now on: what stands in front of it. */
struct link *branches_wire(struct native *native, unsigned n, struct link *link);
/* The channel of "main" or "aux" of a coupler; -ENODEV: there is none. */
int branches_channel(const struct native *native, const struct device *coupler,
                     struct path_slice word);
/*
 * This coupler of a wire is in alarm: its news of an edge on a branch that was off are taken down.
 * 0 or an error.
 */
int branches_look(struct native *native, const uint8_t rom[8]);
/* Can there be such news of this branch? Not of one that is behind another. */
bool branches_has_news(struct native *native, unsigned channel);
/* Are there such news of this branch? */
bool branches_news(struct native *native, unsigned channel);
void branches_news_end(struct native *native, unsigned channel);
/* Is this branch on now? */
bool branches_is_on(struct native *native, unsigned channel);
/*
 * "1F.000000000001/main/" with all couplers on the way; "" of a wire. 0, or -EMSGSIZE: text has the
 * last ones only.
 */
int branches_print(struct native *native, unsigned channel, char *text, size_t room);
/* What bus.N is called in a message: "bus.0", "1F.000000000001/main", ".../1F.000000000009/aux". */
void branches_name(struct native *native, unsigned channel, char *text, size_t room);
