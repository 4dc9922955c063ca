/* SPDX-License-Identifier: MIT */
/* WRITE: to a device, to all targets, or as a command to the table. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "src/daemon/serve/answer.h"
#include "src/daemon/serve/client.h"
#include "src/daemon/serve/person.h"
#include "src/daemon/serve/units.h"
#include "src/daemon/serve/work_ask.h"
#include "src/daemon/serve/work_write.h"
#include "src/ground/service/command_age.h"

/*
 * The value to write, in the units of the bus: as the client sent it, or converted, in the client's
 * room. Returns its length, or a negative errno.
 */
static int value_for_bus(struct client *c, uint8_t **data)
{
	const struct request *r = &c->request;
	const char *text = (const char *)r->data;

	*data = (uint8_t *)(uintptr_t)r->data;
	if (!units_convert(c->node.type, r->flags))
		return (int)r->data_len;
	*data = client_room(c);
	return units_take(c->node.type, r->flags, text, r->data_len, (char *)*data,
	                  client_room_size(c));
}

void work_write_target(struct serve *s, struct client *c)
{
	uint8_t *data;
	int lane, len;

	/* a part of a number is another number; the target decides about an unknown type */
	if (c->request.offset && c->node.type && c->node.type != PROPERTY_BINARY) {
		answer_error(s, c, -EINVAL);
		return;
	}
	kept_forget(s->kept, &c->node, s->now_ns);
	len = value_for_bus(c, &data);
	if (len < 0) {
		answer_error(s, c, len);
		return;
	}
	lane = work_path(s, c);
	if (!c->node.every) {
		work_ask(s, c, STEP_WRITE, BUS_WRITE, lane, data, (uint32_t)len);
		return;
	}
	work_next_target(s, c);
	if (c->target < s->config->target_count)
		work_ask(s, c, STEP_WRITE_EACH, BUS_WRITE, (int)c->target, data, (uint32_t)len);
	else
		answer_error(s, c, c->worst == WORK_NOT_YET ? -ENOTCONN : c->worst);
}

/*
 * The name of the signal to command: the path names it, or it is the output at the path; or NULL.
 */
static const char *commanded_name(const struct serve *s, const struct node *node)
{
	int record;

	if (node->kind == NODE_SIGNAL)
		return node->name;
	record = node->bus < 0 ? kept_signal(s->kept, node->path, true) : -1;
	return record < 0 ? NULL : s->config->items[record - 1].name;
}

/* Command an output of the table. The control program commands the same output. */
static int work_write_give(struct serve *s, struct client *c, const char *name)
{
	char person[OWS_NAME];
	uint8_t *data;
	int len = value_for_bus(c, &data);

	if (len < 0)
		return len;
	person_name(c->fd, c->network, &c->peer, person);
	return signals_write(s->signals, person, name, s->now_ns, (const char *)data, (size_t)len,
	                     &c->command);
}

/* Give a command that has to wait to the engine; look whether one that it has is carried out. */
static int apply_command(struct serve *s, struct client *c)
{
	const char *name = commanded_name(s, &c->node);
	int err = name ? 0 : -ENOENT;

	if (!err && c->waits) {
		err = work_write_give(s, c, name);
		c->waits = err == -EBUSY;
		if (c->waits)
			return -EAGAIN;
	}
	return err || !c->command.record ? err : signals_applied(s->signals, name, &c->command);
}

static void await_command(struct serve *s, struct client *c)
{
	int err = apply_command(s, c);

	if (err == 0) {
		kept_forget(s->kept, &c->node, s->now_ns);
		answer_written(s, c, c->request.data_len);
	} else if (err != -EAGAIN || s->now_ns - c->since_ns >= APPLY_NS) {
		answer_error(s, c, err == -EAGAIN ? -EIO : err);
	} else if (s->now_ns + APPLY_LOOK_NS < s->look_ns) {
		s->look_ns = s->now_ns + APPLY_LOOK_NS;
	}
}

