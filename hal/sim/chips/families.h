/* SPDX-License-Identifier: MIT */
/* The slave families there are: one line here and one in families.c for each new file. */
#ifndef HAL_SIM_CHIPS_FAMILIES_H
#define HAL_SIM_CHIPS_FAMILIES_H

#include "hal/sim/slave.h"

extern const struct sim_family sim_ds18b20, sim_ds18s20, sim_ds1822, sim_ds1825, sim_ds28ea00;
extern const struct sim_family sim_ds2405, sim_ds2406, sim_ds2408, sim_ds2413;
extern const struct sim_family sim_ds2438, sim_ds2450;
extern const struct sim_family sim_ds2423, sim_ds2430a, sim_ds2431, sim_ds2433;
extern const struct sim_family sim_ds2401;

#endif
