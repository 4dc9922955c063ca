/* SPDX-License-Identifier: MIT */
/* Visits a chip with a trouble at each place in turn. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif

#include "unity.h"

#include "hal/chips/find.h"
#include "hal/sim/branch.h"
#include "tests/unit/aid/visit.h"

/* Of a memory that has more bytes its pages are read. */
#define WHOLE_MAX 512
/* More than a bus needs. */
#define KEPT (32 * 1024 * 1024)

struct trouble trouble;
struct sim_slave *visited;
bool visit_behind;

#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define SANITIZED 1
#endif
#endif
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define SANITIZED 1
#endif
#ifndef SANITIZED
#define SANITIZED 0
#endif

unsigned visit_stride(void)
{
	const char *said = getenv("VISIT_STRIDE");
	long stride = said ? strtol(said, NULL, 10) : 0;

	if (stride > 0 && stride < 1000)
		return (unsigned)stride;
	return SANITIZED || sizeof(void *) < 8 ? 7 : 1;
}

/* Let the chip measure, so that its registers hold old values. */
static void remember(const struct visit *visit)
{
	static const struct {
		const char *chip, *property;
	} before[] = {
		{"DS2436", "temperature"},
		{"DS2436", "volts"},
		{"DS2437", "VAD"},
		{"DS2437", "VDD"},
		{"DS2437", "temperature"},
		{"DS2437", "vis"},
		{"DS2438", "VAD"},
		{"DS2438", "VDD"},
		{"DS2438", "temperature"},
		{"DS2438", "vis"},
		{"DS2450", "8bit/volt2.ALL"},
		{"DS2450", "volt.ALL"},
		{"DS18B20", "temperature"},
		{"DS18S20", "temperature"},
		{"DS1822", "temperature"},
		{"DS1825", "temperature"},
		{"DS28EA00", "temperature"},
		{"DS2408", "power"},
	};

	for (size_t i = 0; i < sizeof(before) / sizeof(before[0]); i++)
		if (strcmp(before[i].chip, visit->chip) == 0)
			TEST_ASSERT_EQUAL_INT(
				0, result(BUS_READ, of(visited, before[i].property), NULL));
	if (!visit->write)
		(void)result(BUS_READ, of(visited, visit->property), NULL);
}

/* Give all inputs and memories of the chip other values, which all differ. */
void visit_change(struct sim_slave *slave, bool again, bool turned)
{
	const struct sim_input *inputs = slave->family->inputs;
	size_t size = 0;

	for (unsigned i = 0; inputs && inputs[i].name; i++) {
		double value = inputs[i].pin ? (i + again + turned) % 2
		                             : (again ? 1.37 : 2.05) + 0.48 * i;

		if (strcmp(inputs[i].name, "temperature") == 0)
			value = again ? 61.5 : 20.25;
		wire_set(slave, inputs[i].name, value);
	}
	uint8_t *memory = sim_slave_memory(slave, &size);
	/* Registers; the first page of an EDS, which says what it is. */
	bool has_registers = strcmp(slave->family->name, "DS2438") == 0 ||
	                     strcmp(slave->family->name, "DS2437") == 0;
	size_t fixed = has_registers ? 24 : slave->family->code == 0x7e ? 32 : 0;

	for (size_t i = fixed; i < size; i++)
		memory[i] = (uint8_t)(i * 7 + (again ? 0x35 : 0x91));
}

/* The aux branch of a coupler on the main branch of another; a chip of its kind is on another. */
static void hide(const char *chip)
{
	struct sim_slave *outer = wire_add(0, "DS2409", 2), *inner = wire_add(0, "DS2409", 3);
	struct sim_slave *other = wire_add(0, chip, 4);

	sim_branch_put(inner, outer, SIM_MAIN);
	sim_branch_put(visited, inner, SIM_AUX);
	sim_branch_put(other, outer, SIM_AUX);
	visit_change(other, false, true);
}

void visit_begin(const struct visit *visit)
{
	/* What the bus of one visit had is for the next: the kernel would clear it each time */
#ifdef __GLIBC__
	mallopt(M_TRIM_THRESHOLD, KEPT);
	mallopt(M_MMAP_THRESHOLD, KEPT);
#endif
	native_begin();
	wire_init(&host, 1, 1);
	wire_net.trouble = &trouble;
	trouble_none(&trouble);
	visited = wire_add(0, visit->chip, 1);
	visited->parasite = visit->parasite;
	visit_change(visited, false, visit->turned);
	if (visit_behind)
		hide(visit->chip);
	sim_slave_advance(visited, wire_time());
	if (visit->turned && strcmp(visit->chip, "DS2405") == 0)
		visited->family->selected(visited, true);
	start();
	remember(visit);
	visit_change(visited, true, visit->turned);
	host_run(&host, bus, host.now + 100 * HOST_MS);
}

void visit_end(void)
{
	native_end();
	wire_net.trouble = NULL;
}

uint32_t visit_go(const struct visit *visit, const struct trouble *what)
{
	trouble_none(&trouble);
	trouble.kind = what->kind;
	trouble.at = what->at;
	trouble.mask = what->mask;
	trouble.probability = what->probability;
	trouble.random = what->random;
	uint32_t id = ask(visit->write ? BUS_WRITE : BUS_READ, BUS_INPUT, true,
	                  of(visited, visit->property), visit->write);
	answer_to(id);
	trouble.kind = TROUBLE_NONE;
	return id;
}

