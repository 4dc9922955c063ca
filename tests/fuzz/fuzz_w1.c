/* SPDX-License-Identifier: MIT */
/*
 * The w1 bus on files of sysfs with anything in them. The input: the families of two slaves, then a
 * list of what happens: files get contents or go, properties are read and written, directories and
 * alarms listed.
 */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "hal/chips/family.h"
#include "hal/chips/find.h"
#include "hal/owfs/path.h"
#include "hal/w1/name.h"
#include "tests/fuzz/bus_host.h"
#include "tests/fuzz/sysfs.h"

#define STEPS 60

static struct fuzz fuzz;
static struct bus_host host;
static struct slave {
	uint8_t rom[ROM_LEN];
	char name[W1_NAME_MAX], path[ROM_TEXT_MAX + 1];
} slaves[2];

static const uint8_t families[] = {0x28, 0x10, 0x22, 0x3b, 0x42, 0x29, 0x3a, 0x12,
                                   0x05, 0x26, 0x1d, 0x20, 0x23, 0x2d, 0x14, 0x01};
/* What the kernel's drivers have. */
/* clang-format off */
static const char *const attributes[] = {
	"w1_slave", "temperature", "resolution", "alarms", "ext_power", "eeprom", "rw", "state",
	"output", "activity", "cond_search_mask", "cond_search_polarity", "status_control", "page0",
	"page1", "vad", "vdd", "id", "name", "conv_time", "features", "iad", "offset", "eeprom_cmd",
	"therm_bulk_read", "w1_master_slaves",
};
/* clang-format on */
#define ATTRIBUTES (sizeof(attributes) / sizeof(attributes[0]))

size_t fuzz_memory(size_t n)
{
	/* the bus's tables, and the room of requests */
	return 8000000 + 16 * n;
}

static void plug(struct slave *slave, uint8_t family, uint8_t last)
{
	uint8_t rom[ROM_LEN] = {family, last};

	rom[7] = rom_crc8(rom, 7);
	memcpy(slave->rom, rom, ROM_LEN);
	w1_name(rom, slave->name);
	slave->path[0] = '/';
	rom_print(rom, ROM_F_I, slave->path + 1);
	sysfs_directory(slave->name, NULL, 0);
}

static void put_file(uint8_t what)
{
	const struct slave *slave = &slaves[what >> 3 & 1];
	uint8_t which = fuzz_byte(&fuzz), fault = fuzz_byte(&fuzz);
	uint8_t bytes[SYSFS_BYTES];
	size_t n;
	const uint8_t *content = fuzz_bytes(&fuzz, 255, &n);

	if (n)
		memcpy(bytes, content, n);
	if (which & 0x40) { /* as long as an EEPROM */
		memset(bytes + n, fault, 512 - n);
		n = 512;
	}
	sysfs_file(what & 0x10 ? "w1_bus_master1" : slave->name,
	           attributes[(which & 0x3f) % ATTRIBUTES], bytes, n, which & 0x80 ? fault & 7 : 0);
}

static void list_slaves(void)
{
	uint8_t names[512];
	size_t n, used = 0;
	const uint8_t *more = fuzz_bytes(&fuzz, 255, &n);

	for (int i = 0; i < 2; i++) {
		memcpy(names + used, slaves[i].name, W1_NAME_MAX);
		used += W1_NAME_MAX;
	}
	if (n)
		memcpy(names + used, more, n);
	sysfs_directory("w1_bus_master1", names, used + n);
}

/* The properties of a family in their order, which are not looked for each time. */
static const struct property *nth_property(const struct family *family, unsigned n)
{
	static struct list {
		const struct family *family;
		const struct property *property[256];
		unsigned count;
	} lists[sizeof(families)];
	struct list *list = lists;
	const struct property *property = NULL;

	while (list->family && list->family != family)
		list++;
	while (!list->family && list->count < 256 &&
	       (property = family_next(family, NULL, property)) != NULL)
		list->property[list->count++] = property;
	list->family = family;
	return list->property[n % list->count];
}

static void ask(uint8_t what)
{
	static const char *const extensions[] = {"", ".ALL", ".BYTE", ".0", ".A", ".1", ".7", ".3"};
	static const char *const others[] = {
		"/",         "/alarm",          "/simultaneous/temperature", "/bus.0",
		"/uncached", "/alarm/28,10,29", "/settings/timeout",         "/statistics/errors"};
	const struct slave *slave = &slaves[what >> 3 & 1];
	uint8_t which = fuzz_byte(&fuzz), how = fuzz_byte(&fuzz);
	enum bus_op op = how & 0x80 ? BUS_WRITE : how & 0x40 ? BUS_DIR : BUS_READ;
	const struct property *property;
	const uint8_t *value = NULL;
	char path[200];
	size_t n = 4096;

	if (op == BUS_WRITE)
		value = fuzz_bytes(&fuzz, 255, &n);
	property = nth_property(family_of(slave->rom[0]), which & 0x7f);
	if (how & 0x20)
		snprintf(path, sizeof(path), "%s", others[which & 7]);
	else
		snprintf(path, sizeof(path), "%s/%s%s", slave->path, property->name,
		         property->array.count || which & 0x80 ? extensions[how & 7] : "");
	bus_host_ask(&host, op, path, !(how & 0x10), value, (uint32_t)n, 5 * BUS_HOST_S);
}

static void happen(void)
{
	uint8_t what = fuzz_byte(&fuzz);

	switch (what & 7) {
	case 0:
	case 1:
	case 2:
		put_file(what);
		break;
	case 3:
	case 4:
	case 5:
		ask(what);
		if (what & 0x20)
			return;
		bus_host_run(&host, 10 * BUS_HOST_S, true);
		break;
	case 6:
		list_slaves();
		bus_host_run(&host, 40 * BUS_HOST_S, false);
		break;
	case 7:
		if (what & 0x10)
			plug(&slaves[what >> 3 & 1], families[fuzz_byte(&fuzz) & 15], what >> 5);
		else if (what & 0x20)
			sysfs_remove(slaves[what >> 3 & 1].name, NULL);
		else
			sysfs_remove(slaves[what >> 3 & 1].name,
			             attributes[fuzz_byte(&fuzz) % ATTRIBUTES]);
		break;
	}
}

void fuzz_one(const uint8_t *bytes, size_t n)
{
	uint8_t which;

	fuzz = (struct fuzz){bytes, bytes + n};
	which = fuzz_byte(&fuzz);
	sysfs_clear();
	plug(&slaves[0], families[which & 15], 0xa1);
	plug(&slaves[1], families[which >> 4], 0xb1);
	bus_host_begin(&host);
	sysfs_directory("w1_bus_master1", NULL, 0);
	list_slaves();
	TEST_ASSERT_NOT_NULL(bus_host_open(&host, "w1:root=" SYSFS_ROOT));
	bus_host_run(&host, BUS_HOST_S, false);
	for (int i = 0; i < STEPS && fuzz_left(&fuzz); i++)
		happen();
	bus_host_run(&host, 20 * BUS_HOST_S, true);
	TEST_ASSERT_EQUAL_UINT_MESSAGE(0, host.lent, "a request was never answered");
	bus_host_end(&host);
}
