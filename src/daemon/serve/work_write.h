/* SPDX-License-Identifier: MIT */
/* WRITE: to a device, to all targets, or as a command to the table. */
#pragma once

#include "src/daemon/serve/server.h"

void work_write(struct serve *s, struct client *c);
void work_write_target(struct serve *s, struct client *c);
void work_written(struct serve *s, struct client *c, int err);
/* The engine has said which device an alias names. */
void work_write_named(struct serve *s, struct client *c, int err);
/* The same, of an alias of the table. */
void work_write_by_id(struct serve *s, struct client *c, int err);
/* Look whether the commands of clients are carried out. */
void work_look(struct serve *s);
