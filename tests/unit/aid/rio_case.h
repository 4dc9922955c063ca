/* SPDX-License-Identifier: MIT */
/* One document after the other, as texts, and what is in it. */
#ifndef TESTS_UNIT_AID_RIO_CASE_H
#define TESTS_UNIT_AID_RIO_CASE_H

#include "src/config/rio.h"
#include "tests/unit/aid/said.h"

/* The one that was parsed last. */
extern struct rio *rio;

/* setUp() and tearDown() */
void rio_case_begin(void);
void rio_case_end(void);

/* A text in which nothing is wrong; its root. */
struct rio_node *rio_case_parse(const char *text);
/* The first of that key in block is of that kind and value. */
void rio_case_expect(const struct rio_node *block, const char *key, enum rio_kind kind,
                     const char *value);

#endif
