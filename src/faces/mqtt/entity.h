/* SPDX-License-Identifier: MIT */
/* A signal as a component of Home Assistant's discovery by device: tables of kinds and classes. */
#pragma once

#include "src/faces/mqtt/stream.h"

#define ENTITY_ID 128

/* What Home Assistant makes of a signal. */
enum entity_kind {
	ENTITY_SENSOR,
	ENTITY_BINARY,
	ENTITY_SWITCH,
	ENTITY_NUMBER,
	ENTITY_LIGHT,
	ENTITY_COVER,
	ENTITY_TEXT,
};
/*
 * class: of the item; write: commands are taken. A number is a light or a cover when Min and Max
 * give what "on" and "off" are. Pure.
 */
enum entity_kind entity_kind(const struct ows_info *info, const char *class, bool write);

/* The least and the greatest value: of the configuration, else of the type. Not of strings. */
void entity_range(const struct ows_info *info, double *least, double *most);

/*
 * Write the components of a row: the signal itself, its limit alarm, its events, its key. owner
 * begins the unique ids; alone: the device has no other signal, and gives its name.
 */
void entity_json(struct json *json, const struct stream *s, const struct row *row,
                 const char *owner, bool alone);
/* The component of a chip that says whether something is wrong with it. */
void entity_problem_json(struct json *json, const struct stream *s, const struct chip *chip,
                         const char *owner);
/* Who makes a device of that family: "DS18B20"; NULL: not known. Pure. */
const char *entity_maker(const char *family);
/* The device of a message: the node, or a chip, which is behind the node. */
void entity_device_json(struct json *json, const struct stream *s, const struct chip *chip,
                        const char *name);
/* The member avty: topics that all have to be online. */
void entity_available_json(struct json *json, const struct stream *s, const struct chip *chip);
