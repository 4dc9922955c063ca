/* SPDX-License-Identifier: MIT */
/*
 * Links in front of others, which record the calls, and links in place of them, which answer as
 * recorded. What a link has (link_ops, link_facts) stands in the line "link". It makes one
 * transaction after the other (no run_many), so that a replay is asked the same.
 */
#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include "hal/chips/area.h"
#include "hal/owfs/path.h"
#include "hal/trace/links.h"
#include "hal/wire/device.h"
#include "hal/wire/driver.h"
#include "hal/wire/link.h"

struct trace_link {
	struct link link; /* first */
	struct link_ops ops;
	struct link_facts facts;
	struct link *under; /* NULL: it is replayed */
	struct trace *trace;
	unsigned number;
	struct trace_link *next;
};

#define TOLD(link) ((struct trace_link *)(link))
#define ASK(link, ...) trace_ask(TOLD(link)->trace, (link)->env, TOLD(link)->number, __VA_ARGS__)
#define SAY(link, ...) trace_add(&TOLD(link)->trace->question, __VA_ARGS__)
/* Of a recording: what the link below answers to the question; ops: its table that has the call. */
#define UNDER(link, ops, call, ...) \
	(TOLD(link)->under ? TOLD(link)->under->ops->call(TOLD(link)->under, __VA_ARGS__) : 0)
#define ID(rom) id_text(rom, (char[ROM_TEXT_MAX]){0})

static const char *id_text(const uint8_t *rom, char text[ROM_TEXT_MAX])
{
	rom_print(rom, ROM_FIC, text);
	return text;
}

static void say_bytes(struct link *link, const uint8_t *bytes, size_t n)
{
	trace_bytes(&TOLD(link)->trace->question, bytes, n, false);
}

/* most: as trace_told(). After an error the bytes mean nothing. */
static int answer(struct link *link, int most, int result, uint8_t *bytes, size_t n)
{
	n = result < 0 ? 0 : n;
	return trace_told(TOLD(link)->trace, most, result, bytes, &n);
}

static const char *after_word(enum link_after after)
{
	return after == LINK_STRONG ? " strong" : "";
}

static int told_run(struct link *link, const struct link_part *part)
{
	ASK(link, part->reset ? "run r " : "run - ");
	say_bytes(link, part->out, part->out_n);
	SAY(link, " %zu%s", part->in_n, after_word(part->after));
	return answer(link, 0, UNDER(link, ops, run, part), part->in, part->in_n);
}

static int told_recover(struct link *link, enum link_rung rung)
{
	ASK(link, "recover %d", (int)rung);
	return answer(link, 0, UNDER(link, ops, recover, rung), NULL, 0);
}

static int told_slot(struct link *link, bool out, enum link_after after)
{
	ASK(link, "slot %d%s", out, after_word(after));
	return answer(link, 1, UNDER(link, ops, slot, out, after), NULL, 0);
}

/* What is taken says which direction was asked for, where it counts: see anonymous.c. */
static int told_triplet(struct link *link, bool direction)
{
	struct trace *trace = TOLD(link)->trace;
	int bits;

	ASK(link, "triplet");
	trace->directions[0] = direction;
	trace->direction_n = 1;
	bits = UNDER(link, ops, triplet, direction);
	return answer(link, 7, bits >= 0 && (bits & 3) == 3 ? 7 : bits, NULL, 0);
}

static int told_path(struct link *link, bool reset, uint8_t command, uint8_t rom[8],
                     uint8_t conflict[8])
{
	struct trace *trace = TOLD(link)->trace;
	uint8_t both[16] = {0};
	int err;

	ASK(link, "path %c %02X", reset ? 'r' : '-', command);
	memcpy(trace->directions, rom, 8);
	trace->direction_n = 8;
	memcpy(both, rom, 8);
	err = UNDER(link, ops, path, reset, command, both, both + 8);
	err = answer(link, 0, err, both, sizeof(both));
	memcpy(rom, both, 8);
	memcpy(conflict, both + 8, 8);
	return err;
}

struct found {
	struct trace *trace;
	link_found *found;
	void *ctx;
};

static int note_found(void *ctx, const uint8_t rom[8])
{
	struct found *all = ctx;

	trace_bytes(&all->trace->answer, rom, 8, false);
	return all->found(all->ctx, rom);
}

