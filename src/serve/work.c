/* SPDX-License-Identifier: MIT */
/*
 * From a request to its answer: what its path means, what is known here, what the engine is asked
 * for, one step after another, and what the client gets.
 */
#include "server.h"
#include "units.h"

#include "../shm/word.h"
#include "hal/native/format.h"
#include "hal/owserver/frame.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

/* The largest READ that a client may ask for. */
#define READ_MOST 100050
#define NOT_YET   1

/* --- Answers ---------------------------------------------------------------------------------- */

static void reply(struct serve *s, struct client *c, int32_t ret, uint32_t payload, uint32_t size,
                  int32_t offset)
{
	struct frame_header h = { .payload = (int32_t)payload, .type = ret,
		                  .flags = c->request.flags, .size = (int32_t)size,
		                  .offset = offset };
	uint8_t *data = client_room(c);

	if (ret < 0)
		count(s, COUNT_errors, 1);
	frame_put_header(data - FRAME_HEADER, &h);
	client_send(s, c, data - FRAME_HEADER, FRAME_HEADER + payload);
}

static void reply_code(struct serve *s, struct client *c, int32_t code)
{
	reply(s, c, code, 0, 0, 0);
}

static void reply_error(struct serve *s, struct client *c, int err)
{
	reply_code(s, c, code_of(err));
}

/* len bytes of value are in the room: the part that the client wants. */
static void reply_value(struct serve *s, struct client *c, uint32_t len)
{
	uint32_t offset = (uint32_t)c->request.offset, size = (uint32_t)c->request.size;
	uint8_t *data = client_room(c);

	if (c->request.offset < 0 || offset >= len) {
		reply(s, c, 0, 0, 0, 0);
		return;
	}
	len -= offset;
	if (size < len)
		len = size;
	if (offset)
		memmove(data, data + offset, len);
	reply(s, c, (int32_t)len, len, len, (int32_t)offset);
}

static void reply_written(struct serve *s, struct client *c, uint32_t taken)
{
	reply(s, c, 0, 0, taken, 0);
}

/* --- The engine ------------------------------------------------------------------------------- */

static unsigned targets(const struct serve *s)
{
	return s->config->target_count;
}

static bool is_up(const struct serve *s, unsigned target)
{
	return word_get(&s->image->targets[target].state) == 1;
}

static void ask(struct serve *s, struct client *c, enum client_step step, enum bus_op op, int lane,
                uint8_t *data, uint32_t len)
{
	c->step = (uint8_t)step;
	c->guest = (struct engine_guest){ .op = (uint8_t)op, .fresh = c->node.fresh, .lane = lane,
		                          .path = c->path, .data = data, .len = len };
	count(s, COUNT_bus_requests, 1);
	if (c->state != CLIENT_WORKING)
		client_enter(s, c, CLIENT_WORKING);
	guests_ask(&s->guests, &c->guest);
}

/* The path as the target counts its buses; the lane that has to answer. */
static int lane_path(struct serve *s, struct client *c)
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
static void set_path(struct client *c, const char *property)
{
	snprintf(c->path, sizeof(c->path), "%.*s%s", (int)c->node.device_len, c->node.path,
	         property);
}

/* --- Listings --------------------------------------------------------------------------------- */

static void ask_target(struct serve *s, struct client *c);
static void begin(struct serve *s, struct client *c);

/* Of a directory that each target has a part of: the next one that is up. */
static void next_target(struct serve *s, struct client *c)
{
	while (c->target < targets(s) && !is_up(s, c->target))
		c->target++;
}

static void form_directory(struct serve *s, struct client *c)
{
	struct directory_form form = {
		.node = &c->node, .prefix = c->request.path, .prefix_len = c->request.path_len,
		.flags = c->request.flags, .frames = c->request.type == FRAME_DIR,
		.slash = c->request.type == FRAME_DIRALLSLASH || c->request.type == FRAME_GETSLASH,
	};
	int err;

	while (form.prefix_len && form.prefix[form.prefix_len - 1] == '/')
		form.prefix_len--;
	if (c->node.root && c->request.flags & FRAME_BUS_LIST)
		directory_add_rest(c->directory, &c->node, &s->buses);
	err = directory_form(c->directory, &form);
	if (err)
		reply_error(s, c, err);
	else
		client_send(s, c, c->directory->out, c->directory->out_len);
}

