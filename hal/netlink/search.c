/* SPDX-License-Identifier: MIT */
/*
 * Searches. A request cannot choose a direction by what it has read, so a path is chosen before: of
 * a device that is known, and it is told where the wire went another way.
 *
 * All devices are looked for by the kernel's own search, which takes one request, but not those in
 * alarm: its conditional search goes on for 64 rounds when none is (as many as
 * w1_master_max_slave_count says), and counts the silent ones as gone.
 *
 * Only of a chip whose latch tells is the end of the id left unread: for an unknown one that begins
 * so, the latch is clear. A thermometer has none: to be found is its alarm, and its id is read
 * whole, with the checksum, once somebody has answered.
 */
#include <errno.h>
#include <string.h>

#include "hal/chips/find.h"
#include "hal/netlink/run.h"
#include "hal/netlink/search.h"
#include "hal/wire/crc.h"
#include "hal/wire/search.h"

#define PREFIXES 64
#define FULL_EVERY 16 /* alarm searches: one looks at all bits, for ids that are not known */

/* Ids that begin so are still to be looked for. */
struct prefix {
	uint8_t rom[8];
	unsigned bits;
	bool answered; /* by one that begins so */
};

struct walk {
	struct w1_netlink_link *link;
	bool alarm, full;
	struct prefix prefix[PREFIXES];
	unsigned prefixes;
	link_found *found;
	void *ctx;
};

static unsigned bit_of(const uint8_t *bytes, unsigned i)
{
	return bytes[i / 8] >> i % 8 & 1;
}

static void set_bit(uint8_t *bytes, unsigned i, unsigned value)
{
	bytes[i / 8] = (uint8_t)((bytes[i / 8] & ~(1u << i % 8)) | value << i % 8);
}

/*
 * The first n bytes of path are searched along: two slots that read and one that writes, for each
 * bit. slots gets what was read; and behind a whole id eight read slots more. 0, or an error.
 */
static int search_along(struct w1_netlink_link *link, bool alarm, const uint8_t *path, unsigned n,
                        uint8_t slots[25])
{
	const uint8_t command = alarm ? ONEWIRE_ALARM_SEARCH : ONEWIRE_SEARCH;
	uint8_t out[25];
	struct w1_request request;

	memset(out, 0xff, sizeof(out));
	for (unsigned i = 0; i < 8 * n; i++)
		set_bit(out, 3 * i + 2, bit_of(path, i));
	link->next_slot = -1;
	w1_request_begin(&request, link->number);
	int err = w1_request_add(&request, W1_RESET, NULL, 0, NULL);

	if (!err)
		err = w1_request_add(&request, W1_WRITE, &command, 1, NULL);
	if (!err)
		err = w1_request_add(&request, W1_TOUCH, out, n < 8 ? 3 * n : 25, slots);
	return err ? err : w1_netlink_run(link, &request);
}

/* The bit that the devices have: 0 or 1 all have that, 2 there are both, 3 none is left. */
static unsigned wire_at(const uint8_t *slots, unsigned i)
{
	unsigned id = bit_of(slots, 3 * i), complement = bit_of(slots, 3 * i + 1);

	return id != complement ? id : id ? 3 : 2;
}

int w1_netlink_verify(struct link *base, const uint8_t rom[8], bool alarm)
{
	struct w1_netlink_link *link = (struct w1_netlink_link *)base;
	uint8_t slots[25];
	int err = search_along(link, alarm, rom, 8, slots);

	if (err)
		return err == -EHOSTDOWN ? 0 : err;
	for (unsigned i = 0; i < 64; i++) {
		unsigned there = wire_at(slots, i);

		/* A device answered the bit before. */
		if (there == 3 && i)
			return -EBADMSG;
		if (there == 3 || (there < 2 && there != bit_of(rom, i)))
			return 0;
	}
	link->next_slot = slots[24] & 1;
	return 1;
}

static unsigned common_bits(const uint8_t a[8], const uint8_t b[8])
{
	unsigned i = 0;

	while (i < 64 && bit_of(a, i) == bit_of(b, i))
		i++;
	return i;
}

/*
 * A known device that begins with prefix, and how many of its bits tell it from all others. NULL:
 * none is known.
 */
static const uint8_t *guess_known(const struct walk *walk, const struct prefix *prefix,
                                  unsigned *bits)
{
	const struct w1_netlink *netlink = walk->link->netlink;
	unsigned channel = (unsigned)(walk->link - netlink->links);
	const uint8_t *rom = NULL;

	*bits = 0;
	for (unsigned i = 0; i < netlink->seen_count; i++) {
		const struct w1_seen *seen = &netlink->seen[i];

		if (seen->channel != channel || !family_of(seen->rom[0])->alarms ||
		    !search_same(seen->rom, prefix->rom, prefix->bits))
			continue;
		if (!rom) {
			rom = seen->rom;
			continue;
		}
		unsigned same = common_bits(rom, seen->rom);
		*bits = same + 1 > *bits ? same + 1 : *bits;
	}
	return rom;
}

