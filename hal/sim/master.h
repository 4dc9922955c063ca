/* SPDX-License-Identifier: MIT */
/* Scheme "sim": the DS2482 driver over a simulated network, `sim:FILE`, `sim:FILE:0x18.3`. */
#pragma once

#include "hal/sim/net.h"
#include "hal/wire/link.h"

extern const struct link_master_ops sim_master;

/* The network below a master of scheme "sim", for tests and benches. */
struct sim_net *sim_master_net(struct link_master *master);
