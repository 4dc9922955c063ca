/* SPDX-License-Identifier: MIT */
/*
 * The command segment as a hostile consumer writes it, between the steps of an engine: any bytes
 * anywhere, and commands as they should be with anything in them. The engine goes on, writes to the
 * bus what is of the type, and publishes whole samples. At the end what is left of the segment is
 * carried over to a new one, as the next owsd does.
 */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "src/shm/carry.h"
#include "src/signal/value.h"
#include "tests/fuzz/fuzz.h"
#include "tests/unit/aid/scene.h"

#define STEPS 64

static struct fuzz fuzz;
static struct scene scene;
static struct ows_command_header header; /* as it was made */
static uint32_t text_off[SCENE_ITEMS + 1];
static int64_t time_left;

static const struct {
	const char *name, *path;
	enum ows_type type;
	bool output, writable;
} items[] = {
	{"t1", "/28.551DDF030000/temperature12", OWS_DOUBLE, false, false},
	{"cell", "/26.551DDF030000/VAD", OWS_FLOAT, false, true},
	{"out", "/29.B89115000000/PIO.BYTE", OWS_BYTE, true, true},
	{"relay", "/3A.B89115000000/PIO.A", OWS_BOOL, true, true},
	{"alias", "/28.551DDF030000/alias", OWS_STRING, true, true},
	{"text", "/23.551DDF030000/memory", OWS_STRING, false, true},
	{"high", "/28.551DDF030000/temphigh", OWS_DOUBLE, true, true},
	{"counts", "/1D.551DDF030000/counters.A", OWS_LARGE, false, false},
	{"low", "/28.551DDF030000/templow", OWS_SHORT, true, true},
	{"word", "/29.B89115000000/set_alarm", OWS_DWORD, true, true},
};
#define ITEMS (sizeof(items) / sizeof(items[0]))

size_t fuzz_memory(size_t n)
{
	(void)n; /* the scene is made once for each input, and nothing grows */
	return 4000000;
}

/* What comes to a bus is a value of an item that the configuration lets be written. */
static void check_write(struct scene *s, const char *path, const char *data, uint32_t len)
{
	int64_t value;
	uint8_t quality;

	(void)s;
	for (size_t i = 0; i < ITEMS; i++) {
		if (strcmp(items[i].path, path) != 0)
			continue;
		TEST_ASSERT_TRUE_MESSAGE(items[i].output || items[i].writable, path);
		if (items[i].type == OWS_STRING) {
			TEST_ASSERT_TRUE(len <= VALUE_STRING_MAX);
			return;
		}
		TEST_ASSERT_EQUAL_INT_MESSAGE(
			0, value_from_text(items[i].type, data, len, &value, &quality), path);
		TEST_ASSERT_EQUAL_HEX8_MESSAGE(OWS_Q_GOOD, quality, path);
		return;
	}
	TEST_FAIL_MESSAGE("written where no item is");
}

static void check_image(void)
{
	for (uint32_t i = 0; i <= ITEMS; i++) {
		const struct ows_record *r = &scene.image.records[i];
		const struct ows_slot *slot = &r->slot[r->seq >> 1 & 1];

		TEST_ASSERT_EQUAL_UINT32(0, r->seq & 1);
		TEST_ASSERT_EQUAL_HEX32(
			ows_check((const uint32_t *)(const void *)&slot->sample, 11),
			slot->sample.check);
		TEST_ASSERT_EQUAL_HEX32(ows_check((const uint32_t *)(const void *)&slot->attrs, 17),
		                        slot->attrs.check);
		TEST_ASSERT_TRUE(slot->sample.len <= r->text_cap);
		if (i && r->type != OWS_STRING) {
			TEST_ASSERT_TRUE(value_holds((enum ows_type)r->type, slot->sample.value));
			if (slot->attrs.flags & OWS_ATTR_COMMANDED)
				TEST_ASSERT_TRUE(
					value_holds((enum ows_type)r->type, slot->attrs.commanded));
		}
	}
}

static void run(int64_t ns)
{
	if (ns > time_left)
		ns = time_left;
	time_left -= ns;
	scene_run(&scene, ns);
	check_image();
}

static char *at(uint32_t off)
{
	return (char *)scene.command_memory + off;
}

static void mark(uint32_t record)
{
	((uint32_t *)(void *)at(header.dirty_off))[record / 32] |= 1u << record % 32;
}

static struct ows_command_slot *slot_of(uint32_t record)
{
	return (struct ows_command_slot *)(void *)at(header.slot_off) + record;
}

static void put_text(uint32_t record)
{
	struct ows_command_text *text = (void *)at(text_off[record]);
	uint8_t how = fuzz_byte(&fuzz);
	size_t n;
	const uint8_t *bytes = fuzz_bytes(&fuzz, 255, &n);

	if (n)
		memcpy(text + 1, bytes, n);
	if (how & 1) { /* as long as can be, or longer */
		memset((char *)(text + 1) + n, 'x', header.text_cap - n);
		n = header.text_cap + (how >> 1 & 1);
	}
	text->len = (uint32_t)n;
	text->check = ows_check_bytes((const char *)(text + 1),
	                              n > header.text_cap ? header.text_cap : n);
	text->claim = how & 4 ? fuzz_byte(&fuzz) : 0;
}

/* A command as libows gives it, whatever is in it. */
static void command(uint8_t what)
{
	uint32_t record = 1 + (what >> 4) % ITEMS;
	struct ows_command_slot *slot = slot_of(record);

	if (items[record - 1].type == OWS_STRING)
		put_text(record);
	else if (what & 8)
		slot->value = (uint64_t)value_of_double((int8_t)fuzz_byte(&fuzz));
	else
		slot->value = (uint64_t)fuzz_long(&fuzz);
	slot->client = fuzz_byte(&fuzz) & 3;
	slot->stamp++;
	mark(record);
}

