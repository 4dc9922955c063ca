/* SPDX-License-Identifier: MIT */
/* Answers of the served protocol, made in a client's area and sent. */
#pragma once

#include "hal/owfs/path.h"
#include "src/daemon/serve/server.h"

void answer_code(struct serve *s, struct client *c, int32_t code);
/* Answer a negative errno. */
void answer_error(struct serve *s, struct client *c, int err);
/* Answer the part of the value that the client wants; len bytes of value are in client_room(). */
void answer_value(struct serve *s, struct client *c, uint32_t len);
void answer_written(struct serve *s, struct client *c, uint32_t taken);
void answer_id(struct serve *s, struct client *c, const uint8_t rom[ROM_LEN]);
