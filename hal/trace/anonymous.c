/* SPDX-License-Identifier: MIT */
/*
 * Other ids in a recording. All are changed by the same bits, a mask: then bits in which ids differ
 * are the same as before, and the CRC8, which is linear, is right with that of the mask. Where two
 * ids part the mask has 0, so that a search that takes 0 first finds them in the same order.
 *
 * Where a line has an id, or the bits of one, the mask is put over it; elsewhere the digits of each
 * known id are replaced. Directions of searches are not recorded but where devices differ: those of
 * a search that begins are zeros, and would give away the mask.
 */
#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "hal/owfs/path.h"
#include "hal/trace/anonymous.h"
#include "hal/trace/trace.h"
#include "hal/wire/crc.h"
#include "hal/wire/device.h"

#define LINKS 64
#define SERIAL 12 /* its digits */
#define SEQUENCE 2048

struct ids {
	bool replaces; /* else they are collected */
	uint8_t rom[DEVICE_MAX][8], mask[8];
	unsigned count;
	struct {
		uint8_t rom[8];
		unsigned position; /* of the next triplet */
	} search[LINKS];
};

static void put_hex(char *text, const uint8_t *bytes, size_t n)
{
	static const char digits[] = "0123456789ABCDEF";

	for (size_t i = 0; i < n; i++) {
		text[2 * i] = digits[bytes[i] >> 4];
		text[2 * i + 1] = digits[bytes[i] & 15];
	}
}

static void put_mask(const struct ids *ids, uint8_t rom[8])
{
	for (int i = 0; i < 8; i++)
		rom[i] ^= ids->mask[i];
}

static void collect(struct ids *ids, const uint8_t rom[8])
{
	for (unsigned i = 0; i < ids->count; i++)
		if (memcmp(ids->rom[i], rom, 8) == 0)
			return;
	if (ids->count < DEVICE_MAX && onewire_rom_valid(rom))
		memcpy(ids->rom[ids->count++], rom, 8);
}

/* Here the line has an id. */
static void visit(struct ids *ids, char *digits)
{
	uint8_t rom[8];

	if (trace_parse(digits, rom, 8) != 8)
		return;
	if (!ids->replaces) {
		collect(ids, rom);
		return;
	}
	put_mask(ids, rom);
	put_hex(digits, rom, 8);
}

/* The next bit of an id: what is taken, and the two that were read. */
static void visit_triplet(struct ids *ids, unsigned link, char *bits)
{
	unsigned position = ids->search[link].position++ % 64, byte = position / 8;
	unsigned read = (unsigned)(*bits - '0'), bit = 1u << position % 8;

	if (read > 6)
		return;
	if (ids->replaces && ids->mask[byte] & bit) {
		*bits = (char)('0' + (read & 3 ? read ^ 7 : read ^ 4));
		return;
	}
	if (!position)
		memset(ids->search[link].rom, 0, 8);
	ids->search[link].rom[byte] |= (uint8_t)(read >> 2 ? bit : 0);
	if (!ids->replaces && position == 63)
		collect(ids, ids->search[link].rom);
}

static bool begins(const char *text, const char *with)
{
	return strncmp(text, with, strlen(with)) == 0;
}

/* Ids as a path has them, 28.551DDF030000. */
static void collect_paths(struct ids *ids, const char *line)
{
	for (const char *dot = line; (dot = strchr(dot, '.')); dot++) {
		uint8_t rom[8];

		if (dot < line + 2 || trace_parse(dot - 2, rom, 1) != 1 ||
		    trace_parse(dot + 1, rom + 1, 6) != 6)
			continue;
		rom[7] = rom_crc8(rom, 7);
		collect(ids, rom);
	}
}

/* The two checksums behind data that have changed are made anew where they were right. */
static void mend_checks(const uint8_t *was, uint8_t *is, size_t sent, size_t n)
{
	for (size_t begin = 0; begin < n; begin++)
		for (size_t end = begin + 1; end + 2 <= n; end++) {
			size_t len = end - begin;
			uint16_t crc = (uint16_t)~onewire_crc16(0, is + begin, len);

			if (end < sent || memcmp(was + begin, is + begin, len) == 0 ||
			    !onewire_crc16_matches(onewire_crc16(0, was + begin, len), was + end))
				continue;
			is[end] = (uint8_t)crc;
			is[end + 1] = (uint8_t)(crc >> 8);
		}
	if (n > sent && rom_crc8(was + sent, n - sent - 1) == was[n - 1])
		is[n - 1] = rom_crc8(is + sent, n - sent - 1);
}

