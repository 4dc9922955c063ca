/* SPDX-License-Identifier: MIT */
/* Parses .rio documents from texts, and checks what is in them. */
#pragma once

#include "src/config/read/rio.h"
#include "tests/unit/aid/said.h"

/* The last document that was parsed. */
extern struct rio *rio;

/* setUp() and tearDown() */
void rio_case_begin(void);
void rio_case_end(void);

/* Parse a text that must be free of errors. Returns its root. */
struct rio_node *rio_case_parse(const char *text);
/* Check kind and value of the first entry with that key in block. */
void rio_case_expect(const struct rio_node *block, const char *key, enum rio_kind kind,
                     const char *value);
