/* SPDX-License-Identifier: MIT */
/*
 * libows on an image and a controller's memory that are damaged: before they are opened, and while
 * they are mapped. The input
 * is a list of patches and of calls. Nothing is read or written outside of the segments, and every
 * text ends.
 */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "src/memory/libows/handle.h"
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/heap_instance.h"

#define STEPS 80

static struct fuzz fuzz;
static struct ows *h;
static int64_t now_ns;
static char *image, *controller;
static size_t image_size_now, controller_size_now;

size_t fuzz_memory(size_t n)
{
	(void)n;
	return 1000000;
}

static char *copy(const char *from, size_t size)
{
	void *to = NULL;

	TEST_ASSERT_EQUAL_INT(0, posix_memalign(&to, 64, size));
	memcpy(to, from, size);
	return to;
}

/* Somewhere in the segment, or near where something of the image begins. */
static uint32_t place(const char *base, size_t size)
{
	uint32_t off = fuzz_word(&fuzz), area = off >> 24 & 15;

	if (base == image && off >> 24)
		off = (area < OWS_AREAS - 1 ? heap.image.areas[area].off : 0) + (off & 0x3ff);
	return off % (uint32_t)size;
}

static void patch(char *base, size_t size)
{
	uint32_t off = place(base, size);
	size_t n;
	const uint8_t *bytes = fuzz_bytes(&fuzz, 64, &n);

	if (n > size - off)
		n = size - off;
	if (n)
		memcpy(base + off, bytes, n);
}

/* A number of a header, an entry or a record: what is checked when it is opened. */
static void set_number(char *base, size_t size)
{
	static const uint32_t numbers[] = {0,   1,          4,          8,          255,
	                                   256, 0x7fffffff, 0x80000000, 0xffffffff, 0xfffffff8,
	                                   64,  128,        65535,      2};
	uint32_t off = place(base, size - 3) & ~3u, number = 0;
	uint8_t how = fuzz_byte(&fuzz);

	memcpy(&number, base + off, 4);
	if (how < sizeof(numbers) / sizeof(numbers[0]))
		number = numbers[how];
	else if (how == 100)
		number = (uint32_t)size;
	else if (how > 200)
		number += (uint32_t)(int8_t)fuzz_byte(&fuzz);
	else
		number = fuzz_word(&fuzz);
	memcpy(base + off, &number, 4);
}

/* Names do not change while they are mapped: each that ended does. */
static void keep_ends(void)
{
	const struct ows_map *map = h ? &h->map : NULL;
	size_t last;

	if (!map)
		return;
	image[map->areas[OWS_AREA_POOL].off + map->areas[OWS_AREA_POOL].count - 1] = '\0';
	for (uint32_t i = 0; i < map_count(map, OWS_AREA_TARGETS); i++) {
		last = sizeof(map_target(map, i)->name) - 1;
		image[&map_target(map, i)->name[last] - map->base] = '\0';
	}
	for (uint32_t i = 0; i < map_count(map, OWS_AREA_COUNTERS); i++) {
		last = sizeof(map_counter(map, i)->name) - 1;
		image[&map_counter(map, i)->name[last] - map->base] = '\0';
	}
}

static void damage(uint8_t what)
{
	char *base = what & 8 ? controller : image;
	size_t size = what & 8 ? controller_size_now : image_size_now;

	if (what & 0x10)
		patch(base, size);
	else
		set_number(base, what & 0x20 && size > 256 ? 256 : size);
	keep_ends();
}

/* clang-format off */
static const char *const names[] = {
	"room", "relay", "label", "level", "OWS__count", "room_Age", "_TRANSACTIONS", "_DGNRESET",
	"relay_WriteEnable", "label_Alarm", "relay_WOS", "count_PerMax", "room_PerFactor", "nobody",
	"level_DGNRESET", "warm",
};
/* clang-format on */
#define NAMES (sizeof(names) / sizeof(names[0]))

static size_t ended(const char *text)
{
	return text ? strlen(text) : 0;
}

