/* SPDX-License-Identifier: MIT */
/* What is behind the paths. */
#pragma once

#include "src/faces/web/web.h"

/* A path (without the first "/"); NULL: there is none. */
const struct web_path *api_find(const char *path, bool post);
/*
 * May a body be large that comes there, with the "/"? Only that of a configuration, by a person who
 * may edit it. Looks at the head alone.
 */
bool api_admits(const struct request *request, const char *path);