static void flags(uint8_t what)
{
	struct ows_command_slot *slot = slot_of((what >> 4) % (ITEMS + 1));
	uint8_t how = fuzz_byte(&fuzz);

	slot->read_enable = how & 3;
	slot->write_enable = how >> 2 & 3;
	slot->one_shot += how >> 4 & 1;
	slot->dgn_reset += how >> 5 & 1;
	((uint32_t *)(void *)at(header.ack_off))[(what >> 4) % (ITEMS + 1)] += how >> 6 & 1;
	mark((what >> 4) % (ITEMS + 1));
}

static void overlay(void)
{
	uint32_t off = fuzz_word(&fuzz) % header.size;
	size_t n;
	const uint8_t *bytes = fuzz_bytes(&fuzz, 255, &n);

	if (n > header.size - off)
		n = header.size - off;
	if (n)
		memcpy(at(off), bytes, n);
	/* all of it would be too much of what is not looked at */
	if (off % 3 == 0)
		memset(at(header.dirty_off), 0xff, 4 * header.dirty_words);
}

static void happen(void)
{
	static const int64_t spans[] = {1, 20, 100, 350, 1100, 5000, 60, 2000};
	static const int errors[] = {0, -ENODEV, -EIO, -EINVAL, -EINPROGRESS, 0, -EACCES, -ERANGE};
	uint8_t what = fuzz_byte(&fuzz);
	struct ows_client *client;

	switch (what & 7) {
	case 0:
		overlay();
		break;
	case 1:
	case 2:
		command(what);
		break;
	case 3:
		flags(what);
		break;
	case 4:
		client = (struct ows_client *)(void *)at(header.client_off) + (what >> 4 & 3);
		client->pid = fuzz_byte(&fuzz);
		client->beat += what >> 3 & 1;
		client->period_ms = what & 0x80 ? fuzz_word(&fuzz) : 100;
		break;
	case 5:
		scene_put(&scene, items[(what >> 4) % ITEMS].path, "1",
		          errors[fuzz_byte(&fuzz) & 7]);
		break;
	case 6:
		run(spans[what >> 3 & 7] * SCENE_MS);
		break;
	case 7:
		if (what & 8)
			scene_down(&scene, -ECONNRESET);
		else if (what & 0x10)
			scene_up(&scene);
		else
			commands_repair(&scene.commands, what & 0x20);
		break;
	}
}

static void begin(void)
{
	scene_init(&scene);
	scene.no_trace = true;
	scene.on_write = check_write;
	for (size_t i = 0; i < ITEMS; i++) {
		struct config_item *item = items[i].output
		                                   ? scene_output(&scene, items[i].name,
		                                                  items[i].path, items[i].type)
		                                   : scene_input(&scene, items[i].name,
		                                                 items[i].path, items[i].type);

		item->writable = items[i].writable;
		scene_put(&scene, items[i].path, "1", 0);
		if (!strcmp(items[i].name, "out")) {
			item->has_safe = true;
			item->safe_value = 7;
			item->safe_text = "7";
		}
		if (!strcmp(items[i].name, "t1")) {
			item->limits = (struct config_limits){.any = true};
			item->limits.has[CONFIG_LIMIT_H] = true;
			item->limits.limit[CONFIG_LIMIT_H] = 30;
		}
	}
	scene_start(&scene);
	memcpy(&header, scene.command_memory, sizeof(header));
	for (size_t i = 0; i <= ITEMS; i++)
		text_off[i] = scene.commands.text_off[i];
	scene_up(&scene);
	time_left = 12 * SCENE_S;
}

/* Into a new segment: what comes there is what an engine can take. */
static void carry(uint8_t how)
{
	size_t size = header.size, cut = how & 2 ? fuzz_word(&fuzz) % (size + 1) : size;
	char *old = malloc(cut ? cut : 1);
	void *memory = aligned_alloc(64, (size + 63) / 64 * 64);
	struct commands to;
	struct command got;
	char text[1024 + 1];
	int count;

	TEST_ASSERT_NOT_NULL(old);
	TEST_ASSERT_NOT_NULL(memory);
	memcpy(old, scene.command_memory, cut);
	commands_retire(old, cut);
	memset(memory, 0, size);
	TEST_ASSERT_EQUAL_INT(0, commands_build(&scene.command_plan, memory, &to));
	count = commands_carry(&to, old, cut, how & 1);
	TEST_ASSERT_TRUE(count == -EPROTO || (count >= 0 && count <= (int)ITEMS));
	for (uint32_t i = 1; i <= ITEMS; i++) {
		commands_load(&to, i, &got);
		if (text_off[i])
			TEST_ASSERT_TRUE(commands_text(&to, i, text) >= (got.stamp ? 0 : -EBADMSG));
	}
	TEST_ASSERT_FALSE_MESSAGE(commands_repair(&to, true),
	                          "carrying changed what owsd says there");
	commands_forget(&to);
	free(memory);
	free(old);
}

void fuzz_one(const uint8_t *bytes, size_t n)
{
	uint8_t how;

	fuzz = (struct fuzz){bytes, bytes + n};
	how = fuzz_byte(&fuzz);
	begin();
	for (int i = 0; i < STEPS && fuzz_left(&fuzz); i++)
		happen();
	run(500 * SCENE_MS);
	if (!(how & 4))
		commands_repair(&scene.commands, true);
	carry(how);
	scene_end(&scene);
}