const char *visit_says(const struct visit *visit, const struct trouble *what)
{
	static const char *const kinds[] = {"nothing",        "turned", "deaf",      "absent",
	                                    "false presence", "noise",  "unplugged", "short"};
	static char text[120];

	snprintf(text, sizeof(text), "%s %s%s%s: %s at %u, mask %02X", visit->chip, visit->property,
	         visit->write ? " = " : "", visit->write ? visit->write : "", kinds[what->kind],
	         (unsigned)what->at, what->mask);
	return text;
}

static void try(const struct visit *visit, struct trouble what,
                void (*one)(const struct visit *visit, const struct trouble *what))
{
	visit_begin(visit);
	one(visit, &what);
	visit_end();
}

unsigned visit_each(const struct visit *visit,
                    void (*one)(const struct visit *visit, const struct trouble *what))
{
	/* All bits of Read Clock turned over are Write Clock: no master can see that. */
	bool clock = strcmp(visit->chip, "DS2415") == 0 || strcmp(visit->chip, "DS2417") == 0;
	const uint8_t masks[] = {clock ? 0x7f : 0xff, 0x24, 0x42, 0x55};
	unsigned stride = (visit->stride ? visit->stride : 1) * visit_stride(), n = 0;

	visit_begin(visit);
	visit_go(visit, &(struct trouble){.kind = TROUBLE_NONE});
	uint32_t slots = trouble.slots, resets = trouble.resets;
	visit_end();
	for (uint32_t at = 0; at < slots; at += stride, n++)
		try(visit, (struct trouble){.kind = TROUBLE_TURN, .at = at, .mask = 1}, one);
	for (uint32_t at = 0; at < slots; at += 8 * stride, n += 2) {
		try(visit, (struct trouble){.kind = TROUBLE_DEAF, .at = at}, one);
		try(visit,
		    (struct trouble){
			    .kind = TROUBLE_TURN, .at = at, .mask = masks[at / 8 % sizeof(masks)]},
		    one);
	}
	for (uint32_t at = 0; at < resets; at += visit_stride(), n += 2) {
		try(visit, (struct trouble){.kind = TROUBLE_ABSENT, .at = at}, one);
		try(visit, (struct trouble){.kind = TROUBLE_FALSE, .at = at}, one);
	}
	return n;
}

void visit_in_noise(const struct visit *visit, unsigned times, double probability,
                    void (*one)(const struct visit *visit, const struct trouble *what))
{
	for (unsigned i = 0; i < times; i++)
		try(visit,
		    (struct trouble){.kind = TROUBLE_NOISE,
		                     .probability = probability,
		                     .random = i + 1,
		                     .at = i},
		    one);
}

/* Is the property read by the same function, or of the same area, as one before it? */
static bool is_like_another(const struct family *family, unsigned n)
{
	static const char *const ways[] = {
		"VAD",  "VDD",   "vis",       "temperature", "HTM1735/humidity",
		"volt", "volt2", "8bit/volt", "latestvolt"};
	const struct property *property = &family->properties[n];

	for (size_t i = 0; i < sizeof(ways) / sizeof(ways[0]); i++)
		if (strcmp(property->name, ways[i]) == 0)
			return false;
	for (unsigned i = 0; i < n; i++)
		if (family->properties[i].size <= WHOLE_MAX &&
		    family->properties[i].how == property->how &&
		    family->properties[i].kinds == property->kinds &&
		    family->properties[i].field.area == property->field.area &&
		    family->properties[i].convert == property->convert &&
		    !strstr(family->properties[i].name, "HTM"))
			return true;
	return false;
}

static bool is_clock(const char *name)
{
	return strstr(name, "date") || strstr(name, "seconds") || strstr(name, "samples");
}

/* The memory of an EDS shows the seconds. */
static bool changes_by_itself(const struct family *family, const struct property *property)
{
	return family->code == 0x7e && property->type == PROPERTY_BINARY;
}

void visit_properties(const char *chip, bool parasite, bool turned,
                      void (*one)(struct visit *visit, const struct property *property))
{
	const struct family *family = family_of(sim_family_find(chip, 0)->code);
	const char *only = getenv("ONLY");

	for (unsigned i = 0; i < family->count; i++) {
		const struct property *property = &family->properties[i];
		char name[80];
		struct visit visit = {.chip = chip,
		                      .property = name,
		                      .parasite = parasite,
		                      .turned = turned,
		                      .slack = is_clock(property->name) ? 30 : 0};

		if (!(property->access & ACCESS_READ) || property->offline ||
		    property->size > WHOLE_MAX || is_like_another(family, i) ||
		    changes_by_itself(family, property))
			continue;
		snprintf(name, sizeof(name), "%s%s", property->name,
		         strcmp(property->name, "pages/count") == 0 ? ".15"
		         : property->type == PROPERTY_BITS          ? ".BYTE"
		         : property->array.aggregate                ? ".ALL"
		         : property->array.index == INDEX_LETTERS   ? ".B"
		         : property->array.index == INDEX_NUMBERS   ? ".3"
		                                                    : "");
		if (!only || strstr(name, only))
			one(&visit, property);
	}
}
