/* SPDX-License-Identifier: MIT */
/* The scripted buses of a scene, and its clock. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "hal/owfs/path.h"
#include "src/daemon/engine/routing/route.h"
#include "tests/unit/aid/scene_private.h"

static void note(struct scene_bus *bus, char what, const char *path, const char *text)
{
	struct scene *s = bus->scene;
	size_t used = strlen(s->trace);
	char number[16] = "";

	if (s->no_trace)
		return;
	if (bus != s->bus)
		snprintf(number, sizeof(number), "%d: ", (int)(bus - s->bus));
	snprintf(s->trace + used, sizeof(s->trace) - used, "%s%c %s%s%s\n", number, what, path,
	         what == 'W' ? "=" : "", text);
}

static int64_t latency_of(const struct scene_bus *bus, const char *path)
{
	return bus->slow && strcmp(path, bus->slow) == 0 ? bus->slow_ns : bus->latency_ns;
}

int scene_submit(void *ctx, struct bus_req *req)
{
	struct scene_bus *bus = ctx;
	struct scene *s = bus->scene;
	char text[128] = "";

	TEST_ASSERT_FALSE_MESSAGE(bus->holds && (bus->released || bus->asked),
	                          "asked though it was to let go");
	if (bus->refuses || bus->pending_count + bus->swallowed_count == bus->depth)
		return -EAGAIN;
	if (req->op == BUS_DIR) {
		s->lists++;
		bus->lists++;
		if (s->trace_lists)
			note(bus, req->whole ? 'd' : 'D', req->path, text);
	} else if (req->op == BUS_WRITE) {
		s->writes++;
		bus->writes++;
		snprintf(text, sizeof(text), "%.*s", (int)bus_write_text(req),
		         (const char *)req->data);
		note(bus, 'W', req->path, text);
	} else if (req->op == BUS_PROBE) {
		bus->probes++;
	} else {
		s->reads++;
		bus->reads++;
		note(bus, req->fresh ? 'r' : 'R', req->path, text);
	}
	if (bus->mute) {
		bus->swallowed[bus->swallowed_count++] = req;
		return 0;
	}
	bus->pending[bus->pending_count++] = (struct scene_pending){
		req, s->now_ns + latency_of(bus, req->path)};
	if (bus->pending_count > bus->most_pending)
		bus->most_pending = bus->pending_count;
	return 0;
}

void scene_suspend(void *ctx, bool yes)
{
	struct scene_bus *bus = ctx;

	bus->asked = true;
	bus->wanted = !yes;
	bus->asked_ns = bus->scene->now_ns;
	TEST_ASSERT_TRUE_MESSAGE(yes || bus->released, "opened and has not let go before");
	bus->when_ns = bus->scene->now_ns + bus->turn_ns;
	for (unsigned i = 0; !yes && i < bus->scene->bus_count; i++) {
		const struct scene_bus *other = &bus->scene->bus[i];

		if (other != bus && other->wire == bus->wire && !other->released)
			TEST_ASSERT_TRUE_MESSAGE(bus->scene->now_ns - other->asked_ns >=
			                                 ROUTE_RELEASE_NS,
			                         "two masters on one wire");
	}
}

void scene_answer_on(struct scene *s, unsigned bus, uint32_t id, int err, const char *text,
                     struct bus_req *req)
{
	struct bus_answer answer = s->bus[bus].besides;

	answer.id = id;
	answer.err = err;
	answer.measured_ns = s->now_ns;
	answer.detail = s->bus[bus].detail;

	if (!err && text && req && (req->op == BUS_READ || req->op == BUS_DIR)) {
		answer.len = (uint32_t)strlen(text);
		TEST_ASSERT_LESS_OR_EQUAL(req->len, answer.len);
		memcpy(req->data, text, answer.len);
	}
	engine_answer(s->engine, s->bus[bus].port, &answer, s->now_ns);
}

void scene_answer(struct scene *s, uint32_t id, int err, const char *text, struct bus_req *req)
{
	scene_answer_on(s, 0, id, err, text, req);
}

static void fail_pending(struct scene_bus *bus, int err)
{
	while (bus->pending_count) {
		struct bus_req *req = bus->pending[--bus->pending_count].req;

		scene_answer_on(bus->scene, (unsigned)(bus - bus->scene->bus), req->id, err, NULL,
		                req);
	}
}

static void tell(struct scene *s, unsigned bus, enum bus_news news, int err)
{
	struct bus_event event = {.news = (uint8_t)news, .err = err};

	engine_event(s->engine, s->bus[bus].port, &event, s->now_ns);
}

void scene_down_on(struct scene *s, unsigned bus, int err)
{
	fail_pending(&s->bus[bus], err);
	tell(s, bus, BUS_DOWN, err);
}

void scene_down(struct scene *s, int err)
{
	scene_down_on(s, 0, err);
}

void scene_tell(struct scene *s, unsigned bus, enum bus_news news, const char *path)
{
	struct bus_event event = {.news = (uint8_t)news};
	struct path split;

	TEST_ASSERT_EQUAL_INT(0, path_split(path, strlen(path), &split));
	memcpy(event.rom, split.rom, sizeof(event.rom));
	engine_event(s->engine, s->bus[bus].port, &event, s->now_ns);
}

static void deliver(struct scene_bus *bus, unsigned index)
{
	struct scene *s = bus->scene;
	unsigned number = (unsigned)(bus - s->bus);
	struct bus_req *req = bus->pending[index].req;
	struct scene_property *p = scene_find(s, bus->wire,
	                                      req->op == BUS_DIR ? "/alarm" : req->path);
	int err = req->op == BUS_DIR ? -EOPNOTSUPP : -ENOENT;

	bus->pending[index] = bus->pending[--bus->pending_count];
	if (req->op != BUS_DIR && s->bus_count > 1 && !scene_has_device(s, bus->wire, req->path))
		err = -ENODEV;
	if (req->op == BUS_PROBE)
		err = bus->probe_err                              ? bus->probe_err
		      : scene_has_device(s, bus->wire, req->path) ? 0
		                                                  : -ENODEV;
	if (!p || req->op == BUS_PROBE) {
		scene_answer_on(s, number, req->id, err, NULL, req);
		return;
	}
	if (s->on_done)
		s->on_done(bus, req);
	if (req->op == BUS_WRITE && p->write_err) {
		scene_answer_on(s, number, req->id, p->write_err, NULL, req);
		return;
	}
	if (s->on_read && req->op != BUS_WRITE)
		s->on_read(s, req->path);
	if (req->op == BUS_WRITE && !p->err && s->on_write)
		s->on_write(s, req->path, (const char *)req->data, bus_write_text(req));
	if (req->op == BUS_WRITE && !p->err)
		snprintf(p->text, sizeof(p->text), "%.*s", (int)bus_write_text(req),
		         (const char *)req->data);
	scene_answer_on(s, number, req->id, p->err, p->text, req);
}

void scene_up_on(struct scene *s, unsigned bus)
{
	tell(s, bus, BUS_UP, 0);
	engine_step(s->engine, s->now_ns);
}

void scene_up(struct scene *s)
{
	scene_up_on(s, 0);
}

void scene_reach(struct scene *s, unsigned number, bool there)
{
	struct scene_bus *bus = &s->bus[number];

	if (bus->there == there)
		return;
	bus->there = there;
	if (!s->engine || bus->mute)
		return;
	if (bus->released) {
		if (there && !bus->asked)
			tell(s, number, BUS_BACK, 0);
	} else if (there) {
		tell(s, number, BUS_UP, 0);
	} else {
		scene_down_on(s, number, -ENOTCONN);
	}
}

/* The bus has given its hardware back, or has opened it. */
static void turn(struct scene_bus *bus)
{
	struct scene *s = bus->scene;
	unsigned number = (unsigned)(bus - s->bus);

	if (bus->mute) { /* the target cannot be reached */
		bus->when_ns = s->now_ns + SCENE_S;
		return;
	}
	bus->when_ns = INT64_MAX;
	bus->asked = false;
	if (!bus->wanted) {
		fail_pending(bus, -ENOTCONN);
		bus->released = true;
		tell(s, number, BUS_RELEASED, 0);
		if (bus->there)
			tell(s, number, BUS_BACK, 0);
		return;
	}
	bus->released = false;
	bus->opened++;
	tell(s, number, bus->there ? BUS_UP : BUS_DOWN, bus->there ? 0 : -ENOENT);
}

