/* SPDX-License-Identifier: MIT */
/*
 * What a fuzz target is written with. A target is one file that defines fuzz_one(); it is linked
 * twice: with libFuzzer (make fuzz), and with replay.c, which runs its seeds and found cases as a
 * part of make unit. Properties are checked with Unity's assertions; a target keeps nothing from
 * one input to the next that could change what it does.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "unity.h"

/* One input. */
void fuzz_one(const uint8_t *bytes, size_t n);
/* The most memory that an input of n bytes may have at a time; checked under the sanitizers. */
size_t fuzz_memory(size_t n);

/* Inside of a larger block of memory: who touches these bytes is caught, under the sanitizers. */
void fuzz_forbid(const void *bytes, size_t n, bool yes);

/* From main or LLVMFuzzerTestOneInput: one input, its memory watched; aborts when it fails. */
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n);

/* What is left of an input. All of these give 0 or "" at its end. */
struct fuzz {
	const uint8_t *at, *end;
};
static inline size_t fuzz_left(const struct fuzz *fuzz)
{
	return (size_t)(fuzz->end - fuzz->at);
}
uint8_t fuzz_byte(struct fuzz *fuzz);
uint32_t fuzz_word(struct fuzz *fuzz);
int64_t fuzz_long(struct fuzz *fuzz);
/* Up to most bytes, where they lie: as many as a byte says that comes before them. */
const uint8_t *fuzz_bytes(struct fuzz *fuzz, size_t most, size_t *n);
/* The same as a text: what stands before a NUL or the end of the line, which is taken too. */
const char *fuzz_line(struct fuzz *fuzz, char *room, size_t size);
