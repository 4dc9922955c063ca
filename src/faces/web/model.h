/* SPDX-License-Identifier: MIT */
/* What a configuration says, as the forms of the page need it: keys as they are written. */
#pragma once

#include "src/config/read/rio.h"
#include "src/faces/show/json.h"

/*
 * The object "model" of a document, also of one with errors: then of what could be read. Of a key
 * that stands twice the first counts.
 */
void model_json(struct json *json, const struct rio *rio);
/* The array "keys": the table of the keys, from which the page makes its forms. */
void model_keys(struct json *json);
