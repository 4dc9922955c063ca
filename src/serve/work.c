/* SPDX-License-Identifier: MIT */
/*
 * From a request to its answer: what its path means, what is known here, what the engine is asked
 * for, one step after another, and what the client gets.
 */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "hal/owfs/frame.h"
#include "src/serve/work.h"
#include "src/shm/word.h"

/* --- Answers ---------------------------------------------------------------------------------- */

/* payload bytes are in client_room(). */
static void answer_data(struct serve *s, struct client *c, int32_t ret, uint32_t payload,
                        uint32_t size, int32_t offset)
{
	struct frame_header h = {.payload = (int32_t)payload,
	                         .type = ret,
	                         .flags = c->request.flags,
	                         .size = (int32_t)size,
	                         .offset = offset};
	uint8_t *data = client_room(c);

	if (ret < 0)
		count(s, COUNT_errors, 1);
	frame_put_header(data - FRAME_HEADER, &h);
	client_send(s, c, data - FRAME_HEADER, FRAME_HEADER + payload);
}

void answer_code(struct serve *s, struct client *c, int32_t code)
{
	answer_data(s, c, code, 0, 0, 0);
}

void answer_error(struct serve *s, struct client *c, int err)
{
	answer_code(s, c, code_of(err));
}

/* len bytes of value are in the room: the part that the client wants. */
void answer_value(struct serve *s, struct client *c, uint32_t len)
{
	uint32_t offset = (uint32_t)c->request.offset, size = (uint32_t)c->request.size;
	uint8_t *data = client_room(c);

	if (c->request.offset < 0 || offset >= len) {
		answer_data(s, c, 0, 0, 0, 0);
		return;
	}
	len -= offset;
	if (size < len)
		len = size;
	if (offset)
		memmove(data, data + offset, len);
	answer_data(s, c, (int32_t)len, len, len, (int32_t)offset);
}

void answer_written(struct serve *s, struct client *c, uint32_t taken)
{
	answer_data(s, c, 0, 0, taken, 0);
}

/* --- The engine ------------------------------------------------------------------------------- */

/* Targets are counted now as they were when the engine was asked. */
bool work_same_targets(const struct serve *s, const struct client *c)
{
	return c->guest.generation == s->image->header->generation;
}

unsigned work_targets(const struct serve *s)
{
	return s->config->target_count;
}

static bool is_up(const struct serve *s, unsigned target)
{
	return word_get(&s->image->targets[target].state) == 1;
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
	                                 .offset = op == BUS_WRITE ? (uint32_t)c->request.offset
	                                                           : 0,
	                                 .tokens = c->via.tokens,
	                                 .token_count = c->via.count};
	count(s, COUNT_bus_requests, 1);
	if (c->state != CLIENT_WORKING)
		client_enter(s, c, CLIENT_WORKING);
	guests_ask(&s->guests, &c->guest);
}

/* The path as the target counts its buses; the lane that has to answer. */
int work_path(struct serve *s, struct client *c)
{
	const struct node *node = &c->node;

	if (node->bus < 0) {
		snprintf(c->path, sizeof(c->path), "%s", node->path);
		return GUEST_ANY_LANE;
	}
	snprintf(c->path, sizeof(c->path), "/bus.%u%s", s->buses.bus[node->bus].number,
	         node->path[1] ? node->path : "");
	return s->buses.bus[node->bus].target;
}

/* A property of the device. */
void work_device_path(struct client *c, const char *property)
{
	snprintf(c->path, sizeof(c->path), "%.*s%s", (int)c->node.device_len, c->node.path,
	         property);
}

/* Of a directory that each target has a part of: the next one that is up. */
void work_next_target(struct serve *s, struct client *c)
{
	while (c->target < work_targets(s) && !is_up(s, c->target))
		c->target++;
}

bool work_is_directory(const struct node *node)
{
	return node->slash || node->devices || node->kind == NODE_SIGNALS ||
	       node->kind == NODE_CODES || (node->has_device && !node->path[node->device_len]);
}

/* --- Presence --------------------------------------------------------------------------------- */

static void reply_id(struct serve *s, struct client *c, const uint8_t rom[ROM_LEN])
{
	memcpy(client_room(c), rom, ROM_LEN);
	answer_data(s, c, 0, ROM_LEN, 0, 0);
}

static void begin_present(struct serve *s, struct client *c)
{
	static const uint8_t none[ROM_LEN];
	const struct node *node = &c->node;

	if (node->kind == NODE_SIGNAL && !signals_has(s->signals, node->name))
		answer_error(s, c, -ENOENT);
	else if (node->kind != NODE_TARGET || node->devices)
		reply_id(s, c, none);
	else
		work_ask(s, c, STEP_PROBE, BUS_PROBE, work_path(s, c), NULL, 0);
}

