/* SPDX-License-Identifier: MIT */
#include "guard.h"

#include "hal/path.h"

#include <math.h>
#include <string.h>

#define NEAR_DEGREES 5.0
#define RECENT_NS    60000000000LL

bool guard_watches(const char *text)
{
	static const uint8_t families[] = { 0x10, 0x22, 0x28, 0x3b, 0x42 };
	static const char *const properties[] = { "temperature", "temperature9", "temperature10",
		                                  "temperature11", "temperature12", "fasttemp",
		                                  "latesttemp" };
	struct path path;
	bool thermometer;

	if (path_split(text, strlen(text), &path) || !path.device.len)
		return false;
	/* an alias may be a thermometer too */
	thermometer = !path.has_rom || memchr(families, path.rom[0], sizeof(families));
	for (size_t i = 0; thermometer && i < sizeof(properties) / sizeof(properties[0]); i++)
		if (strlen(properties[i]) == path.property.len &&
		    memcmp(properties[i], path.property.text, path.property.len) == 0)
			return true;
	return false;
}

bool guard_refuses(struct guard *guard, double degrees, int64_t now_ns)
{
	bool near;

	/* owserver prints six digits: 127.9375 comes as 127.938 */
	if (fabs(degrees - 127.9375) < 0.001)
		return true;
	near = guard->last_ns && now_ns - guard->last_ns <= RECENT_NS &&
	       fabs(guard->last - 85.0) <= NEAR_DEGREES;
	if (fabs(degrees - 85.0) < 0.0005 && !near)
		return true;
	guard->last = degrees;
	guard->last_ns = now_ns;
	return false;
}
