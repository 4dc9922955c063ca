/* SPDX-License-Identifier: MIT */
/* Visits a chip with a trouble at each place in turn. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "hal/chips/find.h"
#include "tests/unit/aid/visit.h"

struct trouble trouble;
struct sim_slave *visited;

/* Let the chip measure, so that its registers hold old values. */
static void remember(const struct visit *visit)
{
	static const struct {
		const char *chip, *property;
	} before[] = {
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
static void change(const struct visit *visit, bool again)
{
	const struct sim_input *inputs = visited->family->inputs;
	size_t size = 0;

	for (unsigned i = 0; inputs && inputs[i].name; i++) {
		double value = inputs[i].pin ? (i + again + visit->turned) % 2
		                             : (again ? 1.37 : 2.05) + 0.48 * i;

		if (strcmp(inputs[i].name, "temperature") == 0)
			value = again ? 61.5 : 20.25;
		wire_set(visited, inputs[i].name, value);
	}
	uint8_t *memory = visited->family->memory ? visited->family->memory(visited, &size) : NULL;
	bool has_registers = strcmp(visited->family->name, "DS2438") == 0;

	for (size_t i = has_registers ? 24 : 0; i < size; i++)
		memory[i] = (uint8_t)(i * 7 + (again ? 0x35 : 0x91));
}

void visit_begin(const struct visit *visit)
{
	native_begin();
	wire_init(&host, 1, 1);
	wire_net.trouble = &trouble;
	trouble_none(&trouble);
	visited = wire_add(0, visit->chip, 1);
	visited->parasite = visit->parasite;
	change(visit, false);
	if (visit->turned && strcmp(visit->chip, "DS2405") == 0)
		visited->family->selected(visited, true, wire_time());
	start();
	remember(visit);
	change(visit, true);
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
	uint32_t id = ask(visit->write ? BUS_WRITE : BUS_READ, BUS_INPUT, true,
	                  of(visited, visit->property), visit->write);
	answer_to(id);
	trouble.kind = TROUBLE_NONE;
	return id;
}

const char *visit_says(const struct visit *visit, const struct trouble *what)
{
	static const char *const kinds[] = {"nothing", "turned",         "deaf",
	                                    "absent",  "false presence", "noise"};
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
	static const uint8_t masks[] = {0xff, 0x24, 0x42, 0x55};
	unsigned stride = visit->stride ? visit->stride : 1, n = 0;

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
	for (uint32_t at = 0; at < resets; at++, n += 2) {
		try(visit, (struct trouble){.kind = TROUBLE_ABSENT, .at = at}, one);
		try(visit, (struct trouble){.kind = TROUBLE_FALSE, .at = at}, one);
	}
	return n;
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
		if (family->properties[i].read == property->read &&
		    family->properties[i].field.area == property->field.area &&
		    family->properties[i].convert == property->convert &&
		    !strstr(family->properties[i].name, "HTM"))
			return true;
	return false;
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
		                      .slack = strstr(property->name, "date") ? 30 : 0};

		if (!(property->access & ACCESS_READ) || property->offline ||
		    (property->visible && strcmp(chip, "DS1825") != 0) ||
		    is_like_another(family, i))
			continue;
		snprintf(name, sizeof(name), "%s%s", property->name,
		         property->type == PROPERTY_BITS          ? ".BYTE"
		         : property->array.aggregate              ? ".ALL"
		         : property->array.index == INDEX_LETTERS ? ".B"
		         : property->array.index == INDEX_NUMBERS ? ".3"
		                                                  : "");
		if (!only || strstr(name, only))
			one(&visit, property);
	}
}
