/* SPDX-License-Identifier: MIT */
/* The kind of chip that a family code stands for. */
#ifndef SIGNAL_FAMILY_H
#define SIGNAL_FAMILY_H

#include <stdint.h>

/* "DS18B20"; NULL: not known. Other chips may have the same code: it is the usual one. */
const char *family_name(uint8_t code);

#endif
