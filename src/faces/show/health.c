/* SPDX-License-Identifier: MIT */
/* The health of devices, of the qualities of their signals and of the requests that failed. */
#include <errno.h>
#include <string.h>
#include <strings.h>

#include "src/faces/show/health.h"

#define ANSWERS_LEAST 1000 /* from which on the share of the errors says something */
#define ANSWERS_PER_ERROR 100

bool health_is_key(const struct ows_info *info)
{
	const char *property = strrchr(info->path, '/');

	return (!strncmp(info->device, "01.", 3) || !strncmp(info->device, "81.", 3)) && property &&
	       !strcmp(property, "/present");
}

int health_find(struct ows *h, const char *id, struct ows_device *device)
{
	int low = 0, high = 1;

	while (high < ows_count(h) && ows_device(h, high, device) != -ENOENT)
		high *= 2;
	while (low < high) {
		int middle = low + (high - low) / 2, err = ows_device(h, middle, device);
		int order = err == -ENOENT ? 1 : err ? -1 : strcasecmp(device->id, id);

		if (!order)
			return middle;
		if (order < 0)
			low = middle + 1;
		else
			high = middle;
	}
	return -1;
}

enum device_health health_of_wire(const struct ows_device *device)
{
	return device->answers >= ANSWERS_LEAST &&
	                       device->errors > device->answers / ANSWERS_PER_ERROR
	               ? HEALTH_MAINTENANCE
	               : HEALTH_NORMAL;
}

enum device_health health_of_signal(const struct ows_info *info, uint8_t quality, bool simulated)
{
	if (health_is_key(info) || (info->output && quality == OWS_Q_INITIAL))
		return HEALTH_NORMAL;
	return ows_good(quality) && simulated ? HEALTH_CHECK : quality_health(quality);
}

enum device_health health_worse(enum device_health a, enum device_health b)
{
	if (a == HEALTH_NORMAL || b == HEALTH_NORMAL)
		return a == HEALTH_NORMAL ? b : a;
	return a < b ? a : b;
}

void health_devices(struct ows *h, int64_t now_ns, enum device_health *healths, int count)
{
	struct ows_device device;
	struct ows_value value;
	struct ows_info info;

	for (int i = 0; i < count; i++)
		healths[i] = ows_device(h, i, &device) ? HEALTH_CHECK : health_of_wire(&device);
	for (int i = 0; i < ows_count(h); i++) {
		int index = -1, err;

		if (ows_info(h, i, &info) == 0 && *info.device)
			index = health_find(h, info.device, &device);
		if (index < 0 || index >= count)
			continue;
		err = ows_get_signal(h, i, now_ns, &value);
		healths[index] = health_worse(
			healths[index],
			err && err != -ESTALE
				? HEALTH_CHECK
				: health_of_signal(&info, value.quality,
		                                   value.detail & OWS_DETAIL_SIMULATED));
	}
}
