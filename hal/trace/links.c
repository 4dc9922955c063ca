/* SPDX-License-Identifier: MIT */
/*
 * Links in front of others, which record the calls, and links in place of them, which answer as
 * recorded. What a link has (link_ops, link_facts) stands in the line "link". It makes one
 * transaction after the other (no run_many), so that a replay is asked the same, and each search of
 * a wire is one call (path), so that its id stands in one line.
 */
#include <stdlib.h>
#include <string.h>

#include "hal/chips/area.h"
#include "hal/owfs/path.h"
#include "hal/trace/links.h"
#include "hal/wire/device.h"
#include "hal/wire/driver.h"
#include "hal/wire/search.h"

#define TOLD(link) ((struct trace_link *)(link))
#define CHIP_MAX 255
#define WORDS_MAX 100
#define ID(rom) id_text(rom, (char[ROM_TEXT_MAX]){0})

static const char *id_text(const uint8_t *rom, char text[ROM_TEXT_MAX])
{
	rom_print(rom, ROM_F_IC, text);
	return text;
}

static FILE *ask(struct link *link)
{
	return trace_ask(TOLD(link)->lines, link->env, &TOLD(link)->place);
}

/* most: as trace_told(). After an error the bytes mean nothing. */
static int answer(struct link *link, int most, int result, uint8_t *bytes, size_t n)
{
	n = result < 0 ? 0 : n;
	return trace_told(TOLD(link)->lines, most, result, bytes, &n);
}

static const char *after_word(enum link_after after)
{
	return after == LINK_STRONG ? " strong" : "";
}

/* Of a recording: what the link below answers to the question; ops: its table that has the call. */
#define UNDER(link, ops, call, ...) \
	(TOLD(link)->under ? TOLD(link)->under->ops->call(TOLD(link)->under, __VA_ARGS__) : 0)

/* The ids in it stand apart: that of a chip that is selected, and one that is read. */
static int told_run(struct link *link, const struct link_part *part)
{
	const uint8_t *out = part->out, first = part->reset && part->out_n ? out[0] : 0;
	size_t n = part->out_n;
	FILE *now = ask(link);

	fprintf(now, "run %c ", part->reset ? 'r' : '-');
	if (n >= 9 && (first == 0x55 || first == 0x69)) {
		fprintf(now, "%02X %s ", first, ID(out + 1));
		out += 9;
		n -= 9;
	}
	trace_bytes(now, out, n, TRACE_HEX);
	fprintf(now, " %zu%s", part->in_n, after_word(part->after));
	if (part->out_n == 1 && (first == 0x33 || first == 0x0f))
		TOLD(link)->lines->form = TRACE_IDS;
	return answer(link, 0, UNDER(link, ops, run, part), part->in, part->in_n);
}

static int told_recover(struct link *link, enum link_rung rung)
{
	fprintf(ask(link), "recover %d", (int)rung);
	return answer(link, 0, UNDER(link, ops, recover, rung), NULL, 0);
}

static int told_slot(struct link *link, bool out, enum link_after after)
{
	fprintf(ask(link), "slot %d%s", out, after_word(after));
	return answer(link, 1, UNDER(link, ops, slot, out, after), NULL, 0);
}

/*
 * The answer is the id, and it with all bits turned where devices differ. Directions are recorded
 * nowhere else: those of a search that begins are zeros, and would show how an id is changed.
 */
static int told_path(struct link *link, bool reset, uint8_t command, uint8_t rom[8],
                     uint8_t conflict[8])
{
	struct trace_link *told = TOLD(link);
	uint8_t both[16] = {0};
	int err = 0;

	fprintf(ask(link), "path %c %02X", reset ? 'r' : '-', command);
	told->lines->form = TRACE_IDS;
	told->lines->directions = rom;
	if (told->under)
		err = search_path(told->under, reset, command, rom, conflict);
	for (int i = 0; told->under && i < 8; i++) {
		both[i] = rom[i];
		both[i + 8] = rom[i] ^ conflict[i];
	}
	err = answer(link, 0, err, both, sizeof(both));
	for (int i = 0; i < 8; i++) {
		rom[i] = both[i];
		conflict[i] = both[i] ^ both[i + 8];
	}
	return err;
}

struct found {
	uint8_t rom[DEVICE_MAX * 8];
	size_t n;
};

static int note_found(void *ctx, const uint8_t rom[8])
{
	struct found *all = ctx;

	if (all->n == sizeof(all->rom))
		return -ENOSPC;
	memcpy(all->rom + all->n, rom, 8);
	all->n += 8;
	return 0;
}

