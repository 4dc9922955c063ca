/* SPDX-License-Identifier: MIT */
/* READ: values from the server itself or from a bus, in the units of the client. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "hal/owfs/frame.h"
#include "src/serve/answer.h"
#include "src/serve/client.h"
#include "src/serve/units.h"
#include "src/serve/work_ask.h"
#include "src/serve/work_directory.h"
#include "src/serve/work_read.h"
#include "src/serve/work_type.h"

/* The largest READ that a client may ask for. */
#define READ_MOST 100050
#define LONG_VALUE 4096

/* Convert the value in the room from the bus's units into the client's, and send it. */
void work_show(struct serve *s, struct client *c)
{
	int n = units_show(c->node.type, c->request.flags, (char *)client_room(c), c->value_len,
	                   client_room_size(c));

	if (n < 0)
		answer_error(s, c, n);
	else
		answer_value(s, c, (uint32_t)n);
}

void work_read_answered(struct serve *s, struct client *c, int err)
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
	/* no property with a scale is so long; the type needs room after the value */
	if (c->value_len > LONG_VALUE && !c->node.type && units_asked(c->request.flags))
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

/* A server asks for a signal that is an item of another owsd: that owsd may be the one who asks. */
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

void work_read(struct serve *s, struct client *c)
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
