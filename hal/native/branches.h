/* SPDX-License-Identifier: MIT */
/* The branches of couplers as channels: they come with the coupler, and go with it. */
#ifndef HAL_NATIVE_BRANCHES_H
#define HAL_NATIVE_BRANCHES_H

#include "hal/native/state.h"

void branches_found(struct native *native, struct device *coupler);
/* True: it had branches; their channels are gone. */
bool branches_lost(struct native *native, const struct device *coupler);
/* Wire n has this link from now on: what stands in front of it. */
struct link *branches_wire(struct native *native, unsigned n, struct link *link);
/* The channel of "main" or "aux" of a coupler; -ENODEV: there is none. */
int branches_channel(const struct native *native, const struct device *coupler,
                     struct path_slice word);
/* "1F.000000000001/main/" with all couplers on the way; "" of a wire. 0 or -EMSGSIZE. */
int branches_print(struct native *native, unsigned channel, char *text, size_t room);
/* What bus.N is called in a message: "bus.0", "1F.000000000001/main". */
void branches_name(struct native *native, unsigned channel, char *text, size_t room);

#endif
