/* SPDX-License-Identifier: MIT */
#pragma once

#include <stdint.h>

struct ows_value;

/*
 * The time that a value with its quality is of, not after now_ns: of the measurement if the value
 * is good. A value that is not good has the number of an earlier measurement; what is new is its
 * quality, since the last attempt, or since now. Pure.
 */
int64_t moment_of(const struct ows_value *v, int64_t now_ns);
