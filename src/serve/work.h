/* SPDX-License-Identifier: MIT */
/* Between the files that work on requests. */
#ifndef SERVE_WORK_H
#define SERVE_WORK_H

#include "src/serve/server.h"

/* client.worst before any target has answered */
#define WORK_NOT_YET 1

/* Answers. */
void answer_code(struct serve *s, struct client *c, int32_t code);
/* A negative errno. */
void answer_error(struct serve *s, struct client *c, int err);
/* len bytes of value are in client_room(): the part that the client wants. */
void answer_value(struct serve *s, struct client *c, uint32_t len);
void answer_written(struct serve *s, struct client *c, uint32_t taken);

/* Ask the engine for c->path; the step is what its answer goes on with. */
void work_ask(struct serve *s, struct client *c, enum client_step step, enum bus_op op, int lane,
              uint8_t *data, uint32_t len);
/* c->path as the target that has to answer counts its buses; returns the lane. */
int work_path(struct serve *s, struct client *c);
/* c->path of a property of the node's device. */
void work_device_path(struct client *c, const char *property);
/* False: a reload went on while the engine had the request, and targets may have other numbers. */
bool work_same_targets(const struct serve *s, const struct client *c);
unsigned work_targets(const struct serve *s);
/* Of what each target has its part of: c->target up to the next one that is up. */
void work_next_target(struct serve *s, struct client *c);
bool work_is_directory(const struct node *node);
/* With the path understood and its bus known. */
void work_go_on(struct serve *s, struct client *c);

/* work_directory.c */
void work_want_directory(struct serve *s, struct client *c, enum client_step step);
void work_listed(struct serve *s, struct client *c, int err);

/* work_read.c */
void work_read(struct serve *s, struct client *c);
void work_read_answered(struct serve *s, struct client *c, int err);
/* Not readable, nor writable, if it is there. */
void work_refuse_directory(struct serve *s, struct client *c);
/*
 * A scale was asked for, and whether the value has one is not known: ask what it is. False: there
 * is nothing to ask.
 */
bool work_ask_type(struct serve *s, struct client *c);
void work_typed(struct serve *s, struct client *c, int err);

/* work_write.c */
void work_write(struct serve *s, struct client *c);
void work_write_target(struct serve *s, struct client *c);
void work_written(struct serve *s, struct client *c, int err);

#endif
