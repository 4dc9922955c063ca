/* SPDX-License-Identifier: MIT */
/*
 * The null bus: a whole backend of the simple tier, to learn from and to test with. Its devices are
 * a table; a read returns what was written last. Target: `null:`, nothing after the colon.
 *
 * Room hal/null: the backend to copy. Uses hal/bus.
 */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/bus/bus.h"

#define DEVICE_LEN 16 /* "/28.000000000001" */
#define PROPERTIES 4

static const struct property {
	const char *path;
	uint32_t len;
	char text[64];
} at_start[PROPERTIES] = {
	/* those of one device stand together */
	{"/28.000000000001/address", 16, "2800000000000140"},
	{"/28.000000000001/temperature", 4, "21.5"},
	{"/29.000000000002/address", 16, "290000000000029F"},
	{"/29.000000000002/PIO.BYTE", 1, "0"},
};

struct null_bus {
	struct bus bus;
	struct property property[PROPERTIES];
};

static int null_create(const char *where, const struct bus_env *env, struct bus **bus, char *why,
                       size_t why_size)
{
	struct null_bus *null = *where ? NULL : calloc(1, sizeof(*null));

	if (*where)
		snprintf(why, why_size, "nothing may follow 'null:'");
	if (!null || bus_init(&null->bus, &null_bus, env)) {
		free(null);
		return *where ? -EINVAL : -ENOMEM;
	}
	memcpy(null->property, at_start, sizeof(at_start));
	*bus = &null->bus;
	return 0;
}

static void null_destroy(struct bus *bus)
{
	free(bus);
}

static int null_list(struct bus_req *req, uint32_t *used)
{
	size_t base = req->path[1] ? strlen(req->path) : 0;
	const char *last = "";

	for (size_t i = 0; i < PROPERTIES; i++) {
		const char *path = at_start[i].path;
		size_t len = base ? strlen(path) : DEVICE_LEN;

		if (strncmp(path, req->path, base) != 0 || path[base] != '/' ||
		    strncmp(path, last, len) == 0)
			continue;
		if (*used + len + 1 > req->len)
			return -EMSGSIZE;
		memcpy(req->data + *used, last = path, len);
		req->data[*used + len] = '\n';
		*used += (uint32_t)len + 1;
	}
	return *used || strcmp(req->path, "/alarm") == 0 ? 0 : -ENODEV;
}

static void null_exec(struct bus *bus, struct bus_req *req, struct bus_answer *answer)
{
	answer->kind = BUS_TEXT;
	answer->detail = BUS_DETAIL_SIMULATED;
	answer->measured_ns = bus->env->now(bus->env->ctx);
	answer->err = req->op != BUS_DIR ? -ENODEV : /* no alarm search: that is allowed */
	                      strcmp(req->path, "/alarm") == 0 ? -EOPNOTSUPP
	                                                       : null_list(req, &answer->len);
	for (unsigned i = 0; req->op != BUS_DIR && i < PROPERTIES; i++) {
		struct property *p = &((struct null_bus *)bus)->property[i];

		if (strncmp(req->path, p->path, DEVICE_LEN) == 0 && answer->err == -ENODEV)
			answer->err = req->op == BUS_PROBE ? 0 : -ENOENT;
		if (req->op == BUS_PROBE || strcmp(req->path, p->path) != 0)
			continue;
		answer->err = req->op == BUS_WRITE &&
		                              (req->offset || bus_write_text(req) > sizeof(p->text))
		                      ? -EINVAL
		              : req->op == BUS_READ && req->len < p->len ? -EMSGSIZE
		                                                         : 0;
		if (!answer->err && req->op == BUS_WRITE)
			memcpy(p->text, req->data, p->len = bus_write_text(req));
		else if (!answer->err)
			memcpy(req->data, p->text, p->len);
		answer->len = answer->err ? 0 : p->len;
	}
}

/* clang-format off */
const struct bus_ops null_bus = {
	.scheme = "null", .summary = "a table in memory: a lesson and a test double", .testing = true, .depth = 1,
	.create = null_create, .destroy = null_destroy, .exec = null_exec,
};
/* clang-format on */
