/* SPDX-License-Identifier: MIT */
/*
 * Links in front of others, which record the calls, and links in place of them, which answer as
 * recorded. What a link has (link_ops, link_facts) stands in the line "link". It makes one
 * transaction after the other (no run_many), so that a replay is asked the same.
 */
#include <stdlib.h>
#include <string.h>

#include "hal/chips/area.h"
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
	struct trace_place place;
	unsigned number;
	struct trace_link *next;
};

enum { STRONG, SPLITS, RECOVER, SLOT, TRIPLET, PATH, SEARCH, VERIFY, DRIVER, WORDS };
static const char *const words[WORDS] = {"strong", "splits", "recover", "slot",  "triplet",
                                         "path",   "search", "verify",  "driver"};

#define ASK(told, ...) trace_ask((told)->trace, (told)->link.env, __VA_ARGS__)
/* Of a recording: what the link below answers to the question. */
#define UNDER(told, call, ...) \
	((told)->under ? (told)->under->ops->call((told)->under, __VA_ARGS__) : 0)
#define DRIVEN(told, call, ...) \
	((told)->under ? (told)->under->driver->call((told)->under, __VA_ARGS__) : 0)

static struct trace_link *told_of(struct link *link)
{
	return (struct trace_link *)link;
}

static void add_bytes(struct trace_link *told, const uint8_t *bytes, size_t n)
{
	trace_bytes(&told->trace->question, bytes, n, false);
}

/* After an error the bytes mean nothing. */
static int answer_bytes(struct trace_link *told, int result, uint8_t *bytes, size_t n)
{
	n = result < 0 ? 0 : n;
	return trace_told(told->trace, told->link.env, &told->place, result, bytes, &n);
}

static int answer(struct trace_link *told, int result)
{
	return answer_bytes(told, result, NULL, 0);
}

static const char *after_word(enum link_after after)
{
	return after == LINK_STRONG ? " strong" : "";
}

static int told_run(struct link *link, const struct link_part *part)
{
	struct trace_link *told = told_of(link);

	ASK(told, part->reset ? "run r " : "run - ");
	add_bytes(told, part->out, part->out_n);
	trace_add(&told->trace->question, " %zu%s", part->in_n, after_word(part->after));
	return answer_bytes(told, UNDER(told, run, part), part->in, part->in_n);
}

static int told_recover(struct link *link, enum link_rung rung)
{
	struct trace_link *told = told_of(link);

	ASK(told, "recover %d", (int)rung);
	return answer(told, UNDER(told, recover, rung));
}

static int told_slot(struct link *link, bool out, enum link_after after)
{
	struct trace_link *told = told_of(link);

	ASK(told, "slot %d%s", out, after_word(after));
	return answer(told, UNDER(told, slot, out, after));
}

/* What is taken says which direction was asked for, where it counts: see anonymous.c. */
static int told_triplet(struct link *link, bool direction)
{
	struct trace_link *told = told_of(link);
	uint8_t asked = direction;

	ASK(told, "triplet");
	int bits = UNDER(told, triplet, direction);
	told->place.directions = &asked;
	told->place.direction_n = 1;
	bits = answer(told, bits >= 0 && (bits & 3) == 3 ? 7 : bits);
	told->place.direction_n = 0;
	return bits;
}

static int told_path(struct link *link, uint8_t command, uint8_t rom[8], uint8_t conflict[8])
{
	struct trace_link *told = told_of(link);
	uint8_t both[16] = {0}, asked[8];

	memcpy(asked, rom, sizeof(asked));
	ASK(told, "path %02X", command);
	int err = UNDER(told, path, command, rom, conflict);
	if (told->under && !err) {
		memcpy(both, rom, 8);
		memcpy(both + 8, conflict, 8);
	}
	told->place.directions = asked;
	told->place.direction_n = sizeof(asked);
	err = answer_bytes(told, err, both, sizeof(both));
	told->place.direction_n = 0;
	memcpy(rom, both, 8);
	memcpy(conflict, both + 8, 8);
	return err;
}

struct found {
	link_found *found;
	void *ctx;
	uint8_t roms[DEVICE_MAX * 8];
	size_t n;
};

static int note_found(void *ctx, const uint8_t rom[8])
{
	struct found *found = ctx;

	if (found->n + 8 <= sizeof(found->roms)) {
		memcpy(found->roms + found->n, rom, 8);
		found->n += 8;
	}
	return found->found(found->ctx, rom);
}

static int told_search(struct link *link, bool alarm, uint8_t family, link_found *found, void *ctx)
{
	struct trace_link *told = told_of(link);
	struct found all = {.found = found, .ctx = ctx};
	size_t n = sizeof(all.roms);

	ASK(told, "search %s %02X", alarm ? "alarm" : "all", family);
	int result = UNDER(told, search, alarm, family, note_found, &all);
	if (told->under)
		n = all.n;
	int err = trace_told(told->trace, link->env, &told->place, result, all.roms, &n);
	if (told->under)
		return result;
	for (size_t i = 0; i + 8 <= n && (!i || !result); i += 8)
		result = found(ctx, all.roms + i);
	return err < 0 ? err : result;
}

static int told_verify(struct link *link, const uint8_t rom[8], bool alarm)
{
	struct trace_link *told = told_of(link);

	ASK(told, "verify %s ", alarm ? "alarm" : "all");
	add_bytes(told, rom, 8);
	return answer(told, UNDER(told, verify, rom, alarm));
}

/* --- Drivers --- */

static bool told_has(struct link *link, const uint8_t rom[8])
{
	struct trace_link *told = told_of(link);

	ASK(told, "has ");
	add_bytes(told, rom, 8);
	return answer(told, DRIVEN(told, has, rom)) > 0;
}

