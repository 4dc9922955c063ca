/* SPDX-License-Identifier: MIT */
/*
 * From a request to its answer: the meaning of its path, what the server knows by itself, what it
 * asks the engine, step by step, and what the client gets.
 */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "hal/owfs/frame.h"
#include "src/daemon/serve/answer.h"
#include "src/daemon/serve/client.h"
#include "src/daemon/serve/units.h"
#include "src/daemon/serve/work.h"
#include "src/daemon/serve/work_ask.h"
#include "src/daemon/serve/work_directory.h"
#include "src/daemon/serve/work_write.h"

/* --- READ: values from the server itself or from a bus, in the units of the client ----------- */

/* The largest READ that a client may ask for. */
#define READ_MOST 100050

/* Convert the value in the room from the bus's units into the client's, and send it. */
static void work_show(struct serve *s, struct client *c)
{
	int n = units_show(c->node.type, c->request.flags, (char *)client_room(c), c->value_len,
	                   client_room_size(c));

	if (n < 0)
		answer_error(s, c, n);
	else
		answer_value(s, c, (uint32_t)n);
}

static void work_read_answered(struct serve *s, struct client *c, int err)
{
	if (err) {
		if (c->is_get && !c->lent && (err == -EISDIR || err == -ENOENT))
			work_want_directory(s, c, STEP_DIR);
		else
			answer_error(s, c, err);
		return;
	}
	c->value_len = c->guest.answer.len;
	kept_add(s->kept, &c->node, c->guest.answer.measured_ns, client_room(c), c->value_len);
	if (c->value_len > client_room_size(c) - WORK_TYPE_MOST && !c->node.type &&
	    units_asked(c->request.flags))
		answer_error(s, c, -EMSGSIZE);
	else if (!work_ask_type(s, c))
		work_show(s, c);
}

static void read_target(struct serve *s, struct client *c)
{
	int n = -ENOENT;

	/* two servers that ask each other would renew what they keep for ever */
	if (!(s->passes_on && c->request.token_count) && !c->node.fresh &&
	    !(c->request.flags & FRAME_UNCACHED))
		n = kept_find(s->kept, s->image, &c->node, s->now_ns, (char *)client_room(c),
		              client_room_size(c));
	if (n >= 0) {
		count(s, COUNT_kept_answers, 1);
		c->value_len = (uint32_t)n;
		work_show(s, c);
		return;
	}
	work_ask(s, c, STEP_READ, BUS_READ, work_path(s, c), client_room(c), client_room_size(c));
}

/* A server asks for a signal that is an item of another owsd: that server may be that owsd. */
static bool is_passed_on(const struct serve *s, const struct client *c)
{
	int record = c->request.token_count && s->passes_on
	                     ? signals_record(s->signals, c->node.name)
	                     : -1;
	struct node node;

	if (record < 1 || (unsigned)record > s->config->item_count)
		return false;
	node_parse(s->config->items[record - 1].path, strlen(s->config->items[record - 1].path),
	           &node);
	return node.kind == NODE_SIGNAL;
}

static void read_here(struct serve *s, struct client *c)
{
	char *room = (char *)client_room(c);
	int n;

	if (c->node.kind == NODE_SIGNAL && is_passed_on(s, c)) {
		n = -ELOOP;
	} else if (c->node.kind == NODE_SIGNAL) {
		n = signals_read(s->signals, c->node.name, s->now_ns, room, client_room_size(c));
	} else if (c->node.code < 0) {
		n = code_texts(room, client_room_size(c));
	} else {
		n = snprintf(room, client_room_size(c), "%s", code_text((unsigned)c->node.code));
	}
	if (n < 0)
		answer_error(s, c, n);
	else
		answer_value(s, c, (uint32_t)n);
}

static void work_read(struct serve *s, struct client *c)
{
	if (c->request.size <= 0 || c->request.size > READ_MOST) {
		answer_code(s, c, CODE_BAD_SIZE);
		return;
	}
	if (c->node.kind == NODE_SIGNAL || c->node.kind == NODE_CODE)
		read_here(s, c);
	else if (work_is_directory(&c->node))
		work_refuse_directory(s, c);
	else
		read_target(s, c);
}

/* --- Presence -------------------------------------------------------------------------------- */

static void begin_present(struct serve *s, struct client *c)
{
	static const uint8_t none[ROM_LEN];
	const struct node *node = &c->node;

	if (node->kind == NODE_SIGNAL && signals_record(s->signals, node->name) < 0)
		answer_error(s, c, -ENOENT);
	else if (node->kind != NODE_TARGET || node->devices)
		answer_id(s, c, none);
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
			answer_id(s, c, rom);
	} else if (c->node.has_device && !c->node.has_rom) {
		work_ask(s, c, STEP_ADDRESS, BUS_READ, work_device_path(s, c, "/address"),
		         client_room(c), 64);
	} else {
		answer_id(s, c, c->node.rom);
	}
}

/* --- Beginning and end ----------------------------------------------------------------------- */

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
		answer_error(s, c,
		             signals_record(s->signals, c->node.name) < 0 ? -ENOENT : -ENOTDIR);
	else if (c->node.kind == NODE_CODE)
		answer_error(s, c, -ENOTDIR);
	else
		work_want_directory(s, c, STEP_DIR);
}

/* The path is understood, and its bus is known: work on the request. */
static void go_on(struct serve *s, struct client *c)
{
	while (c->node.bus >= 0 && (unsigned)c->node.bus >= s->buses.count) {
		if (c->once_more) {
			answer_error(s, c, -ENODEV);
			return;
		}
		c->once_more = true;
		if (!work_want_directory(s, c, STEP_BUSES))
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

/* The request was here before, and this server asked its targets then: nothing is left to ask. */
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

/* The path has a slash after a property of a device whose family knows it as no directory. */
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
	if (r->token_count && tokens_came_round(r->tokens, r->token_count, s->token)) {
		came_round(s, c);
		return;
	}
	tokens_pass(&c->passed, r->tokens, r->token_count, s->token);
	if (c->node.kind == NODE_NONE || (!lists && is_no_directory(&c->node)))
		answer_error(s, c, -ENOENT);
	else
		go_on(s, c);
}

static void type_known(struct serve *s, struct client *c)
{
	if (c->request.type == FRAME_WRITE)
		work_write_target(s, c);
	else
		work_show(s, c);
}

void work_answered(struct serve *s, struct client *c)
{
	int err = c->guest.answer.err;

	/*
	 * a bus still uses the memory: the server does not read it, and answers with a header alone
	 */
	if (c->lent && !err)
		err = -EIO;
	/* The device is gone: what was read of it before answers no client. */
	if (err == -ENODEV && c->node.has_rom)
		kept_forget(s->kept, &c->node, s->now_ns);
	switch ((enum client_step)c->step) {
	case STEP_READ:
		work_read_answered(s, c, err);
		return;
	case STEP_WRITE:
	case STEP_WRITE_EACH:
		work_written(s, c, err);
		return;
	case STEP_WHOSE:
		work_write_named(s, c, err);
		return;
	case STEP_ALIAS:
		work_write_by_id(s, c, err);
		return;
	case STEP_DIR:
	case STEP_BUSES:
		if (work_listed(s, c, err))
			go_on(s, c);
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
		if (work_typed(s, c, err))
			type_known(s, c);
		return;
	}
}

void work_queue(struct serve *s)
{
	for (int i = 0; i < SERVER_DIRECTORIES; i++) {
		bool ended;
		struct client *c = work_unqueue(s, &ended);

		if (!c)
			return;
		if (ended)
			go_on(s, c);
	}
}
