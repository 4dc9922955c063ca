/* SPDX-License-Identifier: MIT */
/* The configuration of a world, and its variants. */
#include <stdio.h>
#include <string.h>

#include "tests/endurance/world.h"

static size_t put_item(char *rio, size_t size, const struct item *item, unsigned variant)
{
	const char *id = item->device < 0 ? "" : field.device[item->device].id;

	switch (item->kind) {
	case ITEM_TEMPERATURE:
		return (size_t)snprintf(
			rio, size,
			"  Item { Name \"%s\" Path \"/%s/temperature%s\" Type double IO input\n"
			"         Uncached on PerFactor %d }\n",
			item->name, id, world->moody ? "" : "12", variant & SLOWER ? 2 : 1);
	case ITEM_PINS:
		return (size_t)snprintf(
			rio, size,
			"  Item { Name \"%s\" Path \"/%s/sensed.BYTE\" Type byte IO input\n"
			"         Alarm on\n"
			"         LatchAlarm \"latch.BYTE\" PorAlarm \"por\"\n"
			"         SetAlarm \"set_alarm=133333333\" ResetLatch \"latch.BYTE=0\" }\n",
			item->name, id);
	case ITEM_RELAYS:
		return (size_t)snprintf(
			rio, size,
			"  Item { Name \"%s\" Path \"/%s/PIO.BYTE\" Type byte IO output\n"
			"         InitValue \"0\" SafeValue \"0\" }\n",
			item->name, id);
	case ITEM_TEXT:
		return (size_t)snprintf(rio, size,
		                        "  Item { Name \"%s\" Path \"/%s/type\" Type string\n"
		                        "         IO input PerFactor 20 }\n",
		                        item->name, id);
	}
	return 0;
}

static size_t put_targets(char *rio, size_t size, unsigned variant)
{
	size_t n = 0, len = strlen(world->targets);

	if (variant & WITHOUT_LAST_TARGET && strchr(world->targets, ','))
		len = (size_t)(strrchr(world->targets, ',') - world->targets);
	for (size_t i = 0; i < len; i++) {
		if (world->targets[i] == '%')
			n += (size_t)snprintf(rio + n, size - n, "%s",
			                      station.part[world->targets[++i] - '0'].target);
		else
			rio[n++] = world->targets[i];
	}
	rio[n] = '\0';
	return n;
}

const char *world_configuration(unsigned variant)
{
	static char rio[8192];
	size_t n = 0;

	n += (size_t)snprintf(rio, sizeof(rio), "OwsDrv {\n  TargetName \"");
	n += put_targets(rio + n, sizeof(rio) - n, variant);
	n += (size_t)snprintf(rio + n, sizeof(rio) - n, "\"\n  Period %d\n  AlarmPeriod 2\n",
	                      variant & OTHER_PERIOD ? 7 : 10);
	for (unsigned i = 0; i < item_count; i++)
		if (i != 1 || !(variant & WITHOUT_SECOND))
			n += put_item(rio + n, sizeof(rio) - n, &items[i], variant);
	snprintf(rio + n, sizeof(rio) - n, "}\n");
	return rio;
}
