/* SPDX-License-Identifier: MIT */
/*
 * What owsd-modbus serves, and of what.
 *
 * Room src/faces/modbus: the program owsd-modbus: signals as registers of Modbus TCP.
 */
#pragma once

#include "src/faces/kit/face.h"
#include "src/faces/modbus/clients.h"
#include "src/faces/modbus/map.h"
#include "src/faces/modbus/writing.h"
#include "src/history/file/place.h"

/* What is known of the signal of a place as long as the image is the same. */
struct served {
	int id; /* as of ows_find(), if it can have an alarm; else -1 */
	uint16_t flags, decimals;
};

struct modbus {
	struct face *face;
	struct answer_source source;
	struct clients clients;
	struct writing writing;
	struct map map;
	struct served served[LAYOUT_PLACES];
	char path[MAP_PATH]; /* of the map; "": none */
	int lock;            /* of its directory; below 0: none */
	unsigned signals, decimals;
	bool known, kept; /* the map was read; it is in its file */
	int told;         /* why the one or the other is not so, as the log has it; 0: well */
	int64_t again_ns; /* when that is tried again */
	bool idle;        /* there is no block */
	uint32_t generation;
	uint16_t heart;
	int64_t changed_s; /* UTC; 0: nothing has changed yet */
	/* the request that is answered */
	int64_t now_ns;
	const struct client *client;
	bool beats;
	uint64_t refused; /* requests that are none to read */
};

int modbus_open(struct face *face);
void modbus_changes(struct face *face, const int *signals, int n);
void modbus_event(struct face *face, const struct face_event *event);
void modbus_tick(struct face *face, int64_t now_ns);
void modbus_report(struct face *face, FILE *out);
void modbus_close(struct face *face);
