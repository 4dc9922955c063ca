/* SPDX-License-Identifier: MIT */
/* Which readings of an owserver no chip can have measured, and which prove nothing. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/time.h"
#include "hal/chips/facts.h"
#include "hal/chips/format.h"
#include "hal/owfs/path.h"
#include "hal/owserver/judge.h"

#define NUMBER_ROOM 40
#define NEAR_DEGREES 5.0
#define RECENT_NS (60 * NS_PER_S)

/*
 * 127.9375 in any rounding, from 127.9 to 128: nothing in there comes from a chip that measures
 * up to 125. What is above is no rounding of it: the range of the chip excludes that, and an alias
 * may be that of a chip which measures it.
 */
#define STARVED_LEAST 127.8995
#define STARVED_MOST 128.0005

bool guard_refuses(struct guard *guard, double degrees, int64_t now_ns)
{
	bool near;

	if (degrees > STARVED_LEAST && degrees < STARVED_MOST)
		return true;
	near = guard->last_ns && now_ns - guard->last_ns <= RECENT_NS &&
	       fabs(guard->last - 85.0) <= NEAR_DEGREES;
	if (fabs(degrees - 85.0) < 0.0005 && !near)
		return true;
	guard->last = degrees;
	guard->last_ns = now_ns;
	return false;
}

/* What a thermometer read last, by any of its properties. An alias counts for itself. */
static struct guard *guard_of(struct judge *judge, const char *path)
{
	uint64_t device = UINT64_C(0xcbf29ce484222325);
	struct path split;

	if (path_split(path, strlen(path), &split))
		return &judge->place[0][0].guard;
	const uint8_t *byte = split.has_rom ? split.rom : (const uint8_t *)split.last.text;
	size_t len = split.has_rom ? sizeof(split.rom) : split.last.len;

	for (size_t i = 0; i < len; i++)
		device = (device ^ byte[i]) * UINT64_C(0x100000001b3);
	struct judge_place *row = judge->place[(device ^ device >> 32) % JUDGE_ROWS], *oldest = row;

	for (unsigned i = 0; i < JUDGE_PLACES; i++) {
		if (row[i].device == device)
			return &row[i].guard;
		if (row[i].guard.last_ns < oldest->guard.last_ns)
			oldest = &row[i];
	}
	*oldest = (struct judge_place){.device = device};
	return &oldest->guard;
}

/* The number that is the whole text, but for blanks and what ends it; false: it is none. */
static bool as_number(const char *text, size_t len, double *number)
{
	char copy[NUMBER_ROOM], *end;

	len = text_end(text, len);
	if (!len || len >= sizeof(copy) || memchr(text, '\0', len))
		return false;
	memcpy(copy, text, len);
	copy[len] = '\0';
	*number = strtod(copy, &end);
	return *end == '\0';
}

int judge_reading(struct judge *judge, const char *path, const char *text, size_t len,
                  bool simulated, int64_t now_ns, double *number)
{
	struct quantity quantity;
	const char *part;
	size_t part_len;

	if (!quantity_of(path, &quantity))
		return 0;
	for (unsigned n = 0; list_part(text, len, n, &part, &part_len); n++) {
		if (!as_number(part, part_len, number))
			continue;
		if (!simulated && quantity_excludes(&quantity, *number))
			return -EDOM;
		if (quantity.starves && guard_refuses(guard_of(judge, path), *number, now_ns))
			return -ERANGE;
	}
	return 0;
}

/* owserver checks a checksum, or complements, of what these are asked for again and again. */
static const uint8_t checked[] = {0x10, 0x12, 0x1d, 0x20, 0x22, 0x26, 0x28, 0x29, 0x3a, 0x3b, 0x42};

/* ... but for these, of any family (0) or of one: pulled out, each was read as ones (3.2p4). */
static const struct {
	uint8_t family;
	const char *begin;
} unchecked[] = {{0, "power"},          {0, "errata/"},   {0x12, "memory"},
                 {0x12, "pages/page"},  {0x3b, "memory"}, {0x3b, "pages/page"},
                 {0x26, "S3-R1-A/gain"}};

static bool begins_with(struct path_slice slice, const char *begin)
{
	return slice.len >= strlen(begin) && memcmp(slice.text, begin, strlen(begin)) == 0;
}

bool proof_is_needed(const char *path)
{
	struct path split;

	if (path_split(path, strlen(path), &split) || !split.last.len || !split.property.len ||
	    (begins_with(split.property, "present") && split.property.len == strlen("present")))
		return false;
	if (!split.has_rom || !memchr(checked, split.rom[0], sizeof(checked)))
		return true;
	for (size_t i = 0; i < sizeof(unchecked) / sizeof(*unchecked); i++)
		if ((!unchecked[i].family || unchecked[i].family == split.rom[0]) &&
		    begins_with(split.property, unchecked[i].begin))
			return true;
	return false;
}
