/* SPDX-License-Identifier: MIT */
/* What a request's path means: a property of a device, a directory, a table that has no device. */
#include <errno.h>
#include <stddef.h>
#include <string.h>
#include <strings.h>

#include "hal/chips/find.h"
#include "hal/chips/format.h"
#include "hal/native/branches.h"
#include "hal/native/resolve.h"
#include "hal/native/sensors.h"
#include "hal/native/tables.h"

static bool slice_starts(struct path_slice slice, const char *word)
{
	size_t n = strlen(word);

	return slice.len >= n && strncasecmp(slice.text, word, n) == 0 &&
	       (slice.len == n || slice.text[n] == '/');
}

/* What is asked of a directory: a list, or whether it is there. */
static int take_directory(struct job *job, enum job_kind list, enum job_kind probe)
{
	if (job->req->op == BUS_READ || job->req->op == BUS_WRITE)
		return -EISDIR;
	job->kind = job->req->op == BUS_DIR ? list : probe;
	return 0;
}

/* Is `name` a directory of the table: does a property stand below it? */
static bool is_directory(const struct family *family, const struct device *device, const char *name,
                         size_t len)
{
	const struct property *property = NULL;

	/* before it is known which chip it is: of any */
	if (device && family_untold(device))
		device = NULL;
	while ((property = family_next(family, device, property)))
		if (strncmp(property->name, name, len) == 0 && property->name[len] == '/')
			return true;
	return false;
}

/* Bytes that can be read can be written in part too. */
static bool has_parts(const struct property *property, int extension)
{
	return property->type == PROPERTY_BINARY && property->access == ACCESS_BOTH &&
	       extension != EXTENSION_ALL;
}

/* A name such as temperature9 may be a property of its own, or one with an extension. */
static int resolve_property(struct job *job, const struct family *family,
                            const struct device *device, const char *name, size_t len)
{
	size_t name_len;
	int extension = extension_split(name, len, &name_len);
	const struct property *property = family_property(family, device, name, name_len);

	if (!property && extension != EXTENSION_NONE) {
		extension = EXTENSION_NONE;
		property = family_property(family, device, name, len);
		name_len = len;
	}
	bool directory = property ? property->type == PROPERTY_DIRECTORY
	                          : is_directory(family, device, name, len);
	if ((!property && !directory) || (directory && extension != EXTENSION_NONE))
		return -ENOENT;
	if (directory)
		return take_directory(job, JOB_LISTING, JOB_PROBE);
	if (!extension_fits(property, extension))
		return -ENOENT;
	job->property = property;
	job->extension = extension;
	if (job->req->op == BUS_DIR)
		return -ENOTDIR;
	if (job->req->op == BUS_PROBE) {
		job->kind = JOB_PROBE;
		return 0;
	}
	job->kind = JOB_PROPERTY;
	if (!(property->access & (job->req->op == BUS_READ ? ACCESS_READ : ACCESS_WRITE)))
		return -EACCES;
	if (job->req->op == BUS_WRITE && job->req->offset && !has_parts(property, extension))
		return -EINVAL;
	if (family->is_virtual && property->convert && job->req->op == BUS_WRITE)
		job->kind = JOB_CONVERT;
	return 0;
}

/* The word at the beginning, which is taken away with its slash. */
static struct path_slice take_word(struct path_slice *rest)
{
	const char *slash = memchr(rest->text, '/', rest->len);
	struct path_slice word = {rest->text, slash ? (size_t)(slash - rest->text) : rest->len};
	size_t used = word.len + (slash != NULL);

	rest->text += used;
	rest->len -= used;
	return word;
}

static struct device *device_named(struct native *native, struct path_slice name)
{
	uint8_t rom[ROM_LEN];

	if (rom_parse(name.text, name.len, rom) == 0)
		return device_find(&native->table, rom);
	return device_by_alias(&native->table, name.text, name.len);
}

/* "1F.x/main/1F.y/aux/28.z": bus becomes the channel of the last branch. */
static int resolve_follow(struct native *native, struct path_slice way, int *bus)
{
	struct path_slice name = take_word(&way);

	while (way.len) {
		const struct device *coupler = device_named(native, name);

		if (!coupler || !coupler->present || (*bus >= 0 && coupler->channel != *bus))
			return -ENODEV;
		*bus = branches_channel(native, coupler, take_word(&way));
		if (*bus < 0)
			return *bus;
		name = take_word(&way);
	}
	return 0;
}

static enum job_kind kind_of_list(const struct job *job)
{
	return job->path.alarm ? JOB_ALARM : job->fresh ? JOB_SCAN : JOB_LISTING;
}

