/* SPDX-License-Identifier: MIT */
/* What the first conversions are to requests and to devices that are found later. */
#include <string.h>

#include "hal/chips/find.h"
#include "hal/chips/thermometers/thermometer_proof.h"
#include "hal/native/first_asked.h"
#include "hal/native/sensors.h"

/* Is it certain without the chip's help which chip it is? */
static bool is_plain(const struct family *family)
{
	return family && family->thermometer && !family->several;
}

/* Does a request name its device by an id alone, which no coupler or alias has to be known for? */
static bool has_id(const struct job *job, struct path *path)
{
	return job->req && (job->req->op == BUS_READ || job->req->op == BUS_WRITE) &&
	       !path_split(job->req->path, strlen(job->req->path), path) && path->has_rom &&
	       path->last.len == path->device.len && !path->alarm;
}

static bool converts(const struct family *family, const struct path *path)
{
	const struct property *property = family_property(family, NULL, path->property.text,
	                                                  path->property.len);

	return property && property->convert;
}

bool first_names(const struct native *native, const struct job *job, struct path *path)
{
	if (!job->req || job->state != JOB_NEW || job->req->op != BUS_READ ||
	    job->req->prio <= BUS_OUTPUT || !has_id(job, path))
		return false;
	const struct family *family = sensors_family(&native->sensors, path->rom);

	return is_plain(family) && converts(family, path);
}

bool first_asks(const struct native *native, const struct job *job)
{
	struct path path;

	if (!has_id(job, &path))
		return false;
	const struct family *family = sensors_family(&native->sensors, path.rom);

	return family && !family->thermometer;
}

bool first_hurries(const struct native *native)
{
	for (const struct job *job = NULL; (job = native_job(native, job));)
		if (job->req->prio <= BUS_OUTPUT &&
		    ((job->state == JOB_LOCATE && !job->verified) || !first_asks(native, job)))
			return true;
	return false;
}

bool first_fits(const struct native *native, unsigned n)
{
	const struct channel *channel = &native->channel[n];

	return !channel->listed && native_abreast(native, n) && !channel->link->driver &&
	       channel->link->facts->strong;
}

void first_found(struct native *native, struct device *device)
{
	const struct channel *channel = &native->channel[device->channel];

	if (channel->listed || !channel->first.ready_ns || !device->family->thermometer)
		return;
	device->power = POWER_EXTERNAL;
	thermometer_converts(device, channel->first.ready_ns - FIRST_LONGEST_NS, FIRST_LONGEST_NS,
	                     false);
}

bool first_took_part(const struct native *native, const struct device *device)
{
	const struct first *first = &native->channel[device->channel].first;

	return device->present && first->ready_ns &&
	       thermometer_last(device).ends_ns == first->ready_ns;
}

void first_void(struct native *native)
{
	for (unsigned n = 0; n < NATIVE_ALL; n++)
		native->channel[n].first.ready_ns = 0;
}
