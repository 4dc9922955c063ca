/* SPDX-License-Identifier: MIT */
/*
 * Types are checked against /structure, once, when a target comes to serve a signal: one whose type
 * cannot hold its property, or that writes what is read-only, is reported before its first value.
 */
#pragma once

#include "src/daemon/engine/table.h"

struct structure_check {
	char path[96];         /* "/structure/28/temperature12" */
	uint32_t first, count; /* rows in structure.rows */
};
struct structure {
	struct structure_check *checks;
	uint32_t *rows;
	uint32_t *check_of; /* by row of the table; STRUCTURE_NONE: it needs none */
	uint32_t count;
};
#define STRUCTURE_NONE UINT32_MAX

/* The checks that the rows need, each different path once. 0 or -ENOMEM. */
int structure_init(struct structure *structure, const struct table *table);
void structure_free(struct structure *structure);

/* "t,000000,000001,ro,000012,v," as parsed. */
struct structure_entry {
	char type;      /* y yes/no, i u integer, f t g p float, a b d l text, D directory */
	long index;     /* -1: .ALL, -2: .BYTE */
	char access[3]; /* "ro" "rw" "wo" "oo" */
};
/* 0 or -EILSEQ. */
int structure_parse(const char *text, size_t len, struct structure_entry *entry);
/*
 * 0 if the signal can work on such a property; else why not, and -EISDIR it is none, -EPROTOTYPE
 * the type does not fit, -EACCES it can only be read, or only be written.
 */
int structure_fault(const struct structure_entry *entry, const struct config_item *item,
                    const char **why);
