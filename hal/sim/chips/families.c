/* SPDX-License-Identifier: MIT */
#include <stddef.h>

#include "hal/sim/chips/families.h"

const struct sim_family *const sim_families[] = {
	&sim_ds18b20, &sim_ds18s20, &sim_ds1822, &sim_ds1825, &sim_ds28ea00, /* thermometers */
	&sim_ds2405,  &sim_ds2406,  &sim_ds2408, &sim_ds2413,                /* switches */
	&sim_ds2438,  &sim_ds2450,                                           /* voltages */
	&sim_ds2423,  &sim_ds2430a, &sim_ds2431, &sim_ds2433,                /* memories */
	&sim_ds2401,  NULL,
};
