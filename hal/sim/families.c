/* SPDX-License-Identifier: MIT */
#include "families.h"

#include <stddef.h>

const struct sim_family *const sim_families[] = {
	&sim_ds18b20, &sim_ds18s20, &sim_ds1822, &sim_ds1825, &sim_ds28ea00, &sim_ds2401,
	&sim_ds2408,  &sim_ds2413,  &sim_ds2438, NULL,
};
