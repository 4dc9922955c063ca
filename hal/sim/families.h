/* SPDX-License-Identifier: MIT */
/* The families of simulated slaves: a word in the list below for each. */
#ifndef HAL_SIM_FAMILIES_H
#define HAL_SIM_FAMILIES_H

#include "hal/sim/slave.h"

/* clang-format off */
/* Of the parts with the same family code the first one stands for the code. */
#define SIM_FAMILIES(family) \
	/* thermometers */ \
	family(ds18b20) family(ds18s20) family(ds1822) family(ds1825) family(ds28ea00) \
	family(max31826) family(max31850) \
	/* switches */ \
	family(ds2405) family(ds2406) family(ds2408) family(ds2413) \
	/* voltages, batteries */ \
	family(ds2438) family(ds2450) family(ds2720) \
	/* memories */ \
	family(ds2423) family(ds2430a) family(ds2431) family(ds2433) family(ds2502) \
	family(ds28ec20) \
	family(ds2401)
/* clang-format on */

#define SIM_FAMILY_DECLARE(part) extern const struct sim_family sim_##part;
SIM_FAMILIES(SIM_FAMILY_DECLARE)

#endif
