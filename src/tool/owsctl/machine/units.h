/* SPDX-License-Identifier: MIT */
/* The units of an instance, as systemd has them. */
#pragma once

#include <stdbool.h>

struct doctor;
struct unit;

/* Find out which there are, and how they do. */
void units_load(struct doctor *d);
/* NULL: there is none of that name. */
const struct unit *units_find(const struct doctor *d, const char *id);
/* That of the instance's owsd. */
const struct unit *units_owsd(const struct doctor *d);
/* NULL is not. */
bool unit_is_active(const struct unit *unit);
/* The command that has the configuration loaded as owsd is now: it works. Returns text. */
#define UNITS_COMMAND 1000
const char *units_load_command(const struct doctor *d, char text[UNITS_COMMAND]);
