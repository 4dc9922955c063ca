/* SPDX-License-Identifier: MIT */
/* Texts of latches, flags and alarm conditions. Pure functions. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Room for a text of an alarm item, bytes. */
#define ALARM_TEXT 256

/* 1, 0, or -EILSEQ: blanks trimmed; a list is non-zero if one entry is; also yes/no, on/off. */
int alarm_non_zero(const char *text, size_t len);
/*
 * The channels that a latch which is not zero names: the bits of a number, or the entries of a
 * list; 1 where it names none.
 */
uint32_t alarm_channels(const char *text);
/* Without leading blanks, cut at size - 1 and NUL-terminated. */
void alarm_trim(char *to, size_t size, const char *text, size_t len);
/* Does the chip say what SetAlarm wants? Numbers are compared as numbers. */
bool alarm_as_set(const char *text, size_t len, const char *value);
