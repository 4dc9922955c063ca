/* SPDX-License-Identifier: MIT */
/* The faces of an instance, by the reports that they write (src/faces/kit/loop.c). */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "src/faces/show/json.h"
#include "src/faces/show/when.h"

#define FACES_MOST 8
#define FACES_COUNTERS 16

struct faces_counter {
	char name[32];
	uint64_t value;
};
struct faces_one {
	char program[32];
	long pid;
	int64_t beat_ns;   /* the boot time of the report */
	int64_t since_ns;  /* of its connection; 0: none */
	int64_t loaded_ns; /* the boot time at which it read its configuration; 0: not known */
	char refused[256]; /* why that one is refused, and the one before counts; "": it counts */
	char status[256];
	char trouble[256];  /* the last one; "": none */
	int64_t trouble_ns; /* its boot time; 0: not known */
	struct faces_counter counters[FACES_COUNTERS];
	unsigned count;
};

/* Those whose reports this user may read, by name. Returns how many. Texts are printable. */
unsigned faces_read(const char *instance, struct faces_one faces[FACES_MOST]);
/* Has the face been silent for too long? */
bool faces_silent(const struct faces_one *face, int64_t now_ns);
/* All of them as an array. */
void faces_json(struct json *json, const char *key, const char *instance, const struct when *now);
