/* SPDX-License-Identifier: MIT */
/* What people can do about a value that is not good. */
#ifndef SHOW_REMEDY_H
#define SHOW_REMEDY_H

#include <stdint.h>

/* Of a quality (enum ows_quality), where no error says more; "": nothing. Never NULL. */
const char *remedy_of(uint8_t quality);

#endif
