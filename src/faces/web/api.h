/* SPDX-License-Identifier: MIT */
/* What is behind the paths. */
#pragma once

#include "src/faces/web/web.h"

/* A path (without the first "/"); NULL: there is none. */
const struct web_path *api_find(const char *path, bool post);