static void work_write_command(struct serve *s, struct client *c)
{
	c->waits = true;
	client_enter(s, c, CLIENT_APPLYING);
	await_command(s, c);
}

/* Does ControlAllow let the client write this signal, or a device where name is NULL? */
static bool is_allowed(const struct serve *s, const struct client *c, const char *name)
{
	const char *signal = name ? signals_name(s->signals, name) : NULL;

	/* what is no signal any more is refused as that */
	return (name && !signal) || person_may(s->config, c->fd, c->network, signal);
}

static void work_write_refuse(struct serve *s, struct client *c)
{
	count(s, COUNT_refused_writes, 1);
	answer_error(s, c, -EROFS);
}

/* The write would change an output of the table, which owsd would undo at once. */
static void refuse_beside(struct serve *s, struct client *c, int record)
{
	char reason[PATH_LEN_MAX + OWS_NAME + 256], person[OWS_NAME];
	const struct config_item *item = &s->config->items[record - 1];

	person_name(c->fd, c->network, &c->peer, person);
	snprintf(reason, sizeof(reason),
	         "a write of %s to what the output %s (%s) sets: command that output", person,
	         item->name, item->path);
	client_refused(s, COUNT_refused_writes, &s->error_rate, reason);
	answer_error(s, c, -EROFS);
}

/* By another property, as PIO.BYTE does PIO.1. */
static bool changes_output(struct serve *s, struct client *c)
{
	int record = kept_changes(s->kept, c->node.path);

	if (record > 0)
		refuse_beside(s, c, record);
	return record > 0;
}

/* An alias may name the device of an output: its target knows. False: there is nothing to ask. */
static bool ask_whose(struct serve *s, struct client *c)
{
	if (!c->node.has_device || c->node.has_rom || !kept_has_outputs(s->kept))
		return false;
	work_ask(s, c, STEP_WHOSE, BUS_READ, work_device_path(s, c, "/address"), client_room(c),
	         64);
	return true;
}

/*
 * The device of an output may have an alias in the table: its target knows whether that is the
 * device that is written to. False: there is nothing to ask.
 */
static bool ask_aliases(struct serve *s, struct client *c)
{
	char asked[sizeof(c->path)];
	struct node of;

	while (c->node.has_device) {
		char bus[24] = "";

		c->output = kept_by_alias(s->kept, c->output + 1, c->whose,
		                          c->node.path + c->node.device_len, &of);
		if (c->output < 0)
			return false;
		memcpy(asked, c->path, sizeof(asked));
		if (of.bus >= 0)
			snprintf(bus, sizeof(bus), "/bus.%d", of.bus);
		snprintf(c->path, sizeof(c->path), "%s%.*s/address", bus, of.device_len, of.path);
		if (!strcmp(asked, c->path))
			continue; /* it is another device */
		work_ask(s, c, STEP_ALIAS, BUS_READ, GUEST_ANY_LANE, client_room(c), 64);
		return true;
	}
	return false;
}

/* No output of the table has the path. */
static void write_beside(struct serve *s, struct client *c)
{
	if (!ask_aliases(s, c) && !work_ask_type(s, c))
		work_write_target(s, c);
}

static void write_device(struct serve *s, struct client *c)
{
	c->output = 0;
	c->path[0] = '\0';
	memcpy(c->whose, c->node.rom, sizeof(c->whose));
	if (!ask_whose(s, c))
		write_beside(s, c);
}

