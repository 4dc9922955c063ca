/* SPDX-License-Identifier: MIT */
/* The kernel's masters. */
#ifndef HAL_W1_MASTER_H
#define HAL_W1_MASTER_H

#include "hal/w1/link.h"

extern const struct link_master_ops w1_master;

/* Takes those that came since. */
void w1_look_for_masters(struct w1_master *master);

#endif
