/* SPDX-License-Identifier: MIT */
/* Opens an instance of a directory that the caller names, for owsctl. */
#pragma once

#include "src/public/ows.h"

/* As ows_open_as(), in this directory alone. */
int open_in(const char *dir, const char *instance, enum ows_mode mode, const char *name,
            struct ows **h);
/* The directory that the instance was found in; lives as long as the handle. */
const char *open_dir(const struct ows *h);