static void listed(struct serve *s, struct client *c)
{
	if (c->step == STEP_BUSES) {
		s->buses_known = true;
		work_release(s, c->directory);
		c->directory = NULL;
		begin(s, c);
	} else if (c->worst < 0) {
		reply_error(s, c, c->worst);
	} else {
		form_directory(s, c);
	}
}

static void ask_target(struct serve *s, struct client *c)
{
	bool buses = c->step == STEP_BUSES, every = buses || c->node.every;
	int lane = GUEST_ANY_LANE;
	uint32_t room;
	uint8_t *to;

	if (every) {
		next_target(s, c);
		if (c->target >= targets(s)) {
			if (c->worst == NOT_YET)
				c->worst = -ENOTCONN;
			listed(s, c);
			return;
		}
		lane = (int)c->target;
		snprintf(c->path, sizeof(c->path), "%s", buses ? "/" : c->node.path);
	} else {
		lane = lane_path(s, c);
	}
	to = directory_room(c->directory, &room);
	ask(s, c, buses ? STEP_BUSES : STEP_DIR, BUS_DIR, lane, to, room);
}

void work_directory(struct serve *s, struct client *c, struct directory *directory)
{
	c->directory = directory;
	directory->used = true;
	directory_begin(directory);
	c->target = 0;
	c->worst = NOT_YET;
	if (c->node.kind == NODE_SIGNALS && c->step != STEP_BUSES) {
		c->worst = signals_list(s->signals, directory) ? 0 : -EMSGSIZE;
		listed(s, c);
		return;
	}
	if (c->node.kind == NODE_CODES && c->step != STEP_BUSES) {
		char name[16];

		directory_add(directory, "text.ALL", 8);
		for (unsigned i = 0; i < CODE_COUNT; i++)
			directory_add(directory, name, (size_t)snprintf(name, sizeof(name), "text.%u", i));
		c->worst = 0;
		listed(s, c);
		return;
	}
	ask_target(s, c);
}

static void want_directory(struct serve *s, struct client *c, enum client_step step)
{
	c->step = (uint8_t)step;
	for (int i = 0; i < SERVER_DIRECTORIES; i++) {
		if (s->directories[i].used)
			continue;
		work_directory(s, c, &s->directories[i]);
		return;
	}
	s->queued++;
	client_enter(s, c, CLIENT_QUEUED);
}

void work_release(struct serve *s, struct directory *directory)
{
	struct client *next = NULL;

	directory->used = false;
	if (!s->queued)
		return;
	for (unsigned i = 0; i < s->used; i++) {
		struct client *c = &s->clients[i];

		if (c->state == CLIENT_QUEUED && (!next || c->since_ns < next->since_ns))
			next = c;
	}
	if (!next)
		return;
	s->queued--;
	next->state = CLIENT_READING; /* until it is in its next state, a line further on */
	work_directory(s, next, directory);
}

static void dir_answered(struct serve *s, struct client *c, int err)
{
	bool buses = c->step == STEP_BUSES, every = buses || c->node.every;
	struct node root = { .root = true };

	if (!err)
		directory_take(c->directory, buses ? &root : &c->node, &s->buses, c->guest.served,
		             c->guest.answer.len);
	if (err == -ENOTDIR && c->node.slash)
		err = -ENOENT;
	/* of several one that knows the directory is enough */
	if (!err || c->worst == NOT_YET || (c->worst < 0 && err != -ENOENT && err != -ENOTCONN))
		c->worst = !err || c->worst == 0 ? 0 : err;
	if (every && !c->lent) {
		c->target++;
		ask_target(s, c);
		return;
	}
	/* settings have the return codes everywhere */
	if (!err && strcmp(c->node.path, "/settings") == 0)
		directory_add(c->directory, "return_codes", 12);
	listed(s, c);
}

/* --- Reading ---------------------------------------------------------------------------------- */

/* The value is in the room as the bus gave it: into the client's units, and out. */
static void show(struct serve *s, struct client *c)
{
	int n = units_show(c->node.type, c->request.flags, (char *)client_room(c), c->value_len,
	                   READ_ROOM);

	if (n < 0)
		reply_error(s, c, n);
	else
		reply_value(s, c, (uint32_t)n);
}

