/* SPDX-License-Identifier: MIT */
/* Computes the attributes of a signal from what owsd publishes and from the running time. */
#ifndef LIBOWS_ATTRIBUTE_H
#define LIBOWS_ATTRIBUTE_H

#include <stdint.h>

struct ows;
struct ows_id;
struct ows_value;

/* As ows_get(), for an id that names an attribute. */
int attribute_get(struct ows *h, struct ows_id *id, int64_t now_ns, struct ows_value *value);

#endif
