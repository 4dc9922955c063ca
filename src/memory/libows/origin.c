/* SPDX-License-Identifier: MIT */
/* Who commands: the connected controllers, and the origin of each signal's command. */
#include <errno.h>

#include "src/memory/libows/actor.h"
#include "src/memory/libows/alive.h"
#include "src/memory/libows/handle.h"
#include "src/memory/shm/reader.h"

int ows_origin(struct ows *h, int id, struct ows_origin *origin)
{
	uint32_t record = handle_record(h, id);
	struct ows_origin_entry e;

	*origin = (struct ows_origin){0};
	if (!record || record >= map_count(&h->map, OWS_AREA_ORIGINS))
		return -ENOENT;
	if (!reader_entry(map_entry(&h->map, OWS_AREA_ORIGINS, record), &e, sizeof(e)))
		return -EIO;
	*origin = (struct ows_origin){
		.who = actor_of(&e.who),
		.taken_ns = e.taken_ns,
		.reason = e.reason <= UINT8_MAX ? (uint8_t)e.reason : OWS_REASON_NONE,
		.own = e.who.serial != 0 && e.who.serial == h->give.header.serial,
	};
	return handle_state(h);
}

int ows_controller(struct ows *h, int index, struct ows_controller *controller)
{
	struct ows_controller_entry e;

	*controller = (struct ows_controller){0};
	if (index < 0 || (uint32_t)index >= map_count(&h->map, OWS_AREA_CONTROLLERS))
		return -ENOENT;
	if (!reader_entry(map_entry(&h->map, OWS_AREA_CONTROLLERS, (uint32_t)index), &e, sizeof(e)))
		return -EIO;
	if (!(e.flags & OWS_CONTROLLER_CONNECTED))
		return 0;
	*controller = (struct ows_controller){
		.who = actor_of(&e.who),
		.joined_ns = e.joined_ns,
		.period_ms = e.period_ms,
		.commands = e.commands,
		.refused = e.refused,
		.may_set = (e.flags & OWS_CONTROLLER_MAY_SET) != 0,
		.late = (e.flags & OWS_CONTROLLER_LATE) != 0,
	};
	return 0;
}
