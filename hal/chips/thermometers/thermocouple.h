/* SPDX-License-Identifier: MIT */
/* Thermocouples: voltage and temperature by the reference functions of NIST (ITS-90). */
#pragma once

#include <stdbool.h>

enum thermocouple { TYPE_B, TYPE_E, TYPE_J, TYPE_K, TYPE_N, TYPE_R, TYPE_S, TYPE_T };

/* The lowest and the highest temperature of the type, in degrees Celsius, as OWFS states them. */
double thermocouple_low(enum thermocouple type);
double thermocouple_high(enum thermocouple type);
/* mV at this temperature, against 0 degrees. */
double thermocouple_mv(enum thermocouple type, double celsius);
/* The temperature of the hot end; false: the voltage is none of the type. */
bool thermocouple_celsius(enum thermocouple type, double mv, double cold, double *celsius);