void work_write(struct serve *s, struct client *c)
{
	const struct node *node = &c->node;
	const char *name;

	if (s->config->serve.read_only || c->own) {
		work_write_refuse(s, c);
		return;
	}
	if (ows_now() - c->given_ns > COMMAND_OLD_NS) {
		client_refused(s, COUNT_refused_writes, &s->error_rate,
		               "a write may have waited for longer than 2 seconds");
		answer_code(s, c, CODE_TOO_OLD);
		return;
	}
	c->request.data_len = (uint32_t)c->request.size;
	if (work_is_directory(node)) {
		work_refuse_directory(s, c);
	} else if (node->kind == NODE_CODE) {
		answer_error(s, c, -EACCES);
	} else {
		name = commanded_name(s, node);
		if (!is_allowed(s, c, name))
			work_write_refuse(s, c);
		else if (name && c->request.offset)
			answer_error(s, c, -EINVAL);
		else if (name)
			work_write_command(s, c);
		else if (!changes_output(s, c))
			write_device(s, c);
	}
}

void work_write_named(struct serve *s, struct client *c, int err)
{
	char id[ROM_TEXT_MAX], path[NODE_PATH_MAX + ROM_TEXT_MAX];
	int bus = c->node.bus;

	if (!err && rom_parse((const char *)client_room(c), c->guest.answer.len, c->whose))
		err = -EIO;
	if (err == -ENOENT || err == -ENODEV) {
		/* no device of a bus: a line of a chip, a button of the simulator, or nothing */
		if (!work_ask_type(s, c))
			work_write_target(s, c);
		return;
	}
	if (err) {
		answer_error(s, c, err);
		return;
	}
	rom_print(c->whose, ROM_F_I, id);
	snprintf(path, sizeof(path), "/%s%s", id, c->node.path + c->node.device_len);
	if (kept_signal(s->kept, path, true) >= 0 || kept_changes(s->kept, path) >= 0) {
		node_parse(path, strlen(path), &c->node);
		c->node.bus = bus;
		work_write(s, c);
	} else {
		write_beside(s, c);
	}
}

/* The alias of an output is found. */
static void write_output(struct serve *s, struct client *c)
{
	const char *path = s->config->items[c->output - 1].path;
	struct node of;

	node_parse(path, strlen(path), &of);
	if (c->node.bus >= 0 || of.bus >= 0 ||
	    strcmp(of.path + of.device_len, c->node.path + c->node.device_len) != 0) {
		refuse_beside(s, c, c->output);
		return;
	}
	c->node = of;
	work_write(s, c);
}

/* No target that can be asked knows the alias. */
static bool is_nobodys(int err)
{
	return err == -ENOENT || err == -ENODEV || err == -ENXIO || err == -ENOTCONN;
}

void work_write_by_id(struct serve *s, struct client *c, int err)
{
	uint8_t rom[ROM_LEN];

	if (!err && rom_parse((const char *)client_room(c), c->guest.answer.len, rom))
		err = -EIO;
	if (c->lent || (err && !is_nobodys(err)))
		answer_error(s, c, err);
	else if (!work_same_targets(s, c))
		work_write(s, c); /* the table is another */
	else if (err || memcmp(rom, c->whose, sizeof(rom)) != 0)
		write_beside(s, c);
	else
		write_output(s, c);
}

void work_written(struct serve *s, struct client *c, int err)
{
	kept_forget(s->kept, &c->node, s->now_ns);
	if (c->step == STEP_WRITE_EACH) {
		if (c->worst == WORK_NOT_YET || !err)
			c->worst = err;
		/* the answers of the remaining targets are not known: report no success */
		if (c->lent || !work_same_targets(s, c)) {
			answer_error(s, c, err ? err : -EIO);
			return;
		}
		c->target++;
		if (c->target < s->config->target_count) {
			work_write_target(s, c);
			return;
		}
		err = c->worst;
	}
	if (err)
		answer_error(s, c, err);
	else
		answer_written(s, c,
		               units_convert(c->node.type, c->request.flags) ? c->request.data_len
		                                                             : c->guest.answer.len);
}

void work_look(struct serve *s)
{
	for (unsigned i = 0; i < s->used; i++)
		if (s->clients[i].state == CLIENT_APPLYING)
			await_command(s, &s->clients[i]);
}
