/* SPDX-License-Identifier: MIT */
/* The forms in which owsctl modbus-map writes its rows for programs that import them. */
#pragma once

#include <stdbool.h>
#include <stdio.h>

/* What a row has, in this order; the words of the forms have the same names. */
#define MODBUS_CELLS(X) \
	X(place) X(record) X(float32) X(float64) X(name) X(type) X(io) X(unit) X(identity)
enum modbus_cell {
#define X(name) MODBUS_CELL_##name,
	MODBUS_CELLS(X)
#undef X
		MODBUS_CELL_COUNT,
};
#define MODBUS_CELL_TEXTS MODBUS_CELL_name /* those before it are numbers */
extern const char *const modbus_cell_names[MODBUS_CELL_COUNT];

struct modbus_form;

/* NULL: there is none of that name. */
const struct modbus_form *modbus_form_find(const char *name);
/* Their names, with a blank between them. */
const char *modbus_form_names(void);

/* What is the same in all rows. */
struct modbus_file {
	FILE *out;
	const char *instance, *host, *port; /* where owsd-modbus is, as the program reaches it */
	unsigned count;                     /* of places with a signal */
	unsigned written;                   /* 0 at first */
	/* Of the next row: the name is that of another signal, but for case. */
	bool twin;
};

void modbus_form_begin(struct modbus_file *file, const struct modbus_form *form);
/* A place without a signal has an empty name: most forms leave it out. */
void modbus_form_row(struct modbus_file *file, const struct modbus_form *form,
                     const char *const cells[MODBUS_CELL_COUNT]);
void modbus_form_end(struct modbus_file *file, const struct modbus_form *form);