/* The digits of each known id, from its first byte on or from its last, with its checksum. */
static void replace_known(const struct ids *ids, char *line)
{
	for (unsigned i = 0; i < ids->count; i++) {
		uint8_t from[8], to[8], back[2][8];
		char text[2][17] = {0}, other[2][17] = {0};

		memcpy(from, ids->rom[i], 8);
		memcpy(to, from, 8);
		put_mask(ids, to);
		for (int k = 0; k < 8; k++) {
			back[0][k] = from[7 - k];
			back[1][k] = to[7 - k];
		}
		put_hex(text[0], from, 8);
		put_hex(other[0], to, 8);
		put_hex(text[1], back[0], 8);
		put_hex(other[1], back[1], 8);
		for (char *at = line; *at; at++)
			for (int way = 0; way < 2; way++) {
				char *check = way ? at - 2 : at + SERIAL;
				int of = way ? 0 : 14;

				if (strncasecmp(at, text[way] + 2, SERIAL) != 0)
					continue;
				memcpy(at, other[way] + 2, SERIAL);
				if (check >= line && strncasecmp(check, text[way] + of, 2) == 0)
					memcpy(check, other[way] + of, 2);
			}
	}
}

static void visit_text(struct ids *ids, char *line)
{
	if (ids->replaces)
		replace_known(ids, line);
	else
		collect_paths(ids, line);
}

/* Bytes that are written and then read by a part; sent: how many are written, without the id. */
static size_t get_bytes(const char *question, const char *answer, uint8_t *bytes, size_t *sent)
{
	const char *out = question + strlen("run r ");
	bool selects = begins(out, "55") && strcspn(out, " ") >= 18;
	size_t n;

	*sent = trace_parse(out + (selects ? 18 : 0), bytes, SEQUENCE);
	n = *sent;
	answer += strcspn(answer, " ");
	answer += *answer != 0;
	/* a run answers in digits; a text in its place is no recording of owsctl */
	return *answer == '"' ? n : n + trace_parse(answer, bytes + n, SEQUENCE - n);
}

static void visit_line(struct ids *ids, char *line)
{
	static const char *const ends[] = {"verify ", "has ",   "offers ",
	                                   "area ",   "write ", "convert "};
	static uint8_t was[SEQUENCE], is[SEQUENCE];
	char *place = strchr(line, ' '), *arrow = strstr(line, " > "), *question, *answer;
	size_t sent = 0, n = 0;
	unsigned link;

	place = place ? strchr(place + 1, ' ') : NULL;
	question = place ? strchr(place + 1, ' ') : NULL;
	if (*line == '#') {
		visit_text(ids, line);
		return;
	}
	if (!question || !arrow || arrow < ++question)
		return;
	link = isdigit((unsigned char)place[1]) ? (unsigned)strtoul(place + 1, NULL, 10) : LINKS;
	answer = arrow + 3 + strcspn(arrow + 3, " ");
	answer += *answer != 0;
	if (begins(question, "run "))
		n = get_bytes(question, arrow + 3, was, &sent);
	if (begins(question, "run r ") && link < LINKS)
		ids->search[link].position = 0;
	if (begins(question, "run r 55") || begins(question, "run r 69"))
		visit(ids, question + 8);
	if (begins(question, "run r 33 ") || begins(question, "path ") ||
	    begins(question, "run r 0F "))
		visit(ids, answer);
	for (; begins(question, "search ") && strlen(answer) >= 16; answer += 16)
		visit(ids, answer);
	for (size_t i = 0; i < sizeof(ends) / sizeof(ends[0]); i++)
		if (begins(question, ends[i]) && arrow - question > 16)
			visit(ids, arrow - 16);
	if (begins(question, "triplet") && link < LINKS)
		visit_triplet(ids, link, arrow + 3);
	visit_text(ids, line);
	if (!ids->replaces || !n || get_bytes(question, arrow + 3, is, &sent) != n ||
	    memcmp(was, is, n) == 0)
		return;
	mend_checks(was, is, sent, n);
	put_hex(arrow + 3 + strcspn(arrow + 3, " ") + 1, is + sent, n - sent);
}

static void visit_all(struct ids *ids, char *text)
{
	for (char *end; *text; text = end) {
		end = text + strcspn(text, "\n");
		char kept = *end;

		*end = '\0';
		visit_line(ids, text);
		*end = kept;
		end += kept != 0;
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
			ids->mask[byte] &= (uint8_t) ~(differ & -differ);
		}
}

void trace_anonymous(char *text, const uint8_t mask[TRACE_MASK])
{
	static struct ids ids;

	ids = (struct ids){0};
	visit_all(&ids, text);
	memcpy(ids.mask + 1, mask, TRACE_MASK);
	keep_order(&ids);
	ids.mask[7] = rom_crc8(ids.mask, 7);
	ids.replaces = true;
	visit_all(&ids, text);
}
