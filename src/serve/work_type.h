/* SPDX-License-Identifier: MIT */
/* What type a property has that is not known here: asked of its target, for the units of a client. */
#ifndef SERVE_WORK_TYPE_H
#define SERVE_WORK_TYPE_H

#include "src/serve/server.h"

/*
 * A scale was asked for, and whether the value has one is not known: ask what it is. False: there
 * is nothing to ask.
 */
bool work_ask_type(struct serve *s, struct client *c);
/* The engine has answered. True: the type is known now; false: asked again, or answered. */
bool work_typed(struct serve *s, struct client *c, int err);

#endif
