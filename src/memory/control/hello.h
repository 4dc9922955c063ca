/* SPDX-License-Identifier: MIT */
/* The first words of a program that has connected. */
#pragma once

#include "src/memory/control/private.h"

/* Take them, if they have come: the program joins, waits for a reload, or is refused. */
void hello_take(struct control *c, struct control_seat *p);