/* A scale was asked for, and whether the value has one is not known: ask what it is. */
static bool ask_type(struct serve *s, struct client *c)
{
	const struct node *node = &c->node;
	uint8_t *room = c->request.type == FRAME_WRITE ? client_room(c)
	                                               : client_room(c) + c->value_len;

	if (node->type || !node->has_device || !units_asked(c->request.flags))
		return false;
	if (!node->has_rom) {
		set_path(c, "/family");
		ask(s, c, STEP_FAMILY, BUS_READ, GUEST_ANY_LANE, room, 64);
		return true;
	}
	snprintf(c->path, sizeof(c->path), "/structure/%02X%s", node->rom[0],
	         node->path + node->device_len);
	ask(s, c, STEP_STRUCTURE, BUS_READ, GUEST_ANY_LANE, room, 64);
	return true;
}

static void read_answered(struct serve *s, struct client *c, int err)
{
	if (err) {
		if (c->is_get && (err == -EISDIR || err == -ENOENT))
			want_directory(s, c, STEP_DIR);
		else
			reply_error(s, c, err);
		return;
	}
	c->value_len = c->guest.answer.len;
	kept_add(s->kept, &c->node, c->guest.answer.measured_ns, client_room(c), c->value_len);
	if (!ask_type(s, c))
		show(s, c);
}

static void read_target(struct serve *s, struct client *c)
{
	int n = -ENOENT;

	if (!c->node.fresh && !(c->request.flags & FRAME_UNCACHED))
		n = kept_find(s->kept, &c->node, s->now_ns, (char *)client_room(c), READ_ROOM);
	if (n >= 0) {
		count(s, COUNT_kept_answers, 1);
		c->value_len = (uint32_t)n;
		show(s, c);
		return;
	}
	ask(s, c, STEP_READ, BUS_READ, lane_path(s, c), client_room(c), READ_ROOM);
}

static void read_here(struct serve *s, struct client *c)
{
	char *room = (char *)client_room(c);
	int n;

	if (c->node.kind == NODE_SIGNAL) {
		n = signals_read(s->signals, c->node.name, s->now_ns, room, READ_ROOM);
	} else if (c->node.code < 0) {
		n = code_texts(room, READ_ROOM);
	} else {
		n = snprintf(room, READ_ROOM, "%s", code_text((unsigned)c->node.code));
	}
	if (n < 0)
		reply_error(s, c, n);
	else
		reply_value(s, c, (uint32_t)n);
}

static bool is_directory(const struct node *node)
{
	return node->devices || node->kind == NODE_SIGNALS || node->kind == NODE_CODES ||
	       (node->has_device && !node->path[node->device_len]);
}

static void refuse_directory(struct serve *s, struct client *c)
{
	if (c->node.has_device && c->node.kind == NODE_TARGET)
		ask(s, c, STEP_REFUSE, BUS_PROBE, lane_path(s, c), NULL, 0);
	else
		reply_error(s, c, -EISDIR);
}

static void begin_read(struct serve *s, struct client *c)
{
	if (c->request.size <= 0 || c->request.size > READ_MOST) {
		reply_code(s, c, CODE_BAD_SIZE);
		return;
	}
	if (c->node.kind == NODE_SIGNAL || c->node.kind == NODE_CODE)
		read_here(s, c);
	else if (is_directory(&c->node))
		refuse_directory(s, c);
	else
		read_target(s, c);
}

/* --- Writing ---------------------------------------------------------------------------------- */

static void write_target(struct serve *s, struct client *c)
{
	uint8_t *data = (uint8_t *)(uintptr_t)c->request.data;
	uint32_t len = c->request.data_len;
	int lane;

	kept_forget(s->kept, &c->node);
	if (units_convert(c->node.type, c->request.flags)) {
		int n = units_take(c->node.type, c->request.flags, (const char *)data, len,
		                   (char *)client_room(c), READ_ROOM);

		if (n < 0) {
			reply_error(s, c, n);
			return;
		}
		data = client_room(c);
		len = (uint32_t)n;
	}
	lane = lane_path(s, c);
	if (!c->node.every) {
		ask(s, c, STEP_WRITE, BUS_WRITE, lane, data, len);
		return;
	}
	next_target(s, c);
	if (c->target < targets(s))
		ask(s, c, STEP_WRITE_EACH, BUS_WRITE, (int)c->target, data, len);
	else
		reply_error(s, c, c->worst == NOT_YET ? -ENOTCONN : c->worst);
}

