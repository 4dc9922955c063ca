/* SPDX-License-Identifier: MIT */
/* Reads values: a whole sample of the image, its age, and its quality, lowered if owsd is dead. */
#pragma once

#include <stddef.h>
#include <stdint.h>

struct ows;
struct ows_id;
struct ows_value;

/* As ows_get_text(), of an id that need not be one of the handle; size is not 0. */
int handle_get_text(struct ows *h, struct ows_id *id, int64_t now_ns, struct ows_value *value,
                    char *text, size_t size);
