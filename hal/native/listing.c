/* SPDX-License-Identifier: MIT */
/* Directories of the native bus: devices, their properties, and the structure of families. */
#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "hal/chips/find.h"
#include "hal/chips/format.h"
#include "hal/native/branches.h"
#include "hal/native/listing.h"
#include "hal/wire/driver.h"

static int __attribute__((format(printf, 2, 3))) add(struct job *job, const char *format, ...)
{
	char line[PATH_LEN_MAX + 64];
	va_list args;

	va_start(args, format);
	int n = vsnprintf(line, sizeof(line) - 1, format, args);
	va_end(args);
	if (n < 0 || (size_t)n >= sizeof(line) - 1)
		return -EMSGSIZE;
	line[n++] = '\n';
	if ((size_t)n > job->req->len - job->out)
		return -EMSGSIZE;
	memcpy(job->req->data + job->out, line, (size_t)n);
	job->out += (size_t)n;
	return 0;
}

/* What stands before the entries: the path's flags, as they were written. */
static int prefix_len(const struct job *job)
{
	const struct path *path = &job->path;
	const char *text = job->req->path;

	if (path->device.len && !job->inside)
		return (int)(path->device.text - text);
	if (path->property.len && !job->inside)
		return (int)(path->property.text - text);
	return (int)strlen(text);
}

static int add_below(struct job *job, const char *name)
{
	int n = prefix_len(job);
	const char *text = job->req->path;

	while (n > 0 && text[n - 1] == '/')
		n--;
	return add(job, "%s%.*s/%s", n && text[0] != '/' ? "/" : "", n, text, name);
}

int listing_add_device(struct native *native, struct job *job, const struct device *device)
{
	const char *alias = native->unaliased ? "" : device_alias(device);
	char name[ROM_TEXT_MAX], way[PATH_LEN_MAX], text[PATH_LEN_MAX + DEVICE_ALIAS_MAX + 1];

	if (branches_print(native, job->inside ? 0 : device->channel, way, sizeof(way)))
		return -EMSGSIZE;
	rom_print(device->rom, ROM_F_I, name);
	snprintf(text, sizeof(text), "%s%s", way, alias[0] ? alias : name);
	return add_below(job, text);
}

/* The entries after the devices, where owserver has them; /uncached does not list itself. */
int listing_add_rest(struct native *native, struct job *job)
{
	static const char *const in_root[] = {"uncached",  "settings",     "system", "statistics",
	                                      "structure", "simultaneous", "alarm"};
	static const char *const in_bus[] = {"interface", "simultaneous", "alarm"};
	char name[16];
	int err = 0;

	if (job->path.alarm || job->inside)
		return 0;
	if (job->bus >= 0) {
		for (size_t i = 0; i < 3 && !err; i++)
			err = add_below(job, in_bus[i]);
		return err;
	}
	for (unsigned i = 0; i < native->channels && !err; i++) {
		snprintf(name, sizeof(name), "bus.%u", i);
		err = add_below(job, name);
	}
	for (size_t i = job->path.uncached; i < sizeof(in_root) / sizeof(in_root[0]) && !err; i++)
		err = add_below(job, in_root[i]);
	return err;
}

static int list_root(struct native *native, struct job *job)
{
	int err = 0;

	for (unsigned i = 0; i < native->table.count && !err; i++) {
		const struct device *device = &native->table.devices[i];

		if (device->present && (job->bus < 0 ? device->channel < NATIVE_CHANNELS
		                                     : device->channel == job->bus))
			err = listing_add_device(native, job, device);
	}
	return err ? err : listing_add_rest(native, job);
}

/* Can it be had of a device, where drivers say that? */
static bool is_offered(struct native *native, const struct device *device,
                       const struct property *property, int extension)
{
	struct link *link = device && native_has(native, device->channel)
	                            ? native->channel[device->channel].link
	                            : NULL;

	return !link || property->offline ||
	       driver_offers(link, device->rom, property->name, extension);
}

/* /structure shows an array by its first element, as owserver's does. */
static int add_property(struct native *native, struct job *job, const struct device *device,
                        const char *path, const struct property *property)
{
	bool first_alone = !job->path.device.len && !job->table->is_virtual;
	int first = property->array.index == INDEX_LETTERS ? EXTENSION_LETTERS : 0;
	int last = property->array.index == INDEX_NONE     ? EXTENSION_NONE
	           : property->array.count && !first_alone ? first + property->array.count - 1
	                                                   : first;
	char text[8];
	int err = 0;

	for (int extension = EXTENSION_NONE; extension <= last && !err; extension++) {
		if (extension == 0)
			extension = first;
		if (!extension_fits(property, extension) ||
		    !is_offered(native, device, property, extension))
			continue;
		extension_print(property, extension, text);
		err = add(job, "%s%s%s", path, property->name, text);
	}
	return err;
}

/* The properties of a table below `directory` ("" or "errata"). */
static int list_table(struct native *native, struct job *job, const struct family *family,
                      const struct device *device, const char *path, const char *directory,
                      size_t len)
{
	const struct property *property = NULL;
	int err = 0;

	while (!err && (property = family_next(family, device, property))) {
		const char *rest = property->name;

		if (property->hidden)
			continue;
		if (len && (strncmp(rest, directory, len) != 0 || rest[len] != '/'))
			continue;
		if (strchr(rest + (len ? len + 1 : 0), '/'))
			continue;
		err = add_property(native, job, device, path, property);
	}
	return err;
}

static int list_families(struct job *job)
{
	const struct family *family;
	int err = 0;

	for (unsigned n = 0; !err && (family = family_nth(n)); n++)
		err = add(job, "/structure/%02X", family->code);
	return err;
}

int listing(struct native *native, struct job *job)
{
	struct path_slice name = job->path.property;
	char path[PATH_LEN_MAX + 2];
	const char *text = job->req->path;
	int n;

	if (job->inside || (!job->table && !name.len))
		return list_root(native, job);
	/* /structure has no table itself; below it they are those of families */
	if (!job->table)
		return list_families(job);
	if (!job->path.device.len && !job->table->is_virtual) {
		snprintf(path, sizeof(path), "/structure/%02X/", job->table->code);
		return list_table(native, job, job->table, NULL, path, name.text, name.len);
	}
	if (!job->path.device.len) {
		/* The first word names the table, the rest is a directory of it. */
		const char *slash = memchr(name.text, '/', name.len);
		size_t word = slash ? (size_t)(slash - name.text) + 1 : name.len;

		name.text += word;
		name.len -= word;
		n = (int)(name.text - text) - (slash ? 1 : 0);
	} else {
		n = (int)(job->path.device.text + job->path.device.len - text);
	}
	snprintf(path, sizeof(path), "%s%.*s/", text[0] == '/' ? "" : "/", n, text);
	return list_table(native, job, job->table, job->txn.device, path, name.text, name.len);
}
