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
#include <string.h>
#include <strings.h>

#include "hal/owfs/path.h"
#include "hal/trace/anonymous.h"
#include "hal/trace/trace.h"
#include "hal/wire/crc.h"
#include "hal/wire/device.h"

#define SERIAL 12 /* its digits */
#define SEQUENCE 2048

struct ids {
	bool replaces; /* else they are collected */
	uint8_t rom[DEVICE_MAX][8], mask[8];
	unsigned count;
	struct {
		uint8_t rom[8];
		unsigned position; /* of the next triplet */
	} search[TRACE_NET];
};

static void put_hex(char *text, const uint8_t *bytes, size_t n)
{
	static const char digits[] = "0123456789ABCDEF";

	for (size_t i = 0; i < n; i++) {
		text[2 * i] = digits[bytes[i] >> 4];
		text[2 * i + 1] = digits[bytes[i] & 15];
	}
}

static void collect(struct ids *ids, const uint8_t rom[8])
{
	for (unsigned i = 0; i < ids->count; i++)
		if (memcmp(ids->rom[i], rom, 8) == 0)
			return;
	if (ids->count < DEVICE_MAX && onewire_rom_valid(rom))
		memcpy(ids->rom[ids->count++], rom, 8);
}

/* Where a line has digits, a text is no recording of owsctl, and has not their length. */
static size_t parse(const char *digits, uint8_t *bytes, size_t n)
{
	return *digits == '"' ? 0 : trace_parse(digits, bytes, n);
}

/* Here the line has an id. */
static void visit(struct ids *ids, char *digits)
{
	uint8_t rom[8];

	if (parse(digits, rom, 8) != 8)
		return;
	if (!ids->replaces)
		collect(ids, rom);
	for (int i = 0; i < 8; i++)
		rom[i] ^= ids->mask[i];
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
static void collect_paths(struct ids *ids, const char *text)
{
	for (const char *dot = text; (dot = strchr(dot, '.')); dot++) {
		uint8_t rom[8];

		if (dot < text + 2 || parse(dot - 2, rom, 1) != 1 ||
		    parse(dot + 1, rom + 1, 6) != 6)
			continue;
		rom[7] = rom_crc8(rom, 7);
		collect(ids, rom);
	}
}

/*
 * Data that have changed get right checksums where they had some: a CRC16 behind what was written
 * and read, and behind each further block; a CRC8 of what was read.
 */
static void mend_checks(const uint8_t *was, uint8_t *is, size_t sent, size_t n)
{
	uint16_t old = 0, made = 0;

	for (size_t i = 0; i + 2 < n; i++) {
		old = onewire_crc16(old, was + i, 1);
		made = onewire_crc16(made, is + i, 1);
		if (i + 1 < sent || !onewire_crc16_matches(old, was + i + 1))
			continue;
		is[++i] = (uint8_t)~made;
		is[++i] = (uint8_t)(~made >> 8);
		old = made = 0;
	}
	if (n > sent && rom_crc8(was + sent, n - sent - 1) == was[n - 1])
		is[n - 1] = rom_crc8(is + sent, n - sent - 1);
}

/* The digits of each known id, from its first byte on or from its last. */
static void replace_known(const struct ids *ids, char *text)
{
	for (unsigned i = 0; i < 2 * ids->count; i++) {
		uint8_t rom[8], other[8];
		char from[16], to[16];

		for (int k = 0; k < 8; k++) {
			int byte = i & 1 ? 7 - k : k;

			rom[k] = ids->rom[i / 2][byte];
			other[k] = rom[k] ^ ids->mask[byte];
		}
		put_hex(from, rom, 8);
		put_hex(to, other, 8);
		for (char *at = text; *at; at++) {
			if (strncasecmp(at, from + 2, SERIAL) != 0)
				continue;
			memcpy(at, to + 2, SERIAL);
			/* the checksum stands on one side; the family, which stays, on the other */
			if (at >= text + 2 && strncasecmp(at - 2, from, 2) == 0)
				memcpy(at - 2, to, 2);
			if (strncasecmp(at + SERIAL, from + 14, 2) == 0)
				memcpy(at + SERIAL, to + 14, 2);
		}
	}
}

static void visit_text(struct ids *ids, char *text)
{
	if (ids->replaces)
		replace_known(ids, text);
	else
		collect_paths(ids, text);
}

/* Bytes that a part writes after the ROM command, and then reads; sent: how many it writes. */
static size_t get_bytes(const struct trace_line *line, uint8_t *bytes, size_t *sent)
{
	const char *out = line->question + strlen("run r ");
	size_t skipped = begins(line->question, "run -")          ? 0
	                 : begins(out, "55") || begins(out, "69") ? 18
	                                                          : 2;

	*sent = strcspn(out, " ") < skipped ? 0 : parse(out + skipped, bytes, SEQUENCE);
	return *sent + parse(line->bytes, bytes + *sent, SEQUENCE - *sent);
}

/* Where the ids of a line are, but those in its texts. */
static void visit_ids(struct ids *ids, const struct trace_line *line)
{
	static const char *const answers[] = {"run r 33 ", "run r 0F ", "path ", "search "};
	char *question = line->question, *bytes = line->bytes;
	size_t len = strlen(question);

	if (begins(question, "run r 55") || begins(question, "run r 69"))
		visit(ids, question + 8);
	else if (!begins(question, "run ") && len > 16)
		visit(ids, question + len - 16);
	for (size_t i = 0; i < sizeof(answers) / sizeof(answers[0]); i++)
		if (begins(question, answers[i]))
			visit(ids, bytes);
	while (begins(question, "search ") && strlen(bytes) > 16)
		visit(ids, bytes += 16);
	if (line->place >= TRACE_NET)
		return;
	if (begins(question, "run r "))
		ids->search[line->place].position = 0;
	if (begins(question, "triplet"))
		visit_triplet(ids, line->place, line->answer);
}

static void visit_line(struct ids *ids, char *text)
{
	static uint8_t was[SEQUENCE], is[SEQUENCE];
	struct trace_line line;
	size_t sent = 0, n = 0, len;

	if (!trace_cut(text, &line)) {
		visit_text(ids, text);
		return;
	}
	len = strlen(line.question);
	if (begins(line.question, "run ") && len > strlen("run r "))
		n = get_bytes(&line, was, &sent);
	visit_ids(ids, &line);
	visit_text(ids, line.question);
	visit_text(ids, line.answer);
	if (n && get_bytes(&line, is, &sent) == n && memcmp(was, is, n) != 0) {
		mend_checks(was, is, sent, n);
		put_hex(line.bytes, is + sent, n - sent);
	}
	line.question[-1] = line.question[len] = ' ';
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
