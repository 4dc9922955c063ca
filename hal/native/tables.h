/* SPDX-License-Identifier: MIT */
/* The directories of OWFS that belong to no device. */
#pragma once

#include <stddef.h>

struct family;
struct native;

/* The settings as they are at the start. */
void native_settings(struct native *native);
/* The table of names in /statistics and the like; NULL: none of that name. */
const struct family *virtual_family(const char *name, size_t len);
