/* SPDX-License-Identifier: MIT */
/* From a request to its answer. */
#pragma once

#include "src/daemon/serve/server.h"

void work_begin(struct serve *s, struct client *c);
/* The engine has answered. */
void work_answered(struct serve *s, struct client *c);
/* Let clients that wait for a directory go on. */
void work_queue(struct serve *s);