/* The directory of a branch. */
static int resolve_branch(struct native *native, struct job *job)
{
	if (job->req->op == BUS_READ || job->req->op == BUS_WRITE)
		return -EISDIR;
	if (!job->txn.device || !job->txn.device->present)
		return -ENODEV;
	int channel = branches_channel(native, job->txn.device, job->path.property);
	if (channel < 0)
		return -EOPNOTSUPP;
	job->kind = JOB_PROBE;
	if (job->req->op == BUS_DIR) {
		job->bus = channel;
		job->inside = true;
		job->kind = kind_of_list(job);
	}
	return 0;
}

static int resolve_device(struct native *native, struct job *job)
{
	struct path *path = &job->path;
	_Alignas(max_align_t) uint8_t own[DEVICE_OWN] = {0};
	struct device *device, unknown = {.own = own};

	if (!path->has_rom) {
		device = device_by_alias(&native->table, path->last.text, path->last.len);
		if (!device)
			return -ENODEV;
		memcpy(path->rom, device->rom, sizeof(path->rom));
		path->has_rom = true;
	}
	if (resolve_follow(native, path->device, &job->bus))
		return -ENODEV;
	device = device_find(&native->table, path->rom);
	if (!device) {
		device = &unknown;
		memcpy(device->rom, path->rom, sizeof(device->rom));
		device->family = sensors_family(&native->sensors, path->rom);
	} else if (job->bus >= 0 && device->present && device->channel != job->bus) {
		/* It may have come to this wire while the adapter was lost: it is looked for. */
		if (!native_initial(native))
			return -ENODEV;
	} else {
		job->txn.device = device;
	}
	job->table = device->family;
	if (path->rom[0] == COUPLER_FAMILY && path_is_branch(path->property))
		return resolve_branch(native, job);
	if (path->property.len)
		return resolve_property(job, device->family, device, path->property.text,
		                        path->property.len);
	return take_directory(job, JOB_LISTING, JOB_PROBE);
}

/* "/alarm/29,12": only the devices of these families. False: no such list. */
static bool take_families(struct job *job)
{
	struct path_slice list = job->path.device;
	size_t n = 0;

	if (job->path.has_rom || job->path.property.len || list.len % 3 != 2)
		return false;
	for (size_t i = 0; i < list.len; i += 3, n++) {
		int high = hex_digit(list.text[i]), low = hex_digit(list.text[i + 1]);

		if (n == sizeof(job->families) || high < 0 || low < 0 || (high | low) == 0)
			return false;
		if (i + 2 < list.len && list.text[i + 2] != ',')
			return false;
		job->families[n] = (uint8_t)(high << 4 | low);
	}
	return true;
}

/* "structure/28/errata/die": path.property becomes what stands below the family. */
static int resolve_structure(struct job *job)
{
	struct path_slice *rest = &job->path.property, below = *rest;
	bool reads = job->req->op == BUS_READ;
	size_t name_len;

	if (job->req->op == BUS_WRITE)
		return -EACCES;
	job->kind = reads ? JOB_STRUCTURE : JOB_LISTING;
	take_word(&below);
	if (below.len) {
		job->table = structure_family(below.text, below.len, &name_len);
		if (!job->table)
			return -ENOENT;
		take_word(&below);
		*rest = below;
	}
	if (!below.len)
		return reads ? -EISDIR : 0;
	if (!reads && is_directory(job->table, NULL, rest->text, rest->len))
		return 0;
	job->extension = extension_split(rest->text, rest->len, &name_len);
	job->property = family_property(job->table, NULL, rest->text, name_len);
	if (!job->property || !extension_fits(job->property, job->extension))
		return -ENOENT;
	if (property_has_entries(job->property))
		return -EISDIR;
	return job->req->op == BUS_DIR ? -ENOTDIR : 0;
}

static int resolve_virtual(struct job *job)
{
	struct path_slice name = job->path.property;
	const char *slash = memchr(name.text, '/', name.len);
	size_t len = slash ? (size_t)(slash - name.text) : name.len;

	if (slice_starts(name, "structure"))
		return resolve_structure(job);
	if (slice_starts(name, "interface") && job->bus < 0)
		return -ENOENT;
	job->table = virtual_family(name.text, len);
	if (!job->table)
		return -ENOENT;
	if (len == name.len)
		return take_directory(job, JOB_LISTING, JOB_LISTING);
	return resolve_property(job, job->table, NULL, slash + 1, name.len - len - 1);
}

int resolve(struct native *native, struct job *job)
{
	const char *text = job->req->path;

	if (path_split(text, strlen(text), &job->path))
		return -ENOENT;
	job->fresh = job->req->fresh || job->path.uncached || native->uncached;
	job->bus = job->path.bus;
	if (job->bus >= (int)native->channels)
		return -ENODEV;
	if (job->path.alarm && job->req->op == BUS_DIR && job->path.device.len &&
	    take_families(job)) {
		job->kind = JOB_ALARM;
		return 0;
	}
	if (job->path.device.len)
		return resolve_device(native, job);
	if (job->path.property.len)
		return resolve_virtual(job);
	return take_directory(job, kind_of_list(job), JOB_LISTING);
}
