/* SPDX-License-Identifier: MIT */
/* The families of simulated slaves: a word in the list below for each. */
#pragma once

#include "hal/sim/slave.h"

/* clang-format off */
/* Of the parts with the same family code the first one stands for the code. */
#define SIM_FAMILIES(family) \
	/* thermometers */ \
	family(ds18b20) family(ds18s20) family(ds1822) family(ds1825) family(ds28ea00) \
	family(ds18b20_a2) family(ds18b20_a3) family(ds18b20_b1) family(ds18b20_b1v2) \
	family(ds18b20_b2) family(ds18b20_c) family(ds18b20_d1) family(ds18b20_d2) \
	family(ds18b20_e) family(ds18b20_f) family(ds18b20_g) family(ds18b20_h) \
	family(max31825) family(max31826) family(max31850) \
	family(max31888) family(max30207) \
	/* loggers */ \
	family(ds1921g) family(ds1921h) family(ds1921z) \
	family(ds1923) family(ds1922l) family(ds1922t) family(ds2422) \
	/* switches */ \
	family(ds2405) family(ds2406) family(ds2408) family(ds2413) family(ds2413_emulated) \
	/* couplers, bridges to I2C */ \
	family(ds2409) family(ds28e17) family(ds28e18) \
	/* voltages, batteries */ \
	family(ds2436) family(ds2437) family(ds2438) family(ds2438_a6) family(ds2438_emulated) family(tmp1826) family(tmp1827) \
	family(ds2450) family(ds2720) \
	family(ds2740) family(ds2751) family(ds2755) family(ds2760) family(ds2770) \
	family(ds2780) family(ds2781) \
	/* Embedded Data Systems */ \
	family(eds0064) family(eds0065) family(eds0066) family(eds0067) family(eds0068) \
	family(eds0070) family(eds0071) family(eds0072) \
	family(eds0080) family(eds0082) family(eds0083) family(eds0085) family(eds0090) \
	/* memories */ \
	family(ds2423) family(ds2430a) family(ds2431) family(ds2433) family(ds2502) \
	family(ds28ec20) \
	family(ds1991) family(ds1425) family(ds1992) family(ds1993) family(ds1995) \
	family(ds1996) family(ds1963l) family(ds1963s) family(ds1977) family(ds2505) \
	family(ds2506) family(ds1982u) family(ds1985u) family(ds1986u) family(ds28e04) \
	/* clocks, potentiometer */ \
	family(ds2404) family(ds1994) family(ds2415) family(ds2417) family(ds2890) \
	family(ds2401) family(ds1420) \
	/* what others than Maxim make */ \
	family(hb_uvi_meter) family(hb_moisture_meter) family(hb_hub) family(hb_barometer) \
	family(hb_humidity) family(hb_multitemp) family(lcd) family(bae0910) family(bae0911) \
	family(inferno_switches) family(inferno_rgbw) family(inferno_updater) family(iblss) \
	family(mrs001) family(mcm001) family(mdi001) family(mam001)
/* clang-format on */

#define SIM_FAMILY_DECLARE(part) extern const struct sim_family sim_##part;
SIM_FAMILIES(SIM_FAMILY_DECLARE)
