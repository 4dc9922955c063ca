/* SPDX-License-Identifier: MIT */
/*
 * Other ids in a recording. All are changed by the same bits, a mask: then bits in which ids differ
 * are the same as before, and the CRC8, which is linear, is right with that of the mask. Where two
 * ids part the mask has 0, so that a search that takes 0 first finds them in the same order.
 *
 * An id stands as 28.551DDF030000, with its CRC behind it or without, in paths and wherever a line
 * has one. The mask is put over each of these, as a disturbed one would show most of the true one.
 * Elsewhere the digits of those are replaced whose checksum was right.
 */
#include <errno.h>
#include <string.h>
#include <strings.h>

#include "hal/owfs/path.h"
#include "hal/trace/anonymous.h"
#include "hal/wire/device.h"

#define SERIAL 12 /* its digits */

struct ids {
	uint8_t rom[DEVICE_MAX][8], mask[2][8]; /* of masks the second is backwards */
	char text[DEVICE_MAX][2][ROM_TEXT_MAX]; /* ... and so are these */
	unsigned count;
};

/* Puts a mask over so many digits; what is none stays. */
static void change(char *text, size_t digits, const uint8_t *mask)
{
	for (size_t k = 0; k < digits && *text; text++) {
		int digit = hex_digit(*text);

		if (digit < 0)
			continue;
		digit ^= k & 1 ? mask[k / 2] & 15 : mask[k / 2] >> 4;
		*text = "0123456789ABCDEF"[digit];
		k++;
	}
}

static void turn(const uint8_t rom[8], uint8_t back[8])
{
	for (int i = 0; i < 8; i++)
		back[i] = rom[7 - i];
}

static void collect(struct ids *ids, const uint8_t rom[8])
{
	uint8_t back[8];

	for (unsigned i = 0; i < ids->count; i++)
		if (memcmp(ids->rom[i], rom, 8) == 0)
			return;
	if (ids->count == DEVICE_MAX)
		return;
	memcpy(ids->rom[ids->count], rom, 8);
	turn(rom, back);
	rom_print(rom, ROM_FIC, ids->text[ids->count][0]);
	rom_print(back, ROM_FIC, ids->text[ids->count++][1]);
}

/* The letters of an id with a dot: 0, there is none here. rom is its id, if *err is 0. */
static size_t dotted(const char *text, uint8_t rom[8], int *err)
{
	static const uint8_t letters[] = {18, 17, 15};
	size_t left = strnlen(text, letters[0]);

	for (size_t i = 0; left > 2 && text[2] == '.' && i < sizeof(letters); i++) {
		*err = letters[i] > left ? -EINVAL : rom_parse(text, letters[i], rom);
		if (*err != -EINVAL)
			return letters[i];
	}
	return 0;
}

/* The digits of a known id, from its first byte on or from its last. */
static bool replace_known(const struct ids *ids, const char *begin, char *at)
{
	char *behind = at + SERIAL;

	for (unsigned i = 0; i < 2 * ids->count; i++) {
		const char *from = ids->text[i / 2][i & 1];
		const uint8_t *mask = ids->mask[i & 1];

		if (strncasecmp(at, from + 2, SERIAL) != 0)
			continue;
		/* the checksum stands on one side; the family, which stays, on the other */
		if (at >= begin + 2 && strncasecmp(at - 2, from, 2) == 0)
			change(at - 2, 2, mask);
		behind += *behind == '.';
		if (strncasecmp(behind, from + 14, 2) == 0)
			change(behind, 2, mask + 7);
		change(at, SERIAL, mask + 1);
		return true;
	}
	return false;
}

static void visit(struct ids *ids, char *text, bool replaces)
{
	for (char *at = text; *at; at++) {
		uint8_t rom[8];
		int err;
		size_t n = dotted(at, rom, &err);

		if (n && replaces)
			change(at, n > 15 ? 16 : 14, ids->mask[0]);
		else if (n && !err)
			collect(ids, rom);
		if (n)
			at += n - 1;
		else if (replaces && replace_known(ids, text, at))
			at += SERIAL - 1;
	}
}

/* Where two ids part, the mask has 0. */
static void keep_order(struct ids *ids)
{
	for (unsigned i = 0; i < ids->count; i++)
		for (unsigned k = 0; k < i; k++) {
			int byte = 0;

			while (ids->rom[i][byte] == ids->rom[k][byte])
				byte++;
			unsigned differ = ids->rom[i][byte] ^ ids->rom[k][byte];
			ids->mask[0][byte] &= (uint8_t) ~(differ & -differ);
		}
}

void trace_anonymous(char *text, const uint8_t mask[TRACE_MASK])
{
	static struct ids ids;

	memset(&ids, 0, sizeof(ids));
	visit(&ids, text, false);
	memcpy(ids.mask[0] + 1, mask, TRACE_MASK);
	keep_order(&ids);
	ids.mask[0][7] = rom_crc8(ids.mask[0], 7);
	turn(ids.mask[0], ids.mask[1]);
	visit(&ids, text, true);
}
