/* SPDX-License-Identifier: MIT */
/* Setting outputs and attributes: the checks, the slot of the command segment, the bell. */
#ifndef LIBOWS_SET_H
#define LIBOWS_SET_H

#include <stdint.h>

struct ows;
struct ows_id;

/* As ows_set_text(), of an id that need not be one of the handle. */
int handle_set_text(struct ows *h, const struct ows_id *id, const char *text, uint32_t *stamp);

#endif