static void present_answered(struct serve *s, struct client *c, int err)
{
	uint8_t rom[ROM_LEN];

	if (err) {
		answer_error(s, c, err);
	} else if (c->step == STEP_ADDRESS) {
		if (rom_parse((const char *)client_room(c), c->guest.answer.len, rom))
			answer_error(s, c, -EIO);
		else
			reply_id(s, c, rom);
	} else if (c->node.has_device && !c->node.has_rom) {
		work_device_path(c, "/address");
		work_ask(s, c, STEP_ADDRESS, BUS_READ, GUEST_ANY_LANE, client_room(c), 64);
	} else {
		reply_id(s, c, c->node.rom);
	}
}

/* --- Beginning and end ------------------------------------------------------------------------ */

static void begin_get(struct serve *s, struct client *c)
{
	c->is_get = true;
	if (work_is_directory(&c->node))
		work_want_directory(s, c, STEP_DIR);
	else
		work_read(s, c);
}

static void begin_dir(struct serve *s, struct client *c)
{
	if (c->node.kind == NODE_SIGNAL)
		answer_error(s, c, signals_has(s->signals, c->node.name) ? -ENOTDIR : -ENOENT);
	else if (c->node.kind == NODE_CODE)
		answer_error(s, c, -ENOTDIR);
	else
		work_want_directory(s, c, STEP_DIR);
}

/* With the path understood, and its bus known. */
void work_go_on(struct serve *s, struct client *c)
{
	if (c->node.bus >= 0 && (unsigned)c->node.bus >= s->buses.count) {
		if (c->once_more) {
			answer_error(s, c, -ENODEV);
			return;
		}
		c->once_more = true;
		work_want_directory(s, c, STEP_BUSES);
		return;
	}
	c->target = 0;
	c->worst = WORK_NOT_YET;
	switch ((enum frame_type)c->request.type) {
	case FRAME_READ:
		work_read(s, c);
		return;
	case FRAME_WRITE:
		work_write(s, c);
		return;
	case FRAME_PRESENT:
		begin_present(s, c);
		return;
	case FRAME_DIR:
	case FRAME_DIRALL:
	case FRAME_DIRALLSLASH:
		begin_dir(s, c);
		return;
	case FRAME_GET:
	case FRAME_GETSLASH:
		begin_get(s, c);
		return;
	case FRAME_NOP:
		break;
	}
	answer_code(s, c, 0);
}

/* What this server has was asked for when the request was here first; behind it there is no more. */
static void came_round(struct serve *s, struct client *c)
{
	bool lists = c->request.type != FRAME_READ && c->request.type != FRAME_WRITE &&
	             c->request.type != FRAME_PRESENT;

	count(s, COUNT_came_round, 1);
	if (lists && work_is_directory(&c->node))
		answer_code(s, c, 0);
	else
		answer_error(s, c, -ENODEV);
}

static bool is_known(int32_t type)
{
	return type == FRAME_NOP || (type >= FRAME_READ && type <= FRAME_DIR) ||
	       (type >= FRAME_PRESENT && type <= FRAME_GETSLASH);
}

/* A slash behind a property of a device, as far as its family is known. */
static bool is_no_directory(const struct node *node)
{
	return node->slash && node->has_device && node->path[node->device_len] &&
	       node->type != PROPERTY_DIRECTORY;
}

void work_begin(struct serve *s, struct client *c)
{
	const struct request *r = &c->request;
	bool lists = r->type != FRAME_READ && r->type != FRAME_WRITE;

	c->directory = NULL;
	c->is_get = c->once_more = false;
	if (!is_known(r->type)) {
		answer_code(s, c, CODE_BAD_TYPE);
		return;
	}
	if (r->type == FRAME_NOP) {
		answer_code(s, c, 0);
		return;
	}
	if (r->payload == 0) {
		answer_code(s, c, CODE_EMPTY);
		return;
	}
	node_parse(r->path, r->path_len, &c->node);
	c->node.fresh |= (r->flags & FRAME_UNCACHED) != 0;
	if (r->token_count && via_came_round(r->tokens, r->token_count, s->token)) {
		came_round(s, c);
		return;
	}
	via_pass(&c->via, r->tokens, r->token_count, s->token);
	if (c->node.kind == NODE_NONE || (!lists && is_no_directory(&c->node)))
		answer_error(s, c, -ENOENT);
	else
		work_go_on(s, c);
}

void work_answered(struct serve *s, struct client *c)
{
	int err = c->guest.answer.err;

	/* what is lent is not looked into; the answer needs a header's room only */
	if (c->lent && !err)
		err = -EIO;
	switch ((enum client_step)c->step) {
	case STEP_READ:
		work_read_answered(s, c, err);
		return;
	case STEP_WRITE:
	case STEP_WRITE_EACH:
		work_written(s, c, err);
		return;
	case STEP_DIR:
	case STEP_BUSES:
		work_listed(s, c, err);
		return;
	case STEP_REFUSE:
		answer_error(s, c, err ? err : -EISDIR);
		return;
	case STEP_PROBE:
	case STEP_ADDRESS:
		present_answered(s, c, err);
		return;
	case STEP_FAMILY:
	case STEP_STRUCTURE:
		work_typed(s, c, err);
		return;
	}
}

void work_end(struct serve *s, struct client *c)
{
	if (!c->directory || c->lent)
		return;
	work_release(s, c->directory);
	c->directory = NULL;
}
