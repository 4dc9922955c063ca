/* SPDX-License-Identifier: MIT */
/* Requests to the engine: the path, the target, and the step that follows the answer. */
#pragma once

#include "src/daemon/serve/server.h"

/* client.worst before any target has answered */
#define WORK_NOT_YET 1

/* Ask the engine for c->path; step is what follows the answer. */
void work_ask(struct serve *s, struct client *c, enum client_step step, enum bus_op op, int lane,
              uint8_t *data, uint32_t len);
/* c->path as the target that has to answer counts its buses; returns the lane. */
int work_path(struct serve *s, struct client *c);
/* The same, of a property of the node's device. */
int work_device_path(struct serve *s, struct client *c, const char *property);
/* False: a reload went on while the engine had the request, and targets may have other numbers. */
bool work_same_targets(const struct serve *s, const struct client *c);
/* Move c->target up to the next target that is up, for what each target has its part of. */
void work_next_target(struct serve *s, struct client *c);
bool work_is_directory(const struct node *node);
/* Refuse a directory, which can be neither read nor written, if it exists. */
void work_refuse_directory(struct serve *s, struct client *c);

/* READ: the room that the type needs after the value. */
#define WORK_TYPE_MOST 64
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
