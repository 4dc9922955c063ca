/* SPDX-License-Identifier: MIT */
/* DIR and its kin: the names come from the targets or from the server, and go to a client. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "hal/owfs/frame.h"
#include "src/daemon/serve/answer.h"
#include "src/daemon/serve/client.h"
#include "src/daemon/serve/work_ask.h"
#include "src/daemon/serve/work_directory.h"

static void form_directory(struct serve *s, struct client *c)
{
	struct directory_form form = {
		.node = &c->node,
		.prefix = c->request.path,
		.prefix_len = c->request.path_len,
		.flags = c->request.flags,
		.frames = c->request.type == FRAME_DIR,
		.slash = c->request.type == FRAME_DIRALLSLASH || c->request.type == FRAME_GETSLASH,
	};
	int err;

	while (form.prefix_len && form.prefix[form.prefix_len - 1] == '/')
		form.prefix_len--;
	if (c->node.root && c->request.flags & FRAME_BUS_LIST)
		directory_add_rest(c->directory, &c->node, &s->buses);
	/* the server itself has this directory, whether a target has one or not */
	if (strcmp(c->node.path, "/settings") == 0)
		directory_add_once(c->directory, "return_codes");
	err = directory_form(c->directory, &form);
	if (err)
		answer_error(s, c, err);
	else
		client_send(s, c, c->directory->out, c->directory->out_len);
}

/* The directory is complete. True: the step that looks for buses has ended. */
static bool listed(struct serve *s, struct client *c)
{
	if (c->step == STEP_BUSES) {
		directory_release(c->directory);
		c->directory = NULL;
		return true;
	}
	if (c->worst < 0)
		answer_error(s, c, c->worst);
	else
		form_directory(s, c);
	return false;
}

static bool ask_target(struct serve *s, struct client *c)
{
	bool buses = c->step == STEP_BUSES, every = buses || c->node.every;
	int lane = GUEST_ANY_LANE;
	uint32_t room;
	uint8_t *to;

	if (every) {
		work_next_target(s, c);
		if (c->target >= s->config->target_count) {
			if (c->worst == WORK_NOT_YET)
				c->worst = -ENOTCONN;
			return listed(s, c);
		}
		lane = (int)c->target;
		snprintf(c->path, sizeof(c->path), "%s", buses ? "/" : c->node.path);
	} else {
		lane = work_path(s, c);
	}
	to = directory_room(c->directory, &room);
	work_ask(s, c, buses ? STEP_BUSES : STEP_DIR, BUS_DIR, lane, to, room);
	return false;
}

static bool begin_directory(struct serve *s, struct client *c, struct directory *directory)
{
	c->directory = directory;
	directory->used = true;
	directory_begin(directory);
	c->target = 0;
	c->worst = WORK_NOT_YET;
	if (c->node.kind == NODE_SIGNALS && c->step != STEP_BUSES) {
		c->worst = signals_list(s->signals, directory) ? 0 : -EMSGSIZE;
		return listed(s, c);
	}
	if (c->node.kind == NODE_CODES && c->step != STEP_BUSES) {
		char name[16];

		directory_add(directory, "text.ALL", 8);
		for (unsigned i = 0; i < CODE_COUNT; i++)
			directory_add(directory, name,
			              (size_t)snprintf(name, sizeof(name), "text.%u", i));
		c->worst = 0;
		return listed(s, c);
	}
	return ask_target(s, c);
}

static struct directory *free_directory(struct serve *s)
{
	for (int i = 0; i < SERVER_DIRECTORIES; i++)
		if (!s->directories[i].used)
			return &s->directories[i];
	return NULL;
}

bool work_waits(struct serve *s)
{
	return s->queued && free_directory(s);
}

/* The client that has waited longest. */
static struct client *first_queued(struct serve *s)
{
	struct client *first = NULL;

	for (unsigned i = 0; i < s->used; i++) {
		struct client *c = &s->clients[i];

		if (c->state == CLIENT_QUEUED && (!first || c->since_ns < first->since_ns))
			first = c;
	}
	return first;
}

struct client *work_unqueue(struct serve *s, bool *ended)
{
	struct directory *directory = free_directory(s);
	struct client *c = s->queued && directory ? first_queued(s) : NULL;

	if (!c)
		return NULL;
	s->queued--;
	c->state = CLIENT_READING; /* begin_directory() enters the next state at once */
	*ended = begin_directory(s, c, directory);
	return c;
}

bool work_want_directory(struct serve *s, struct client *c, enum client_step step)
{
	struct directory *directory = s->queued ? NULL : free_directory(s);

	c->step = (uint8_t)step;
	if (directory)
		return begin_directory(s, c, directory);
	s->queued++;
	client_enter(s, c, CLIENT_QUEUED);
	return false;
}

bool work_listed(struct serve *s, struct client *c, int err)
{
	bool buses = c->step == STEP_BUSES, every = buses || c->node.every;
	struct node root = {.root = true};

	/* a bus still uses the room and the request: neither can serve anything else */
	if (c->lent) {
		answer_error(s, c, err);
		return false;
	}
	if ((every || c->node.root) && !work_same_targets(s, c)) {
		answer_error(s, c, -EIO);
		return false;
	}
	if (!err)
		directory_take(c->directory, buses ? &root : &c->node, &s->buses, c->guest.served,
		               c->guest.answer.len);
	if (err == -ENOTDIR && c->node.slash)
		err = -ENOENT;
	/* with several targets it is enough that one of them knows the directory */
	if (!err || c->worst == WORK_NOT_YET ||
	    (c->worst < 0 && err != -ENOENT && err != -ENOTCONN))
		c->worst = !err || c->worst == 0 ? 0 : err;
	if (every) {
		c->target++;
		return ask_target(s, c);
	}
	return listed(s, c);
}