/* Find what the buses do next, not after *until; false: nothing. */
static bool next_of_buses(struct scene *s, int64_t *until, struct scene_bus **which, int *pending)
{
	bool any = false;

	for (unsigned b = 0; b < s->bus_count; b++) {
		struct scene_bus *bus = &s->bus[b];

		for (unsigned i = 0; i < bus->pending_count; i++)
			if (bus->pending[i].when_ns <= *until) {
				*until = bus->pending[i].when_ns;
				*which = bus;
				*pending = (int)i;
				any = true;
			}
		if (bus->when_ns <= *until && bus->when_ns != INT64_MAX) {
			*until = bus->when_ns;
			*which = bus;
			*pending = -1;
			any = true;
		}
	}
	return any;
}

void scene_run(struct scene *s, int64_t ns)
{
	int64_t end = s->now_ns + ns;

	for (;;) {
		int64_t next = engine_step(s->engine, s->now_ns);
		struct scene_bus *bus = NULL;
		int pending = -1;
		bool any = next_of_buses(s, &next, &bus, &pending);

		TEST_ASSERT_TRUE_MESSAGE(next > s->now_ns || any, "the engine spins");
		if (next > end)
			break;
		s->now_ns = next;
		if (any && pending >= 0)
			deliver(bus, (unsigned)pending);
		else if (any)
			turn(bus);
	}
	s->now_ns = end;
}
