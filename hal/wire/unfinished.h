/* SPDX-License-Identifier: MIT */
/*
 * Registers are changed by reading, changing and writing them. A write that goes wrong may leave
 * what no request asked for, and what is written next must not begin with that: with the device is
 * kept what the last write that has not succeeded began with. which: the area of its registers, or
 * anything else that has an address; at: where in it.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct device;

/*
 * bytes are what is there. If such a write of these registers has not succeeded yet, they become
 * what was there before it, but for the bits that it was to change: they may have changed, and a
 * write of others must not undo that.
 */
bool unfinished_base(const struct device *device, const void *which, unsigned at, uint8_t *bytes,
                     size_t n);
/* Ahead of a write: bytes are what it begins with, want what it is to make of them. */
void unfinished_begin(struct device *device, const void *which, unsigned at, const uint8_t *bytes,
                      const uint8_t *want, size_t n);
/* It has succeeded. */
void unfinished_end(struct device *device, const void *which, unsigned at);
