/* SPDX-License-Identifier: MIT */
/*
 * The memory of a controller as a hostile program writes it, between the steps of an engine: any
 * bytes anywhere, and commands as they should be with anything in them. The engine goes on, writes
 * to the bus what is of the type, and publishes whole samples; the memory of another controller
 * stays as it is. At the end what is left goes over a reload, or to the owsd after a kill.
 */
#include <errno.h>
#include <string.h>

#include "src/ground/signal/value.h"
#include "tests/fuzz/fuzz.h"
#include "tests/unit/aid/scene.h"

#define STEPS 64

static struct fuzz fuzz;
static struct scene scene;
static const struct controller_layout *layout;
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
		TEST_ASSERT_EQUAL_HEX32(ows_check((const uint32_t *)(const void *)&slot->attrs, 19),
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

static void put_text(uint32_t record)
{
	struct ows_command_text *text = giving_text(&scene.controllers[0], record);
	uint32_t cap = layout->header.text_cap;
	uint8_t how = fuzz_byte(&fuzz);
	size_t n;
	const uint8_t *bytes = fuzz_bytes(&fuzz, 255, &n);

	if (n)
		memcpy(text + 1, bytes, n);
	if (how & 1) { /* as long as can be, or longer */
		memset((char *)(text + 1) + n, 'x', cap - n);
		n = cap + (how >> 1 & 1);
	}
	text->len = (uint32_t)n;
	text->check = ows_check_bytes((const char *)(text + 1), n > cap ? cap : n);
}

/* A command as libows gives it, whatever is in it. */
static void command(uint8_t what)
{
	uint32_t record = 1 + (what >> 4) % ITEMS;
	struct ows_command_slot *slot = scene_slot(&scene, record);

	if (items[record - 1].type == OWS_STRING)
		put_text(record);
	else if (what & 8)
		slot->value = (uint64_t)value_of_double((int8_t)fuzz_byte(&fuzz));
	else
		slot->value = (uint64_t)fuzz_long(&fuzz);
	slot->person = fuzz_byte(&fuzz) & 31;
	slot->stamp++;
	scene_ring(&scene, record);
}

static void flags(uint8_t what)
{
	uint32_t record = (what >> 4) % (ITEMS + 1);
	struct ows_command_slot *slot = scene_slot(&scene, record);
	uint8_t how = fuzz_byte(&fuzz);

	slot->read_enable += how & 7;
	slot->write_enable += how >> 2 & 7;
	slot->one_shot += how >> 4 & 1;
	slot->dgn_reset += how >> 5 & 1;
	slot->acknowledged += how >> 6 & 1;
	scene_ring(&scene, record);
}

static void shelve(void)
{
	struct ows_command_shelf *shelf = giving_shelf(&scene.controllers[0]);
	size_t n;
	const uint8_t *why = fuzz_bytes(&fuzz, OWS_TEXT, &n);

	if (n)
		memcpy(shelf->why, why, n);
	shelf->record = fuzz_byte(&fuzz) % (ITEMS + 2);
	shelf->seconds = fuzz_word(&fuzz);
	shelf->count++;
	giving_header(&scene.controllers[0])->marked = 1;
}

static void overlay(void)
{
	uint32_t off = fuzz_word(&fuzz) % layout->header.size;
	char *base = scene.controllers[0].memory.base;
	size_t n;
	const uint8_t *bytes = fuzz_bytes(&fuzz, 255, &n);

	if (n > layout->header.size - off)
		n = layout->header.size - off;
	if (n)
		memcpy(base + off, bytes, n);
	/* all of it would be too much of what is not looked at */
	if (off % 3 == 0)
		memset(base + layout->header.dirty_off, 0xff,
		       4 * (size_t)layout->header.dirty_words);
	giving_header(&scene.controllers[0])->marked = 1;
}

/* The controller promises, beats, or says goodbye; or goes, and comes back. */
static void live(uint8_t what)
{
	struct ows_controller_header *h = giving_header(&scene.controllers[0]);

	h->beat += what >> 3 & 1;
	h->period_ms = what & 0x80 ? fuzz_word(&fuzz) : 100;
	h->goodbye = what >> 4 & 1;
	if (!(what & 0x60)) {
		scene_leave(&scene, 0);
		scene_join(&scene, 0, 7);
	}
}

static void happen(void)
{
	static const int64_t spans[] = {1, 20, 100, 350, 1100, 5000, 60, 2000};
	static const int errors[] = {0, -ENODEV, -EIO, -EINVAL, -EINPROGRESS, 0, -EACCES, -ERANGE};
	uint8_t what = fuzz_byte(&fuzz);

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
		live(what);
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
			shelve();
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
	scene_join(&scene, 1, 9);
	layout = scene.controllers[0].memory.layout;
	scene_up(&scene);
	time_left = 12 * SCENE_S;
}

/* The other controller did nothing, and nothing was done to it. */
static void check_other(void)
{
	TEST_ASSERT_EQUAL_HEX32(OWS_CONTROLLER_MAGIC, giving_header(&scene.controllers[1])->magic);
	for (uint32_t i = 0; i <= ITEMS; i++) {
		const struct ows_command_slot *slot = giving_slot(&scene.controllers[1], i);

		TEST_ASSERT_EQUAL_UINT32(0, slot->stamp | slot->taken | slot->applied);
		TEST_ASSERT_EQUAL_INT(0, slot->err);
	}
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
	check_other();
	if (how & 1)
		scene_reload(&scene, NULL);
	else
		scene_restart(&scene);
	layout = scene.controllers[0].memory.layout;
	check_image();
	run(500 * SCENE_MS);
	scene_end(&scene);
}
