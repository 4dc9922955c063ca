/* SPDX-License-Identifier: MIT */
/* Who did something, as text cells and as JSON. */
#pragma once

#include "src/faces/show/json.h"
#include "src/public/ows.h"

#define ACTOR_TEXT 64
/* The program: "plc[4711]"; "owsd" where owsd did it itself. The name is the program's claim. */
const char *actor_program(const struct ows_by *who, char text[ACTOR_TEXT]);
/* The user: the name, else the number; "-" where owsd did it itself. */
const char *actor_user(const struct ows_by *who, char text[ACTOR_TEXT]);
/* "plc[4711] (user anna) for Bert". */
#define ACTOR_LINE (3 * ACTOR_TEXT)
const char *actor_line(const struct ows_by *who, char text[ACTOR_LINE]);
/* The member "by": an object, or null where owsd did it itself. */
void actor_json(struct json *json, const struct ows_by *who);