/* An output of the table: its control program commands it, and so does this client. */
static void command(struct serve *s, struct client *c, int record)
{
	const char *text = (const char *)c->request.data;
	uint32_t len = c->request.data_len;
	char *room = (char *)client_room(c);
	int err = 0;

	if (record >= 0 && units_convert(c->node.type, c->request.flags)) {
		err = units_take(c->node.type, c->request.flags, text, len, room, READ_ROOM);
		len = err < 0 ? 0 : (uint32_t)err;
		text = room;
	}
	if (err >= 0)
		err = record >= 0 ? signals_write_record(s->signals, (unsigned)record, s->now_ns, text,
		                                         len, &c->command)
		                  : signals_write(s->signals, c->node.name, s->now_ns, text, len,
		                                  &c->command);
	if (err)
		reply_error(s, c, err);
	else if (!c->command.record)
		reply_written(s, c, c->request.data_len);
	else
		client_enter(s, c, CLIENT_APPLYING);
	if (c->state == CLIENT_APPLYING)
		work_applying(s, c);
}

void work_applying(struct serve *s, struct client *c)
{
	int err = signals_applied(s->signals, &c->command);

	if (err == 0) {
		kept_forget(s->kept, &c->node);
		reply_written(s, c, c->request.data_len);
	} else if (err != -EAGAIN || s->now_ns - c->since_ns >= APPLY_NS) {
		reply_error(s, c, err == -EAGAIN ? -EIO : err);
	} else if (s->now_ns + APPLY_LOOK_NS < s->look_ns) {
		s->look_ns = s->now_ns + APPLY_LOOK_NS;
	}
}

static void begin_write(struct serve *s, struct client *c)
{
	const struct node *node = &c->node;
	int record;

	if (s->config->serve.read_only) {
		count(s, COUNT_refused_writes, 1);
		reply_error(s, c, -EROFS);
		return;
	}
	if (!c->request.data || (uint32_t)c->request.size > c->request.data_len) {
		reply_code(s, c, CODE_NO_SUCH_PATH);
		return;
	}
	c->request.data_len = (uint32_t)c->request.size;
	if (is_directory(node)) {
		refuse_directory(s, c);
	} else if (node->kind == NODE_CODE || c->request.offset != 0) {
		reply_error(s, c, -EACCES);
	} else if (node->kind == NODE_SIGNAL) {
		command(s, c, -1);
	} else {
		record = node->bus < 0 ? kept_signal(s->kept, node->path, true) : -1;
		if (record >= 0)
			command(s, c, record);
		else if (!ask_type(s, c))
			write_target(s, c);
	}
}

static void write_answered(struct serve *s, struct client *c, int err)
{
	kept_forget(s->kept, &c->node);
	if (c->step == STEP_WRITE_EACH) {
		if (c->worst == NOT_YET || !err)
			c->worst = err;
		c->target++;
		if (!c->lent && c->target < targets(s)) {
			write_target(s, c);
			return;
		}
		err = c->worst;
	}
	if (err)
		reply_error(s, c, err);
	else
		reply_written(s, c, units_convert(c->node.type, c->request.flags)
		                            ? c->request.data_len
		                            : c->guest.answer.len);
}

/* --- What it is ------------------------------------------------------------------------------- */

static void type_answered(struct serve *s, struct client *c, int err)
{
	const uint8_t *text = c->guest.data;
	uint8_t rom[ROM_LEN] = { 0 };
	char path[NODE_PATH_MAX];

	if (err) {
		reply_error(s, c, err);
		return;
	}
	if (c->step == STEP_STRUCTURE) {
		c->node.type = c->guest.answer.len ? (char)text[0] : 'a';
	} else {
		/* as a device of that family would be */
		for (int i = 0; i < 2 && c->guest.answer.len == 2; i++)
			rom[0] = (uint8_t)(rom[0] * 16 + (text[i] & 0xf) + (text[i] >= 'A' ? 9 : 0));
		if (rom[0]) {
			struct node like;
			char id[ROM_TEXT_MAX];

			rom_print(rom, ROM_F_I, id);
			snprintf(path, sizeof(path), "/%s%s", id, c->node.path + c->node.device_len);
			node_parse(path, strlen(path), &like);
			c->node.type = like.type;
			c->node.has_rom = true;
			memcpy(c->node.rom, rom, ROM_LEN);
			if (!like.type && ask_type(s, c))
				return;
		}
	}
	if (!c->node.type)
		reply_error(s, c, -EIO);
	else if (c->request.type == FRAME_WRITE)
		write_target(s, c);
	else
		show(s, c);
}

/* --- Presence --------------------------------------------------------------------------------- */

static void reply_id(struct serve *s, struct client *c, const uint8_t rom[ROM_LEN])
{
	memcpy(client_room(c), rom, ROM_LEN);
	reply(s, c, 0, ROM_LEN, 0, 0);
}

