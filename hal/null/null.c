/* SPDX-License-Identifier: MIT */
/*
 * The null bus: a whole backend of the simple tier, to learn from and to test with. Its devices are
 * a table; a read returns what was written last. Target: `null:`, nothing after the colon.
 *
 * Room hal/null: the backend to copy.
 */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/bus/bus.h"

#define DEVICE_LEN 16 /* "/28.000000000001" */
#define PROPERTIES 4

/* The properties of one device stand together. */
static const struct property {
	const char *path;
	uint32_t len;
	char text[64];
} at_start[PROPERTIES] = {
	{"/28.000000000001/address", 16, "2800000000000140"},
	{"/28.000000000001/temperature", 4, "21.5"},
	{"/29.000000000002/address", 16, "290000000000029F"},
	{"/29.000000000002/PIO.BYTE", 1, "0"},
};

/* A bus is the first member of what the backend has, so that the two have one address. */
struct null_bus {
	struct bus bus;
	struct property property[PROPERTIES];
};

/* A backend allocates here all that it will need; it touches no hardware, and never blocks. */
static int null_create(const char *where, const struct bus_env *env, struct bus **bus, char *why,
                       size_t why_size)
{
	struct null_bus *null;
	int err;

	if (*where) {
		snprintf(why, why_size, "nothing may follow 'null:'");
		return -EINVAL;
	}
	null = calloc(1, sizeof(*null));
	if (!null)
		return -ENOMEM;
	err = bus_init(&null->bus, &null_bus, env);
	if (err) {
		free(null);
		return err;
	}
	memcpy(null->property, at_start, sizeof(at_start));
	*bus = &null->bus;
	return 0;
}

static void null_destroy(struct bus *bus)
{
	free(bus);
}

static bool is_same_device(const char *path, const char *other)
{
	return strncmp(path, other, DEVICE_LEN) == 0;
}

static bool has_device(const char *path)
{
	for (unsigned i = 0; i < PROPERTIES; i++)
		if (is_same_device(at_start[i].path, path))
			return true;
	return false;
}

/* NULL: no device has such a property. */
static struct property *find_property(struct null_bus *null, const char *path)
{
	for (unsigned i = 0; i < PROPERTIES; i++)
		if (strcmp(null->property[i].path, path) == 0)
			return &null->property[i];
	return NULL;
}

static int add_line(struct bus_req *req, const char *path, size_t len, uint32_t *used)
{
	if (*used + len + 1 > req->len)
		return -EMSGSIZE;
	memcpy(req->data + *used, path, len);
	req->data[*used + len] = '\n';
	*used += (uint32_t)len + 1;
	return 0;
}

/* The root lists the devices, a device its properties. */
static int null_list(struct null_bus *null, struct bus_req *req, uint32_t *used)
{
	bool is_root = strcmp(req->path, "/") == 0;
	const char *last = "";
	int err = 0;

	if (!is_root && !has_device(req->path))
		return -ENODEV;
	if (!is_root && req->path[DEVICE_LEN])
		return find_property(null, req->path) ? -ENOTDIR : -ENODEV;
	for (unsigned i = 0; i < PROPERTIES && !err; i++) {
		const char *path = at_start[i].path;

		if (!is_root && is_same_device(path, req->path))
			err = add_line(req, path, strlen(path), used);
		if (is_root && !is_same_device(path, last))
			err = add_line(req, path, DEVICE_LEN, used);
		last = path;
	}
	return err;
}

static int null_read(const struct property *property, struct bus_req *req, uint32_t *len)
{
	if (req->len < property->len)
		return -EMSGSIZE;
	memcpy(req->data, property->text, property->len);
	*len = property->len;
	return 0;
}

static int null_write(struct property *property, struct bus_req *req, uint32_t *len)
{
	uint32_t n = bus_write_text(req);

	if (req->offset || n > sizeof(property->text))
		return -EINVAL;
	memcpy(property->text, req->data, n);
	property->len = n;
	*len = n;
	return 0;
}

static int null_serve(struct null_bus *null, struct bus_req *req, uint32_t *len)
{
	struct property *property;

	if (req->op == BUS_DIR) {
		/* There is no search for alarms: a backend may do without one. */
		if (strcmp(req->path, "/alarm") == 0)
			return -EOPNOTSUPP;
		return null_list(null, req, len);
	}
	if (!has_device(req->path))
		return -ENODEV;
	if (req->op == BUS_PROBE)
		return 0;
	property = find_property(null, req->path);
	if (!property)
		return -ENOENT;
	if (req->op == BUS_READ)
		return null_read(property, req, len);
	return null_write(property, req, len);
}

/* One request, on the bus's own thread. A backend with hardware may block until its deadline. */
static void null_exec(struct bus *bus, struct bus_req *req, struct bus_answer *answer)
{
	answer->kind = BUS_TEXT;
	answer->detail = BUS_DETAIL_SIMULATED;
	answer->measured_ns = bus_now(bus->env);
	answer->err = null_serve((struct null_bus *)bus, req, &answer->len);
}

const struct bus_ops null_bus = {
	.scheme = "null",
	.summary = "a table in memory: a lesson and a test double",
	.testing = true,
	.depth = 1,
	.create = null_create,
	.destroy = null_destroy,
	.exec = null_exec,
};