static int told_search(struct link *link, bool alarm, uint8_t family, link_found *found, void *ctx)
{
	struct lines *lines = TOLD(link)->lines;
	struct found all = {.n = 0};
	int err, result = 0;

	fprintf(ask(link), "search %s %02X", alarm ? "alarm" : "all", family);
	lines->form = TRACE_IDS;
	if (TOLD(link)->under)
		TOLD(link)->under->whole = link->whole;
	err = UNDER(link, ops, search, alarm, family, note_found, &all);
	all.n = TOLD(link)->under ? all.n : sizeof(all.rom);
	err = trace_told(lines, 0, err, all.rom, &all.n);
	for (size_t i = 0; i + 8 <= all.n && !result; i += 8)
		result = found(ctx, all.rom + i);
	return err < 0 ? err : result;
}

static int told_verify(struct link *link, const uint8_t rom[8], bool alarm)
{
	fprintf(ask(link), "verify %s %s", alarm ? "alarm" : "all", ID(rom));
	return answer(link, 1, UNDER(link, ops, verify, rom, alarm), NULL, 0);
}

/* --- Drivers --- */

static bool told_has(struct link *link, const uint8_t rom[8])
{
	fprintf(ask(link), "has %s", ID(rom));
	return answer(link, 1, UNDER(link, driver, has, rom), NULL, 0) > 0;
}

static bool told_offers(struct link *link, const uint8_t rom[8], const char *property, int element)
{
	fprintf(ask(link), "offers %s %d %s", property, element, ID(rom));
	return answer(link, 1, UNDER(link, driver, offers, rom, property, element), NULL, 0) > 0;
}

static int told_area_read(struct link *link, const uint8_t rom[8], const struct area *area,
                          unsigned at, uint8_t *bytes, unsigned n)
{
	fprintf(ask(link), "area %s %u %u %s", area->name, at, n, ID(rom));
	return answer(link, 0, UNDER(link, driver, area_read, rom, area, at, bytes, n), bytes, n);
}

static int told_area_write(struct link *link, const uint8_t rom[8], const struct area *area,
                           unsigned at, const uint8_t *bytes, unsigned n)
{
	FILE *now = ask(link);

	fprintf(now, "write %s %u %s ", area->name, at, ID(rom));
	trace_bytes(now, bytes, n, TRACE_HEX);
	return answer(link, 0, UNDER(link, driver, area_write, rom, area, at, bytes, n), NULL, 0);
}

static int told_convert(struct link *link, const uint8_t *rom, const char *what)
{
	fprintf(ask(link), "convert %s %s", what, rom ? ID(rom) : "-");
	return answer(link, 0, UNDER(link, driver, convert, rom, what), NULL, 0);
}

static const struct driver_ops told_driver = {
	.has = told_has,
	.offers = told_offers,
	.area_read = told_area_read,
	.area_write = told_area_write,
	.convert = told_convert,
};

/* --- What a link has: a word in its line, a member, and what that is here --- */

#define WORDS(X) \
	X(strong, facts.strong, true) \
	X(splits, facts.splits, true) \
	X(recover, ops.recover, told_recover) \
	X(slot, ops.slot, told_slot) \
	X(path, ops.path, told_path) \
	X(search, ops.search, told_search) \
	X(verify, ops.verify, told_verify) \
	X(driver, link.driver, &told_driver)

/* The result is the number of the chip. */
static void take_words(struct trace_link *told, const struct trace_link *like)
{
	char words[WORDS_MAX] = "";
	size_t n = 0;

#define X(word, member, mine) \
	if (like->member) \
		n += (size_t)sprintf(words + n, " " #word);
	WORDS(X)
#undef X
	fputs("link", ask(&told->link));
	told->lines->form = TRACE_TEXT;
	n = told->lines->trace.file ? n : sizeof(words) - 1;
	told->link.chip = (unsigned)trace_told(told->lines, CHIP_MAX, (int)like->link.chip,
	                                       (uint8_t *)words, &n);
	words[n] = '\0';
#define X(word, member, mine) \
	if (strstr(words, " " #word)) \
		told->member = mine;
	WORDS(X)
#undef X
}

struct link *trace_link_of(struct tap *tap, unsigned n, struct link *link)
{
	struct lines *lines = (struct lines *)tap;
	struct trace_link *told, like = {.ops.name = "replay"};

	if (n >= TRACE_LINKS)
		return link;
	told = &lines->link[n];
	if (lines->trace.file)
		like = (struct trace_link){
			.link = *link, .ops = *link->ops, .facts = *link->facts, .under = link};
	/* Searches made of single slots would show ids bit by bit */
	if (!like.ops.search && (like.ops.triplet || like.ops.slot))
		like.ops.path = told_path;
	*told = (struct trace_link){.link.env = link->env,
	                            .link.ops = &told->ops,
	                            .link.facts = &told->facts,
	                            .ops.name = like.ops.name,
	                            .ops.run = told_run,
	                            .under = like.under,
	                            .lines = lines,
	                            .place.last = told->place.last};
	snprintf(told->place.name, sizeof(told->place.name), "%u", n);
	take_words(told, &like);
	return &told->link;
}