static int told_search(struct link *link, bool alarm, uint8_t family, link_found *found, void *ctx)
{
	struct found all = {TOLD(link)->trace, found, ctx};
	uint8_t roms[DEVICE_MAX * 8];
	size_t n = TOLD(link)->under ? 0 : sizeof(roms);
	int result, err;

	ASK(link, "search %s %02X", alarm ? "alarm" : "all", family);
	result = UNDER(link, ops, search, alarm, family, note_found, &all);
	err = trace_told(all.trace, INT_MAX, result, roms, &n);
	for (size_t i = 0; i + 8 <= n && !result; i += 8)
		result = found(ctx, roms + i);
	return err < 0 ? err : result;
}

static int told_verify(struct link *link, const uint8_t rom[8], bool alarm)
{
	ASK(link, "verify %s %s", alarm ? "alarm" : "all", ID(rom));
	return answer(link, 1, UNDER(link, ops, verify, rom, alarm), NULL, 0);
}

/* --- Drivers --- */

static bool told_has(struct link *link, const uint8_t rom[8])
{
	ASK(link, "has %s", ID(rom));
	return answer(link, 1, UNDER(link, driver, has, rom), NULL, 0) > 0;
}

static bool told_offers(struct link *link, const uint8_t rom[8], const char *property, int element)
{
	ASK(link, "offers %s %d %s", property, element, ID(rom));
	return answer(link, 1, UNDER(link, driver, offers, rom, property, element), NULL, 0) > 0;
}

static int told_area_read(struct link *link, const uint8_t rom[8], const struct area *area,
                          unsigned at, uint8_t *bytes, unsigned n)
{
	ASK(link, "area %s %u %u %s", area->name, at, n, ID(rom));
	return answer(link, 0, UNDER(link, driver, area_read, rom, area, at, bytes, n), bytes, n);
}

static int told_area_write(struct link *link, const uint8_t rom[8], const struct area *area,
                           unsigned at, const uint8_t *bytes, unsigned n)
{
	ASK(link, "write %s %u ", area->name, at);
	say_bytes(link, bytes, n);
	SAY(link, " %s", ID(rom));
	return answer(link, 0, UNDER(link, driver, area_write, rom, area, at, bytes, n), NULL, 0);
}

static int told_convert(struct link *link, const uint8_t *rom, const char *what)
{
	ASK(link, "convert %s %s", what, rom ? ID(rom) : "-");
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
	X(triplet, ops.triplet, told_triplet) \
	X(path, ops.path, told_path) \
	X(search, ops.search, told_search) \
	X(verify, ops.verify, told_verify) \
	X(driver, link.driver, &told_driver)

static void record_link(struct trace_link *told, struct link *under)
{
	const struct trace_link like = {.link = *under, .ops = *under->ops, .facts = *under->facts};

	told->ops.name = under->ops->name;
	told->link.chip = under->chip;
	ASK(&told->link, "link %u", under->chip);
#define X(word, member, mine) \
	if (like.member) { \
		SAY(told, " " #word); \
		told->member = mine; \
	}
	WORDS(X)
#undef X
	answer(&told->link, 0, 0, NULL, 0);
	told->under = under;
}

static void replay_link(struct trace_link *told)
{
	size_t first = told->trace->first[told->number];
	const char *question = told->trace->line[first - 1].question;

	told->ops.name = "replay";
	told->link.chip = (unsigned)strtoul(question + 5, NULL, 10);
#define X(word, member, mine) \
	if (strstr(question, " " #word)) \
		told->member = mine;
	WORDS(X)
#undef X
	/* The line of the link is no call */
	told->trace->last[told->number] = first;
}

struct link *trace_link_of(struct tap *tap, unsigned n, struct link *link)
{
	struct trace *trace = (struct trace *)tap;
	struct trace_link *told = trace->links;

	if (n >= (trace->file ? TRACE_NET : trace_link_count(trace)))
		return link;
	while (told && told->number != n)
		told = told->next;
	if (!told) {
		told = calloc(1, sizeof(*told));
		if (!told)
			return link;
		told->next = trace->links;
		trace->links = told;
	}
	*told = (struct trace_link){.link.env = link->env,
	                            .link.ops = &told->ops,
	                            .link.facts = &told->facts,
	                            .ops.run = told_run,
	                            .trace = trace,
	                            .number = n,
	                            .next = told->next};
	if (trace->file)
		record_link(told, link);
	else
		replay_link(told);
	return &told->link;
}

void trace_links_free(struct trace *trace)
{
	for (struct trace_link *told = trace->links, *next; told; told = next) {
		next = told->next;
		free(told);
	}
	trace->links = NULL;
}
