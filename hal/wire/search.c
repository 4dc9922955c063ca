/* SPDX-License-Identifier: MIT */
/* Searches of one wire, device by device, and whether a certain one is there. */
#include <errno.h>
#include <string.h>

#include "hal/wire/crc.h"
#include "hal/wire/search.h"

void search_begin(struct search *search, bool alarm, uint8_t family)
{
	memset(search, 0, sizeof(*search));
	search->command = alarm ? ONEWIRE_ALARM_SEARCH : ONEWIRE_SEARCH;
	search->family = family;
	search->rom[0] = family;
	search->branch = family ? 64 : 0;
}

static int triplet(struct link *link, bool direction)
{
	if (link->ops->triplet)
		return link->ops->triplet(link_wire(link), direction);

	int id = link_slot(link, true, LINK_IDLE);
	if (id < 0)
		return id;
	int complement = link_slot(link, true, LINK_IDLE);
	if (complement < 0)
		return complement;
	if (id && complement)
		return 7;
	bool taken = id == complement ? direction : id;
	int err = link_slot(link, taken, LINK_IDLE);
	return err < 0 ? err : id | complement << 1 | taken << 2;
}

static bool rom_bit(const uint8_t rom[8], unsigned position)
{
	return rom[(position - 1) / 8] >> (position - 1) % 8 & 1;
}

static void set_rom_bit(uint8_t rom[8], unsigned position, bool value)
{
	uint8_t mask = (uint8_t)(1 << (position - 1) % 8);

	rom[(position - 1) / 8] = (uint8_t)(value ? rom[(position - 1) / 8] | mask
	                                          : rom[(position - 1) / 8] & ~mask);
}

int search_path(struct link *link, bool reset, uint8_t command, uint8_t rom[8], uint8_t conflict[8])
{
	const struct link_part part = {.reset = reset, .out = &command, .out_n = 1};
	int err;

	if (link->ops->path)
		return link->ops->path(link_wire(link), reset, command, rom, conflict);
	err = link->ops->run(link, &part);
	memset(conflict, 0, 8);
	for (unsigned position = 1; !err && position <= 64; position++) {
		int bits = triplet(link, rom_bit(rom, position));

		if (bits < 0)
			return bits;
		if ((bits & 3) == 3)
			return position == 1 ? -EHOSTDOWN : -EBADMSG;
		set_rom_bit(rom, position, bits >> 2 & 1);
		set_rom_bit(conflict, position, (bits & 3) == 0);
	}
	return err;
}

/* The direction at a branch: as last time before the deepest untried one, 1 there, 0 behind. */
static bool direction_at(const struct search *search, unsigned position)
{
	if (position < search->branch || search->branch == 64)
		return rom_bit(search->rom, position);
	return position == search->branch;
}

/* The triplets of a search: made all at once, or each when it is asked for. */
struct pass {
	bool made;
	uint8_t rom[8], conflict[8];
};

/*
 * Reset, command, and where the link has a path, all that follows; a link that stands in front of
 * another makes its own reset. rom: the directions. 1, 0 nobody answers, or an error.
 */
static int begin_pass(struct link *link, uint8_t command, const uint8_t rom[8], struct pass *pass)
{
	const struct link_part part = {
		.reset = true, .out = &command, .out_n = link->ops->path ? 0 : 1};
	bool resets = link->ops->path && !link->wire;
	int err = resets ? 0 : link->ops->run(link, &part);

	pass->made = !err && link->ops->path;
	if (pass->made) {
		memcpy(pass->rom, rom, sizeof(pass->rom));
		err = link->ops->path(link_wire(link), resets, command, pass->rom, pass->conflict);
	}
	return err == -EHOSTDOWN ? 0 : err ? err : 1;
}

static int next_bits(struct link *link, const struct pass *pass, unsigned position, bool direction)
{
	if (!pass->made)
		return triplet(link, direction);
	int taken = rom_bit(pass->rom, position);

	return taken << 2 | (rom_bit(pass->conflict, position) ? 0 : taken ? 1 : 2);
}

