/* SPDX-License-Identifier: MIT */
/* The directories of OWFS that belong to no device. */
#pragma once

#include "hal/chips/family.h"

struct native;

/* The settings as they are at the start. */
void native_settings(struct native *native);
/* The table of names in /statistics and the like; NULL: none of that name. */
const struct family *virtual_family(const char *name, size_t len);

/* Of /structure. "t,000000,000001,ro,000012,v,": its length, or -EMSGSIZE. */
int structure_print(const struct property *property, int extension, char *text, size_t room);
/* The family that a path below /structure begins with, in *used bytes; NULL: none. */
const struct family *structure_family(const char *path, size_t len, size_t *used);