static bool told_offers(struct link *link, const uint8_t rom[8], const char *property, int element)
{
	struct trace_link *told = told_of(link);

	ASK(told, "offers %s %d ", property, element);
	add_bytes(told, rom, 8);
	return answer(told, DRIVEN(told, offers, rom, property, element)) > 0;
}

static int told_area_read(struct link *link, const uint8_t rom[8], const struct area *area,
                          unsigned at, uint8_t *bytes, unsigned n)
{
	struct trace_link *told = told_of(link);

	ASK(told, "area %s %u %u ", area->name, at, n);
	add_bytes(told, rom, 8);
	return answer_bytes(told, DRIVEN(told, area_read, rom, area, at, bytes, n), bytes, n);
}

static int told_area_write(struct link *link, const uint8_t rom[8], const struct area *area,
                           unsigned at, const uint8_t *bytes, unsigned n)
{
	struct trace_link *told = told_of(link);

	ASK(told, "write %s %u ", area->name, at);
	add_bytes(told, bytes, n);
	trace_add(&told->trace->question, " ");
	add_bytes(told, rom, 8);
	return answer(told, DRIVEN(told, area_write, rom, area, at, bytes, n));
}

static int told_convert(struct link *link, const uint8_t *rom, const char *what)
{
	struct trace_link *told = told_of(link);

	ASK(told, "convert %s ", what);
	add_bytes(told, rom, rom ? 8 : 0);
	return answer(told, DRIVEN(told, convert, rom, what));
}

static const struct driver_ops told_driver = {
	.has = told_has,
	.offers = told_offers,
	.area_read = told_area_read,
	.area_write = told_area_write,
	.convert = told_convert,
};

/* --- What a link has --- */

static unsigned what_has(const struct link *link)
{
	const struct link_ops *ops = link->ops;
	const bool has[WORDS] = {
		[STRONG] = link->facts->strong, [SPLITS] = link->facts->splits,
		[RECOVER] = ops->recover,       [SLOT] = ops->slot,
		[TRIPLET] = ops->triplet,       [PATH] = ops->path,
		[SEARCH] = ops->search,         [VERIFY] = ops->verify,
		[DRIVER] = link->driver,
	};
	unsigned bits = 0;

	for (unsigned i = 0; i < WORDS; i++)
		bits |= has[i] ? 1u << i : 0;
	return bits;
}

static void give(struct trace_link *told, const char *name, unsigned has)
{
	told->ops = (struct link_ops){
		.name = name,
		.run = told_run,
		.recover = has >> RECOVER & 1 ? told_recover : NULL,
		.slot = has >> SLOT & 1 ? told_slot : NULL,
		.triplet = has >> TRIPLET & 1 ? told_triplet : NULL,
		.path = has >> PATH & 1 ? told_path : NULL,
		.search = has >> SEARCH & 1 ? told_search : NULL,
		.verify = has >> VERIFY & 1 ? told_verify : NULL,
	};
	told->facts = (struct link_facts){.strong = has >> STRONG & 1, .splits = has >> SPLITS & 1};
	told->link.driver = has >> DRIVER & 1 ? &told_driver : NULL;
	told->link.ops = &told->ops;
	told->link.facts = &told->facts;
}

static void record_link(struct trace_link *told, struct link *under)
{
	unsigned has = what_has(under);

	told->under = under;
	give(told, under->ops->name, has);
	told->link.chip = under->chip;
	ASK(told, "link %u", under->chip);
	for (unsigned i = 0; i < WORDS; i++)
		if (has >> i & 1)
			trace_add(&told->trace->question, " %s", words[i]);
	answer(told, 0);
}

static const struct trace_line *line_of_link(const struct trace *trace, unsigned n)
{
	for (unsigned i = 0; trace->line && i < trace->lines; i++)
		if (strncmp(trace->line[i].question, "link ", 5) == 0 &&
		    strtoul(trace->line[i].place, NULL, 10) == n)
			return &trace->line[i];
	return NULL;
}

static void replay_link(struct trace_link *told, const struct trace_line *line)
{
	unsigned has = 0;

	for (unsigned i = 0; i < WORDS; i++)
		has |= strstr(line->question, words[i]) ? 1u << i : 0;
	give(told, "replay", has);
	told->link.chip = (unsigned)strtoul(line->question + 5, NULL, 10);
	/* The line of the link is no call */
	told->place.told = true;
	told->place.last = (size_t)(line - told->trace->line);
}

unsigned trace_link_count(const struct trace *trace)
{
	unsigned n = 0;

	while (line_of_link(trace, n))
		n++;
	return n;
}

struct link *trace_link_of(struct tap *tap, unsigned n, struct link *link)
{
	struct trace *trace = (struct trace *)tap;
	const struct trace_line *line = line_of_link(trace, n);
	struct trace_link *told = trace->links;

	while (told && told->number != n)
		told = told->next;
	if (!told) {
		told = calloc(1, sizeof(*told));
		if (!told)
			return link;
		told->next = trace->links;
		trace->links = told;
	}
	*told = (struct trace_link){
		.link.env = link->env, .trace = trace, .number = n, .next = told->next};
	snprintf(told->place.name, sizeof(told->place.name), "%u", n);
	if (trace->file)
		record_link(told, link);
	else if (line)
		replay_link(told, line);
	return trace->file || line ? &told->link : link;
}

void trace_links_free(struct trace *trace)
{
	for (struct trace_link *told = trace->links, *next; told; told = next) {
		next = told->next;
		free(told);
	}
	trace->links = NULL;
}