int search_next(struct search *search, struct link *link)
{
	uint8_t rom[8] = {0}, directions[8] = {0};
	unsigned untried = 0;
	struct pass pass;

	if (search->last)
		return 0;
	for (unsigned position = 1; position <= 64; position++)
		set_rom_bit(directions, position, direction_at(search, position));
	int present = begin_pass(link, search->command, directions, &pass);
	if (present <= 0) {
		search->last = !present || !pass.made;
		return present;
	}
	for (unsigned position = 1; position <= 64; position++) {
		int bits = next_bits(link, &pass, position, direction_at(search, position));

		if (bits < 0)
			return bits;
		if ((bits & 3) == 3) {
			search->last = position == 1;
			return position == 1 ? 0 : -EBADMSG;
		}
		bool taken = bits >> 2 & 1;
		if (position <= 8 && search->family &&
		    taken != (search->family >> (position - 1) & 1)) {
			search->last = true;
			return 0;
		}
		if ((bits & 3) == 0 && !taken)
			untried = position;
		set_rom_bit(rom, position, taken);
		if (search->lone && !pass.made && search->lone(search->ctx, rom, position, rom))
			break;
	}
	if (!onewire_rom_valid(rom))
		return -EBADMSG;
	if (search->family && rom[0] != search->family) {
		search->last = true;
		return 0;
	}
	memcpy(search->rom, rom, sizeof(rom));
	search->branch = (uint8_t)untried;
	/* Branches within the family byte lead to other families. */
	search->last = untried == 0 || (search->family && untried <= 8);
	return 1;
}

bool search_same(const uint8_t a[8], const uint8_t b[8], unsigned bits)
{
	unsigned bytes = bits / 8;

	if (memcmp(a, b, bytes) != 0)
		return false;
	return bits % 8 == 0 || ((a[bytes] ^ b[bytes]) & ((1 << bits % 8) - 1)) == 0;
}

unsigned search_common(const uint8_t a[8], const uint8_t b[8])
{
	unsigned bits = 0;

	while (bits < 64 && rom_bit(a, bits + 1) == rom_bit(b, bits + 1))
		bits++;
	return bits;
}

/* Those that begin like roms[0], and whose next bit no chip has. */
static void exclude(const uint8_t *const roms[], bool away[], unsigned n, unsigned position,
                    int bits)
{
	for (unsigned i = 0; i < n; i++)
		if (!away[i] && bits >> rom_bit(roms[i], position) & 1)
			away[i] = search_same(roms[i], roms[0], position - 1);
}

/*
 * The path of roms[0], so many bits of it: 1 the search has ended at a device that begins so, 0
 * none is there, or an error.
 */
static int follow(struct link *link, uint8_t command, const uint8_t *const roms[], bool away[],
                  unsigned n, unsigned length)
{
	struct pass pass;
	int present = begin_pass(link, command, roms[0], &pass);

	if (pass.made)
		length = 64;
	if (present == 0)
		for (unsigned i = 0; i < n; i++)
			away[i] = true;
	if (present <= 0)
		return present;
	for (unsigned position = 1; position <= length; position++) {
		int bits = next_bits(link, &pass, position, rom_bit(roms[0], position));

		if (bits < 0)
			return bits;
		/* A chip answered the bit before. */
		if ((bits & 3) == 3 && position > 1)
			return -EBADMSG;
		exclude(roms, away, n, position, bits);
		if (away[0])
			return 0;
	}
	return 1;
}

int search_among(struct link *link, const uint8_t *const roms[], bool away[], unsigned n,
                 unsigned bits)
{
	if (!link->ops->verify)
		return follow(link, ONEWIRE_SEARCH, roms, away, n, bits);
	int present = link->ops->verify(link, roms[0], false);
	away[0] |= present == 0;
	return present;
}

int search_verify(struct link *link, const uint8_t rom[8], bool alarm)
{
	bool away = false;

	if (link->ops->verify)
		return link->ops->verify(link, rom, alarm);
	return follow(link, alarm ? ONEWIRE_ALARM_SEARCH : ONEWIRE_SEARCH, &rom, &away, 1, 64);
}
