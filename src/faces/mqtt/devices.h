/* SPDX-License-Identifier: MIT */
/* The list of devices: those that signals name, and those that are on the wires besides. */
#pragma once

#include <stddef.h>

#include "src/faces/mqtt/stream.h"

/* The request for what is on the wires, at owsd's served protocol. Returns its length. */
#define DEVICES_REQUEST 32
int devices_request(unsigned char request[DEVICES_REQUEST]);
/*
 * The list in an answer to that: paths with commas between them. bytes has NUL behind len bytes,
 * and is changed. NULL: it is none. Pure.
 */
char *devices_listing(char *bytes, size_t len);
/* The array "devices". listing: as above, NULL if it is not known; it is changed. */
void devices_json(struct json *json, const struct stream *s, char *listing);
