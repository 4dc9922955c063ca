/* SPDX-License-Identifier: MIT */
/* Requests to the engine: the path, the target, and the step that follows the answer. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "hal/owfs/frame.h"
#include "src/daemon/serve/answer.h"
#include "src/daemon/serve/client.h"
#include "src/daemon/serve/units.h"
#include "src/daemon/serve/work_ask.h"
#include "src/memory/shm/word.h"

/* So many bytes of a memory are given the time of a request. */
enum { READ_PART = 1024, WRITE_PART = 256 };

/* Do the targets have the same numbers as when the server asked the engine? */
bool work_same_targets(const struct serve *s, const struct client *c)
{
	return c->guest.generation == s->image->header->generation;
}

static bool is_up(const struct serve *s, unsigned target)
{
	return word_get(&s->image->targets[target].state) == 1;
}

/*
 * A memory of some kilobytes takes longer than any other value: that of a DS1977 more than a minute
 * to read, that of a DS1996 half a minute.
 */
static uint16_t parts(const struct client *c, enum client_step step, uint32_t len)
{
	if (step == STEP_READ)
		return (uint16_t)(1 + c->node.bytes / READ_PART);
	if (step == STEP_WRITE && c->node.bytes)
		return (uint16_t)(1 + len / WRITE_PART);
	return 1;
}

void work_ask(struct serve *s, struct client *c, enum client_step step, enum bus_op op, int lane,
              uint8_t *data, uint32_t len)
{
	c->step = (uint8_t)step;
	c->guest = (struct engine_guest){.op = (uint8_t)op,
	                                 .fresh = c->node.fresh,
	                                 .lane = lane,
	                                 .generation = s->image->header->generation,
	                                 .path = c->path,
	                                 .data = data,
	                                 .len = len,
	                                 .parts = parts(c, step, len),
	                                 .offset = op == BUS_WRITE ? (uint32_t)c->request.offset
	                                                           : 0,
	                                 .tokens = c->passed.bytes,
	                                 .token_count = c->passed.count};
	count(s, COUNT_bus_requests, 1);
	if (c->state != CLIENT_WORKING)
		client_enter(s, c, CLIENT_WORKING);
	guests_ask(&s->guests, &c->guest);
}

/* Write the path with the bus number of the target; returns the lane that has to answer. */
static int target_path(struct serve *s, struct client *c, int len, const char *property)
{
	const struct node *node = &c->node;

	if (node->bus < 0) {
		snprintf(c->path, sizeof(c->path), "%.*s%s", len, node->path, property);
		return GUEST_ANY_LANE;
	}
	snprintf(c->path, sizeof(c->path), "/bus.%u%.*s%s", s->buses.bus[node->bus].number,
	         node->path[1] ? len : 0, node->path, property);
	return s->buses.bus[node->bus].target;
}

int work_path(struct serve *s, struct client *c)
{
	return target_path(s, c, (int)strlen(c->node.path), "");
}

int work_device_path(struct serve *s, struct client *c, const char *property)
{
	return target_path(s, c, c->node.device_len, property);
}

/* Skip the targets that are down, for a directory to which each target adds its part. */
void work_next_target(struct serve *s, struct client *c)
{
	while (c->target < s->config->target_count && !is_up(s, c->target))
		c->target++;
}

bool work_is_directory(const struct node *node)
{
	return node->slash || node->devices || node->kind == NODE_SIGNALS ||
	       node->kind == NODE_CODES || (node->has_device && !node->path[node->device_len]);
}

void work_refuse_directory(struct serve *s, struct client *c)
{
	if (c->node.kind == NODE_TARGET && !c->node.devices &&
	    (c->node.has_device || c->node.slash))
		work_ask(s, c, STEP_REFUSE, BUS_PROBE, work_path(s, c), NULL, 0);
	else
		answer_error(s, c, -EISDIR);
}

/* --- The type of a property that the server does not know, to convert its units --------------- */

static uint8_t *type_room(struct client *c)
{
	return c->request.type == FRAME_WRITE ? client_room(c) : client_room(c) + c->value_len;
}

static void ask_structure(struct serve *s, struct client *c, uint8_t family)
{
	snprintf(c->path, sizeof(c->path), "/structure/%02X%s", family,
	         c->node.path + c->node.device_len);
	work_ask(s, c, STEP_STRUCTURE, BUS_READ, GUEST_ANY_LANE, type_room(c), WORK_TYPE_MOST);
}

bool work_ask_type(struct serve *s, struct client *c)
{
	const struct node *node = &c->node;

	if (node->type || !node->has_device || !units_asked(c->request.flags))
		return false;
	if (node->has_rom) {
		ask_structure(s, c, node->rom[0]);
	} else {
		work_ask(s, c, STEP_FAMILY, BUS_READ, work_device_path(s, c, "/family"),
		         type_room(c), WORK_TYPE_MOST);
	}
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
			if (!like.type) {
				ask_structure(s, c, rom[0]);
				return false;
			}
		}
	}
	if (!c->node.type)
		answer_error(s, c, -EIO);
	return c->node.type != 0;
}
