/* SPDX-License-Identifier: MIT */
/* Who did something, as text cells and as JSON. */
#pragma once

#include "src/libows/ows.h"
#include "src/show/json.h"

#define WHO_TEXT 64
/* The program: "plc[4711]"; "owsd" where owsd did it itself. The name is the program's claim. */
const char *who_program(const struct ows_by *who, char text[WHO_TEXT]);
/* The user: the name, else the number; "-" where owsd did it itself. */
const char *who_user(const struct ows_by *who, char text[WHO_TEXT]);
/* "plc[4711] (user anna) for Bert". */
#define WHO_LINE (3 * WHO_TEXT)
const char *who_line(const struct ows_by *who, char text[WHO_LINE]);
/* The member "by": an object, or null where owsd did it itself. */
void who_json(struct json *json, const struct ows_by *who);
