/* SPDX-License-Identifier: MIT */
/* Asks a target for the type of a property that the server does not know, to convert its units. */
#pragma once

#include "src/daemon/serve/server.h"

/*
 * Ask for the type when the client wants a scale and the server does not know whether the value has
 * one. False: there is nothing to ask.
 */
bool work_ask_type(struct serve *s, struct client *c);
/*
 * The engine has answered. True: the type is known now; false: the server asks again, or has
 * answered the client.
 */
bool work_typed(struct serve *s, struct client *c, int err);
