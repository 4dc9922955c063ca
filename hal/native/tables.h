/* SPDX-License-Identifier: MIT */
/* The directories of OWFS that belong to no device. */
#pragma once

#include <stddef.h>

struct family;

/* The table of names in /statistics and the like; NULL: none of that name. */
const struct family *virtual_family(const char *name, size_t len);
