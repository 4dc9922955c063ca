/* SPDX-License-Identifier: MIT */
/*
 * The image of a few signals that an earlier owsd of this major version made, kept in
 * tests/unit/data, and the same one made by the present writer. Each field of a record is a
 * function of the record's number, so that all differ.
 */
#pragma once

#include "src/memory/shm/image.h"

#define S INT64_C(1000000000)
#define START_NS (1000 * S)
#define NOW_NS (1010 * S)
#define TEXT_CAP 64
#define SIZE_MAX_ 262144
/* The file in tests/unit/data. */
#define RECORDED "image-2.1"
#define LONG_TEXT \
	"K\xc3\xbchlraum 3, Verdampfer \xc2\xb0" \
	"C: text of sixty-four bytes, all used!"

enum {
	BOOL_ = 1,
	BYTE_,
	SHORT_,
	LONG_,
	WORD_,
	DWORD_,
	FLOAT_,
	DOUBLE_,
	LARGE_,
	STRING_,
	EMPTY_,
	NEVER_
};
#define COUNT NEVER_

extern const struct image_signal signals[COUNT];
/* The name under which the image is shown. */
extern char instance[40];
extern char image_memory[SIZE_MAX_];
extern struct image image;

/* setUp() and tearDown(): load the recorded image into memory, and show it. */
void recording_begin(void);
void recording_end(void);

/* Load a file of tests/unit/data. Returns the size. */
uint32_t read_recording(const char *file, char *memory);
void show(const char *kind, const char *memory, uint32_t size);
/* Make the image by the present writer, in memory. */
void make_image(void);
/* Write the recording again. */
void record(void);
