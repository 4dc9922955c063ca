/* SPDX-License-Identifier: MIT */
/* Parses configurations from texts, and compares the messages about them. */
#pragma once

#include "src/config/read/config.h"
#include "tests/unit/aid/said.h"

#define COUNT(a) (sizeof(a) / sizeof((a)[0]))
/* The keys of an item that is complete. */
#define ITEM "Name x Path /a/b Type byte "

/* The last configuration that was parsed; NULL when it was refused. */
extern struct config *config;

/* setUp() and tearDown() */
void config_case_begin(void);
void config_case_end(void);

/*
 * Parse a text, and check what is given twice and what a family decides: the file "f", keys of
 * OwsDrv from line 2 on, keys of its one Item from line 3 on.
 */
int parse(const char *text);
int parse_driver(const char *keys);
int parse_item(const char *keys);

struct line {
	const char *keys, *said;
};

/* Parse each text, and compare whether it is refused, and its messages. */
void expect_errors(const struct line *cases, size_t count, int (*by)(const char *));
void expect_warnings(const struct line *cases, size_t count, int (*by)(const char *));
