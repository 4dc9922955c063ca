/* SPDX-License-Identifier: MIT */
/* Asks a target for the type of a property that the server does not know, to convert its units. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "hal/owfs/frame.h"
#include "src/daemon/serve/answer.h"
#include "src/daemon/serve/client.h"
#include "src/daemon/serve/units.h"
#include "src/daemon/serve/work_ask.h"
#include "src/daemon/serve/work_type.h"

bool work_ask_type(struct serve *s, struct client *c)
{
	const struct node *node = &c->node;
	uint8_t *room = c->request.type == FRAME_WRITE ? client_room(c)
	                                               : client_room(c) + c->value_len;

	if (node->type || !node->has_device || !units_asked(c->request.flags))
		return false;
	if (!node->has_rom) {
		work_device_path(c, "/family");
		work_ask(s, c, STEP_FAMILY, BUS_READ, GUEST_ANY_LANE, room, 64);
		return true;
	}
	snprintf(c->path, sizeof(c->path), "/structure/%02X%s", node->rom[0],
	         node->path + node->device_len);
	work_ask(s, c, STEP_STRUCTURE, BUS_READ, GUEST_ANY_LANE, room, 64);
	return true;
}

bool work_typed(struct serve *s, struct client *c, int err)
{
	const uint8_t *text = c->guest.data;
	uint8_t rom[ROM_LEN] = {0};
	char path[NODE_PATH_MAX];

	if (err) {
		answer_error(s, c, err);
		return false;
	}
	if (c->step == STEP_STRUCTURE) {
		c->node.type = c->guest.answer.len ? (char)text[0] : 'a';
	} else {
		/* the type is that of a device of this family */
		for (int i = 0; i < 2 && c->guest.answer.len == 2; i++)
			rom[0] = (uint8_t)(rom[0] * 16 + (text[i] & 0xf) +
			                   (text[i] >= 'A' ? 9 : 0));
		if (rom[0]) {
			struct node like;
			char id[ROM_TEXT_MAX];

			rom_print(rom, ROM_F_I, id);
			snprintf(path, sizeof(path), "/%s%s", id,
			         c->node.path + c->node.device_len);
			node_parse(path, strlen(path), &like);
			c->node.type = like.type;
			c->node.has_rom = true;
			memcpy(c->node.rom, rom, ROM_LEN);
			if (!like.type && work_ask_type(s, c))
				return false;
		}
	}
	if (!c->node.type)
		answer_error(s, c, -EIO);
	return c->node.type != 0;
}