static void look_later(struct walk *walk, const uint8_t path[8], unsigned i, unsigned value)
{
	if (walk->prefixes == PREFIXES)
		return;
	struct prefix *prefix = &walk->prefix[walk->prefixes++];
	memcpy(prefix->rom, path, sizeof(prefix->rom));
	set_bit(prefix->rom, i, value);
	prefix->bits = i + 1;
	prefix->answered = true;
}

/* One request: along a guess that begins with prefix. 0, what found returned, or an error. */
static int search_look(struct walk *walk, const struct prefix *prefix)
{
	unsigned own;
	const uint8_t *known = guess_known(walk, prefix, &own);
	uint8_t path[8], slots[25];
	unsigned bits = own > prefix->bits + 1 ? own : prefix->bits + 1;
	bool latches = known && !walk->link->link.whole && family_of(known[0])->latches;
	unsigned n = known && (walk->full || (prefix->answered && !latches)) ? 8 : (bits + 7) / 8;

	memcpy(path, known ? known : prefix->rom, sizeof(path));
	for (unsigned i = prefix->bits; !known && i < 64; i++)
		set_bit(path, i, 0);
	n = n > 8 ? 8 : n;
	int err = search_along(walk->link, walk->alarm, path, n, slots);
	if (err)
		return err == -EHOSTDOWN ? 0 : err;
	for (unsigned i = 0; i < 8 * n; i++) {
		unsigned there = wire_at(slots, i), mine = bit_of(path, i);

		/* A slot was disturbed where one had answered before. */
		if (there == 3 || (there < 2 && there != mine && i < prefix->bits))
			return prefix->answered || (there == 3 && i) ? -EBADMSG : 0;
		if (there == 2 && i >= prefix->bits)
			look_later(walk, path, i, !mine);
		if (there < 2 && there != mine) {
			look_later(walk, path, i, there);
			return 0;
		}
	}
	if (n < 8 && !latches) {
		look_later(walk, path, 8 * n - 1, bit_of(path, 8 * n - 1));
		return 0;
	}
	return onewire_rom_valid(path) ? walk->found(walk->ctx, path) : -EBADMSG;
}

static int search_alarms(struct w1_netlink_link *link, uint8_t family, link_found *found, void *ctx)
{
	struct walk walk = {.link = link,
	                    .alarm = true,
	                    .found = found,
	                    .ctx = ctx,
	                    .prefixes = 1,
	                    .full = ++link->alarm_searches % FULL_EVERY == 0};
	int err = 0;

	walk.prefix[0] = (struct prefix){.rom = {family}, .bits = family ? 8 : 0};
	while (walk.prefixes && !err) {
		struct prefix next = walk.prefix[--walk.prefixes];

		err = search_look(&walk, &next);
	}
	return err;
}

struct all {
	struct w1_netlink *netlink;
	uint8_t channel, family;
	link_found *found;
	void *ctx;
	int stop; /* what found returned */
};

static int note_found(void *ctx, const uint8_t rom[8])
{
	struct all *all = ctx;
	struct w1_netlink *netlink = all->netlink;

	if (netlink->seen_count < DEVICE_MAX) {
		struct w1_seen *seen = &netlink->seen[netlink->seen_count++];

		memcpy(seen->rom, rom, sizeof(seen->rom));
		seen->channel = all->channel;
	}
	if (!all->stop && (!all->family || rom[0] == all->family))
		all->stop = all->found(all->ctx, rom);
	return 0;
}

static void search_forget(struct w1_netlink *netlink, uint8_t channel)
{
	unsigned kept = 0;

	for (unsigned i = 0; i < netlink->seen_count; i++)
		if (netlink->seen[i].channel != channel)
			netlink->seen[kept++] = netlink->seen[i];
	netlink->seen_count = kept;
}

int w1_netlink_search(struct link *base, bool alarm, uint8_t family, link_found *found, void *ctx)
{
	struct w1_netlink_link *link = (struct w1_netlink_link *)base;
	struct all all = {.netlink = link->netlink,
	                  .family = family,
	                  .found = found,
	                  .ctx = ctx,
	                  .channel = (uint8_t)(link - link->netlink->links)};

	if (alarm)
		return search_alarms(link, family, found, ctx);
	search_forget(link->netlink, all.channel);
	struct w1_request request;
	w1_request_begin(&request, link->number);
	request.found = note_found;
	request.ctx = &all;
	int err = w1_request_add(&request, W1_SEARCH, NULL, 0, NULL);
	if (!err)
		err = w1_netlink_run(link, &request);
	return err ? err == -EHOSTDOWN ? 0 : err : all.stop;
}
