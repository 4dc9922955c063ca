/* SPDX-License-Identifier: MIT */
/*
 * Values in the form that a client wants: temperature and pressure in the client's scale, numbers
 * with or without padding. Buses use degrees Celsius and mbar. Pure functions on texts; lists
 * ("1,2,3") are converted element by element.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Does this property (a letter of /structure) need a conversion for these flags? */
bool units_convert(char type, uint32_t flags);
/* Could a property of unknown type need a conversion for these flags? */
bool units_asked(uint32_t flags);
/*
 * From the bus to the client: convert and pad or trim len bytes in place. Returns the length, or
 * -EIO when a number does not parse, -EMSGSIZE.
 */
int units_show(char type, uint32_t flags, char *text, size_t len, size_t room);
/* From the client to the bus, into out. Returns the length; -EINVAL: no number; -EMSGSIZE. */
int units_take(char type, uint32_t flags, const char *text, size_t len, char *out, size_t room);
