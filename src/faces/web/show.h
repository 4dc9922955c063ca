/* SPDX-License-Identifier: MIT */
/* Signals of an instance as JSON of owsd-web. A value that is not good is null. */
#pragma once

#include <stdbool.h>

#include "src/faces/modbus/map.h"
#include "src/faces/show/json.h"
#include "src/faces/show/newest.h"
#include "src/public/ows.h"

struct show {
	struct ows *h;
	int64_t now_ns;
	bool live;                /* owsd is there */
	int64_t start_ns;         /* owsd's; 0: not known */
	const int *ids;           /* of outputs, and what can have alarms; else negative */
	const struct map *places; /* of Modbus; NULL: none */
};

/* An object with all that is known of the signal, but for strings that are very long. */
void show_signal(struct json *json, const struct show *show, int signal);
/*
 * [signal, value, quality code, good, age, alarm, why, commanded], without what is null at its end.
 */
void show_row(struct json *json, const struct show *show, int signal);
/* value, quality, age as members: as show_signal() has them. */
void show_value(struct json *json, const struct show *show, int signal);
/* The words for its alarms: "! high", "" if it has none. */
#define SHOW_ALARM 64
const char *show_alarm(const struct show *show, int signal, char words[SHOW_ALARM]);
/* Makes what an output reads what it was commanded. False: it does not read otherwise. */
bool show_commanded(const struct show *show, int signal, struct face_value *look);
/*
 * How far apart its measurements usually are, ns; 0: not known. A cache answers many times with
 * one: that is no older than usual then.
 */
int64_t show_interval(int64_t start_ns, const struct ows_value *v);
/* The time in milliseconds since 1970 of a boot time; 0 stays 0. */
int64_t show_wall_ms(int64_t boot_ns);

/* The addresses of Modbus that the page shows beside signals, where there is a map of them. */

/* That of owsd-modbus for the instance as it is now; NULL: there is none, or it is damaged. */
const struct map *places_of(const char *instance);
const struct map *places_at(const char *path);
/* The first register of the signal with that identity; -1: it has none. Pure. */
int places_register(const struct map *map, const char *identity);