static void look_around(void)
{
	struct ows_target target;
	struct ows_counter counter;
	struct ows_device device;
	struct ows_daemon daemon;
	struct ows_commanded command;
	struct ows_alarm alarm;
	struct ows_controller somebody;
	struct ows_info info;
	int count = ows_count(h);

	TEST_ASSERT_TRUE(count >= 0);
	for (int i = 0; i < count && i < 64; i++)
		if (ows_info(h, i, &info) == 0)
			ended(info.name), ended(info.path);
	for (int i = 0; i < 300 && ows_target(h, i, &target) == 0; i++)
		ended(target.name);
	for (int i = 0; i < 300 && ows_counter(h, i, &counter) == 0; i++)
		ended(counter.name);
	for (int i = 0; i < 300; i++) {
		if (ows_device(h, i, &device) != 0)
			continue;
		ended(device.id), ended(device.family);
		TEST_ASSERT_NOT_NULL(memchr(device.identity, '\0', sizeof(device.identity)));
		TEST_ASSERT_TRUE(device.power <= OWS_POWER_EXTERNAL);
		if (device.target >= 0)
			TEST_ASSERT_EQUAL(0, ows_target(h, device.target, &target));
	}
	for (uint32_t i = 0; i < 4; i++)
		if (ows_alarm(h, ows_alarm_count(h) - i, &alarm) == 0)
			TEST_ASSERT_TRUE(alarm.signal >= 0 && alarm.signal < count);
	ows_alarm(h, fuzz_word(&fuzz), &alarm);
	for (uint32_t i = 0; i < 4; i++) {
		if (ows_command_entry(h, ows_command_count(h) - i, &command))
			continue;
		TEST_ASSERT_TRUE(command.signal >= 0 && command.signal < count);
		TEST_ASSERT_NOT_NULL(memchr(command.text, '\0', sizeof(command.text)));
		TEST_ASSERT_NOT_NULL(memchr(command.who.name, '\0', sizeof(command.who.name)));
	}
	for (int i = 0; i < 200; i++)
		if (ows_controller(h, i, &somebody) == 0)
			ended(somebody.who.name), ended(somebody.who.person);
	ended(ows_served(h));
	ows_daemon(h, now_ns, &daemon);
}

static void read_all(void)
{
	struct ows_value value;
	struct ows_alarm_state state = {0};
	struct ows_origin origin;
	struct ows_command told;
	char *text = malloc(40);

	TEST_ASSERT_NOT_NULL(text);
	for (size_t i = 0; i < NAMES; i++) {
		int id = ows_find(h, names[i]);
		size_t size = 1 + i % 2 * 39;

		if (id < 0)
			continue;
		ows_get(h, id, now_ns, &value);
		ows_get_text(h, id, now_ns, &value, text, size);
		TEST_ASSERT_NOT_NULL_MESSAGE(memchr(text, '\0', size), "a text without end");
		if (ows_alarm_state(h, id, &state) != -EAGAIN)
			ended(state.why), ended(state.who.person);
		ows_origin(h, id, &origin);
		ows_command(h, id, &told);
	}
	for (int i = 0; i < 16; i++)
		ows_get_signal(h, i, now_ns, &value);
	ows_get_signal(h, (int)fuzz_byte(&fuzz), now_ns, &value);
	free(text);
}

static void set_some(uint8_t what)
{
	int ids[3], id;
	double doubles[3] = {1, 2, 3};
	uint32_t stamp;

	for (int i = 0; i < 3; i++)
		ids[i] = ows_find(h, names[(what + (unsigned)i) % NAMES]);
	id = ids[0];
	ows_set(h, id, 3, &stamp);
	ows_set_integer(h, id, -1, NULL);
	ows_set_text(h, id, what & 0x10 ? "on" : "a text that is a little longer than most",
	             &stamp);
	ows_set_many(h, ids, doubles, 3);
	ows_acknowledge(h, id);
	ows_beat(h, 100);
}

static void happen(void)
{
	uint8_t what = fuzz_byte(&fuzz);

	switch (what & 7) {
	case 0:
	case 1:
	case 2:
		damage(what);
		break;
	case 3:
		look_around();
		break;
	case 4:
		read_all();
		break;
	case 5:
		set_some(what >> 3);
		break;
	case 6:
		now_ns += (int64_t)fuzz_word(&fuzz) * 1000000;
		break;
	case 7:
		ows_reopen(h);
		break;
	}
}

void fuzz_one(const uint8_t *bytes, size_t n)
{
	uint8_t before, mode;

	fuzz = (struct fuzz){bytes, bytes + n};
	before = fuzz_byte(&fuzz);
	mode = fuzz_byte(&fuzz);
	heap_instance_reset();
	h = NULL;
	now_ns = HEAP_START;
	image_size_now = heap.image_size;
	controller_size_now = heap.controller_size;
	if (mode & 2)
		image_size_now = 256 + fuzz_word(&fuzz) % (heap.image_size - 255);
	image = copy(heap.image_memory, image_size_now);
	controller = copy(heap.controller_memory, controller_size_now);
	heap_image_file = (struct heap_file){image, image_size_now};
	heap_controller_file = (struct heap_file){controller, controller_size_now};
	/* it says of itself what the file is */
	((struct ows_image_header *)(void *)image)->size = (uint32_t)image_size_now;
	for (int i = 0; i < (before & 7); i++)
		damage(fuzz_byte(&fuzz));
	if (ows_open("OWS", mode & 1 ? OWS_CONTROL : OWS_READ, &h) == 0) {
		read_all();
		look_around();
		for (int i = 0; i < STEPS && fuzz_left(&fuzz); i++)
			happen();
		ows_close(h);
	}
	free(image);
	free(controller);
}
