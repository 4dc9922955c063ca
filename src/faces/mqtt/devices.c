/* SPDX-License-Identifier: MIT */
/* Asks owsd which devices are on its wires, and writes the list of all of them. */
#include "src/faces/mqtt/devices.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "hal/owfs/frame.h"
#include "src/faces/mqtt/plain.h"

int devices_request(unsigned char request[DEVICES_REQUEST])
{
	return frame_request(request, FRAME_DIRALL, FRAME_TRIM, 0, "/", NULL, 0);
}

char *devices_listing(char *bytes, size_t len)
{
	struct frame_header header;
	size_t at = 0;

	while (len - at >= FRAME_HEADER) {
		frame_get_header((const uint8_t *)bytes + at, &header);
		at += FRAME_HEADER;
		if (header.payload == -1) /* it is alive, and not ready */
			continue;
		if (header.type < 0 || header.payload < 0 || (size_t)header.payload > len - at)
			return NULL;
		bytes[at + (size_t)header.payload] = '\0';
		return bytes + at;
	}
	return NULL;
}

/* The id that a path of one device has; false: it names none, as "/simultaneous". */
static bool id_of(const char *path, char id[ROM_TEXT_MAX], char family[3])
{
	struct path split;

	if (path_split(path, strlen(path), &split) || !split.has_rom || split.property.len)
		return false;
	rom_print(split.rom, ROM_F_I, id);
	snprintf(family, 3, "%.2s", id);
	return true;
}

static void put_target(struct json *json, const struct stream *s, int index)
{
	struct ows_target target;
	bool known = index >= 0 && !ows_target(s->h, index, &target);

	json_string(json, "target", known ? target.name : NULL);
}

/* Its rows stand together, if it was no other chip when they began. */
static void put_signals(struct json *json, const struct stream *s, const char *device)
{
	const struct row *row = NULL;

	json_array(json, "signals");
	for (int i = 0; i < s->count; i++)
		if (!strcmp(s->rows[i].info.device, device)) {
			row = &s->rows[i];
			json_string(json, NULL, row->name);
		}
	json_array_end(json);
	if (!row)
		return;
	json_bytes(json, "path", row->info.path,
	           (size_t)(strstr(row->info.path, device) - row->info.path) + strlen(device));
	if (row->chip < 0)
		return;
	json_string(json, TOPIC_CHIP, row->chip_id);
	json_string(json, "state", plain_chip_word(s, &s->chips[row->chip]));
}

/* One that signals name. Its id is that of the part that is there now. */
static void put_known(struct json *json, const struct stream *s, const struct ows_device *device)
{
	char id[ROM_TEXT_MAX], family[3];

	if (!id_of(device->id, id, family))
		return;
	json_object(json, NULL);
	json_string(json, "id", id);
	json_string(json, "family", family);
	json_string(json, "type", *device->family ? device->family : NULL);
	put_target(json, s, device->target);
	put_signals(json, s, device->id);
	json_object_end(json);
}

static bool is_known(const struct stream *s, const char *id)
{
	struct ows_device device;
	char one[ROM_TEXT_MAX], family[3];

	for (int i = 0; !ows_device(s->h, i, &device); i++)
		if (id_of(device.id, one, family) && !strcmp(one, id))
			return true;
	return false;
}

/* One that was found, and no signal names. Of several targets nothing says which has it. */
static void put_found(struct json *json, const struct stream *s, const char *path)
{
	char id[ROM_TEXT_MAX], family[3];
	struct ows_target second;

	if (!id_of(path, id, family) || is_known(s, id))
		return;
	json_object(json, NULL);
	json_string(json, "id", id);
	json_string(json, "family", family);
	put_target(json, s, ows_target(s->h, 1, &second) ? 0 : -1);
	json_array(json, "signals");
	json_array_end(json);
	json_string(json, "path", path);
	json_object_end(json);
}

void devices_json(struct json *json, const struct stream *s, char *listing)
{
	struct ows_device device;
	char *rest;

	json_array(json, "devices");
	for (int i = 0; !ows_device(s->h, i, &device); i++)
		put_known(json, s, &device);
	for (char *path = listing ? strtok_r(listing, ",", &rest) : NULL; path;
	     path = strtok_r(NULL, ",", &rest))
		put_found(json, s, path);
	json_array_end(json);
}
