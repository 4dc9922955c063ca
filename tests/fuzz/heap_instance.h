/* SPDX-License-Identifier: MIT */
/*
 * An instance of owsd whose image lies on the heap, and the memory of its controller, each exactly
 * as long as it says; and libows' way to both: ows_open() maps what stands in the files here,
 * whatever the name.
 */
#pragma once

#include "src/memory/shm/controller.h"
#include "src/memory/shm/image.h"
#include "tests/fuzz/fuzz.h"

/* What ows_open() finds; base NULL: nothing. */
struct heap_file {
	char *base;
	size_t size;
};
extern struct heap_file heap_image_file, heap_controller_file;

#define HEAP_TEXT 64
#define HEAP_START (INT64_C(1000) * 1000000000)
#define HEAP_SIGNALS 6
/* room (double), relay (bool, output), count (large), label (string, output), level (byte, output),
   warm (float) */
extern const struct heap_signal {
	const char *name, *path;
	uint8_t type;
} heap_signals[HEAP_SIGNALS];

struct heap_instance {
	struct image image;
	struct controller_layout layout;
	char *image_memory, *controller_memory;
	size_t image_size, controller_size;
};
extern struct heap_instance heap;

/* As it was made: live, with a heart that beat at HEAP_START, each signal good. Allocates once. */
void heap_instance_reset(void);
void heap_beat(int64_t now_ns);
/* A good value of a record; of the string the text. */
void heap_put(uint32_t record, int64_t value, const char *text, int64_t measured_ns,
              uint32_t applied);
