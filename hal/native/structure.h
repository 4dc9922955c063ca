/* SPDX-License-Identifier: MIT */
/* /structure: what properties a family has. */
#pragma once

#include "hal/chips/family.h"

/* "t,000000,000001,ro,000012,v,": its length, or -EMSGSIZE. */
int structure_print(const struct property *property, int extension, char *text, size_t room);
/* The family that a path below /structure begins with, in *used bytes; NULL: none. */
const struct family *structure_family(const char *path, size_t len, size_t *used);
