/* SPDX-License-Identifier: MIT */
/*
 * The newest value of a signal, by the one rule of all programs that show signals to others. What
 * libows returns beside a value says only whether there is a number; its quality says the rest:
 *
 * - 0, -ENOSPC (the text is cut): the image has the value.
 * - -ESTALE (owsd has reloaded, ended or started): the image is an old one, and has the value that
 *   it had last; libows makes its quality bad when owsd's heart has stood still for too long.
 * - -EAGAIN (owsd died as it wrote), -ENOENT, and no image at all: there is no number. It is no
 *   error of the signal: the next look at the changes says that owsd is gone, or another.
 */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "src/ground/signal/value.h"
#include "src/public/ows.h"

struct face_value {
	struct ows_value v; /* its quality is the one to show */
	/*
	 * An owsd that is there says so. Else the quality is OWS_Q_NO_OWSD or what it was before,
	 * and who keeps values has nothing new to keep.
	 */
	bool known;
	bool good; /* else no number of it may be shown */
	bool simulated, lost;
	char text[VALUE_STRING_MAX + 1]; /* of a string; of a number after face_value_text() */
};

/* live: the face has not lost owsd. h NULL: there is no image. */
void face_value(struct ows *h, int signal, bool live, int64_t now_ns, struct face_value *value);
/* Does what ows_get() has filled count when it returns that? */
bool face_value_counts(int err);
/* The text of the number with all its digits, too. Returns value->text. */
const char *face_value_text(struct face_value *value);
/* Why it is not good, and what to do: an error says more than its quality. "": it is, or nothing */
const char *face_value_why(const struct face_value *value);
const char *face_value_remedy(const struct face_value *value);

/* The time that a value with its quality is of. */
int64_t face_value_time(const struct ows_value *v, int64_t now_ns);
/*
 * Has it changed? A hash of the value as it is shown, never 0: of one that is not good of its
 * quality alone. text: of a string; else any.
 */
uint64_t face_value_print(const struct ows_value *v, const char *text);
