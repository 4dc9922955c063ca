/* SPDX-License-Identifier: MIT */
/* Sets outputs and attributes: the checks, the slot of the command segment, the bell. */
#pragma once

#include <stdint.h>

struct ows;
struct ows_id;

/* As ows_set_text(), for an id that need not be one of the handle's. */
int handle_set_text(struct ows *h, const struct ows_id *id, const char *text, uint32_t *stamp);
