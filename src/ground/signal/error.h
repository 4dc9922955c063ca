/* SPDX-License-Identifier: MIT */
#pragma once

/*
 * The words for a negative errno of the bus contract (hal/bus/bus.h) or of libows, and what the
 * user can do about the error. Neither is NULL; the remedy is "" where the user can do nothing.
 */
const char *error_text(int err);
const char *error_remedy(int err);

/* Both in one: "no such property: check its spelling; ...". Returns words. */
#define ERROR_WORDS 160
const char *error_words(int err, char words[ERROR_WORDS]);

/* The same of an answer, with the number that -EDOM refuses; and that without the remedy. */
const char *error_answer_words(int err, double number, char words[ERROR_WORDS]);
const char *error_answer_text(int err, double number, char words[ERROR_WORDS]);
