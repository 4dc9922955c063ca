/* SPDX-License-Identifier: MIT */
/* One configuration after the other, as texts, and what is said of each. */
#ifndef TESTS_UNIT_AID_CONFIG_CASE_H
#define TESTS_UNIT_AID_CONFIG_CASE_H

#include "src/config/config.h"
#include "tests/unit/aid/said.h"

#define COUNT(a) (sizeof(a) / sizeof((a)[0]))
/* Of an item that is complete. */
#define ITEM "Name x Path /a/b Type byte "

/* The one that was parsed last; NULL when it was refused. */
extern struct config *config;

/* setUp() and tearDown() */
void config_case_begin(void);
void config_case_end(void);

/* Of the file "f": a text, keys of OwsDrv from line 2 on, keys of its one Item from line 3 on. */
int parse(const char *text);
int parse_driver(const char *keys);
int parse_item(const char *keys);

struct line {
	const char *keys, *said;
};

/* Each is refused, or taken, and exactly this is said of it. */
void expect_errors(const struct line *cases, size_t count, int (*by)(const char *));
void expect_warnings(const struct line *cases, size_t count, int (*by)(const char *));

#endif