static void begin_present(struct serve *s, struct client *c)
{
	static const uint8_t none[ROM_LEN];
	const struct node *node = &c->node;

	if (node->kind == NODE_SIGNAL && !signals_has(s->signals, node->name))
		reply_error(s, c, -ENOENT);
	else if (node->kind != NODE_TARGET || node->devices)
		reply_id(s, c, none);
	else
		ask(s, c, STEP_PROBE, BUS_PROBE, lane_path(s, c), NULL, 0);
}

static void present_answered(struct serve *s, struct client *c, int err)
{
	uint8_t rom[ROM_LEN];

	if (err) {
		reply_error(s, c, err);
	} else if (c->step == STEP_ADDRESS) {
		if (rom_parse((const char *)client_room(c), c->guest.answer.len, rom))
			reply_error(s, c, -EIO);
		else
			reply_id(s, c, rom);
	} else if (c->node.has_device && !c->node.has_rom) {
		set_path(c, "/address");
		ask(s, c, STEP_ADDRESS, BUS_READ, GUEST_ANY_LANE, client_room(c), 64);
	} else {
		reply_id(s, c, c->node.rom);
	}
}

/* --- Beginning and end ------------------------------------------------------------------------ */

static void begin_get(struct serve *s, struct client *c)
{
	c->is_get = true;
	if (is_directory(&c->node) || c->node.slash)
		want_directory(s, c, STEP_DIR);
	else
		begin_read(s, c);
}

static void begin_dir(struct serve *s, struct client *c)
{
	if (c->node.kind == NODE_SIGNAL)
		reply_error(s, c, signals_has(s->signals, c->node.name) ? -ENOTDIR : -ENOENT);
	else if (c->node.kind == NODE_CODE)
		reply_error(s, c, -ENOTDIR);
	else
		want_directory(s, c, STEP_DIR);
}

/* With the path understood, and its bus known. */
static void begin(struct serve *s, struct client *c)
{
	if (c->node.bus >= 0 && (unsigned)c->node.bus >= s->buses.count) {
		if (c->once_more) {
			reply_error(s, c, -ENODEV);
			return;
		}
		c->once_more = true;
		want_directory(s, c, STEP_BUSES);
		return;
	}
	c->target = 0;
	c->worst = NOT_YET;
	switch ((enum frame_type)c->request.type) {
	case FRAME_READ:
		begin_read(s, c);
		return;
	case FRAME_WRITE:
		begin_write(s, c);
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
	reply_code(s, c, 0);
}

static bool is_known(int32_t type)
{
	return type == FRAME_NOP || (type >= FRAME_READ && type <= FRAME_DIR) ||
	       (type >= FRAME_PRESENT && type <= FRAME_GETSLASH);
}

void work_begin(struct serve *s, struct client *c)
{
	const struct request *r = &c->request;
	bool lists = r->type != FRAME_READ && r->type != FRAME_WRITE;

	c->directory = NULL;
	c->is_get = c->once_more = false;
	if (!is_known(r->type)) {
		reply_code(s, c, CODE_BAD_TYPE);
		return;
	}
	if (r->type == FRAME_NOP) {
		reply_code(s, c, 0);
		return;
	}
	if (r->payload == 0) {
		reply_code(s, c, CODE_EMPTY);
		return;
	}
	node_parse(r->path, r->path_len, &c->node);
	c->node.fresh |= (r->flags & FRAME_UNCACHED) != 0;
	if (c->node.kind == NODE_NONE || (c->node.slash && !lists && !is_directory(&c->node)))
		reply_error(s, c, -ENOENT);
	else
		begin(s, c);
}

void work_answered(struct serve *s, struct client *c)
{
	int err = c->guest.answer.err;

	/* what is lent is not looked into; the answer needs a header's room only */
	if (c->lent && !err)
		err = -EIO;
	switch ((enum client_step)c->step) {
	case STEP_READ:
		read_answered(s, c, err);
		return;
	case STEP_WRITE:
	case STEP_WRITE_EACH:
		write_answered(s, c, err);
		return;
	case STEP_DIR:
	case STEP_BUSES:
		dir_answered(s, c, err);
		return;
	case STEP_REFUSE:
		reply_error(s, c, err ? err : -EISDIR);
		return;
	case STEP_PROBE:
	case STEP_ADDRESS:
		present_answered(s, c, err);
		return;
	case STEP_FAMILY:
	case STEP_STRUCTURE:
		type_answered(s, c, err);
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
