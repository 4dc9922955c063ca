/* SPDX-License-Identifier: MIT */
/* Each call of a link, with a driver and without, is recorded and has the same answer again. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "hal/chips/area.h"
#include "hal/trace/trace.h"
#include "hal/wire/driver.h"
#include "tests/unit/aid/folder.h"
#include "tests/unit/aid/host.h"

static const uint8_t one[8] = {0x28, 1, 2, 3, 4, 5, 6, 0x2a}, two[8] = {0x28, 9, 2, 3, 4, 5, 6, 7};
static const struct area pad = {.name = "scratchpad", .size = 9};
static struct host host;
static struct trace *trace;
static char *text, file[300];
static size_t len;
static unsigned calls;

static int run(struct link *link, const struct link_part *part)
{
	(void)link;
	calls++;
	for (size_t i = 0; i < part->in_n; i++)
		part->in[i] = (uint8_t)(0xa0 + i);
	host.now += HOST_MS;
	return part->out_n > 1 ? -ECOMM : 0;
}

static int recover(struct link *link, enum link_rung rung)
{
	(void)link;
	calls++;
	return rung == LINK_POWER_CYCLE ? -EOPNOTSUPP : 0;
}

static int slot(struct link *link, bool out, enum link_after after)
{
	(void)link;
	calls++;
	return out && after == LINK_STRONG;
}

static int path(struct link *link, bool reset, uint8_t command, uint8_t rom[8], uint8_t conflict[8])
{
	(void)link, (void)reset;
	calls++;
	if (command != 0xf0)
		return -EHOSTDOWN;
	/* they part in the fourth bit of the second byte */
	bool second = rom[1] & 8;
	memcpy(rom, second ? two : one, 8);
	memset(conflict, 0, 8);
	conflict[1] = 8;
	return 0;
}

static int search(struct link *link, bool alarm, uint8_t family, link_found *found, void *ctx)
{
	int err = 0;

	(void)link, (void)family;
	calls++;
	err = found(ctx, one);
	return err || alarm ? err : found(ctx, two);
}

static int verify(struct link *link, const uint8_t rom[8], bool alarm)
{
	(void)link;
	calls++;
	return alarm ? -EBADMSG : memcmp(rom, one, 8) == 0;
}

static bool has(struct link *link, const uint8_t rom[8])
{
	(void)link;
	calls++;
	return memcmp(rom, one, 8) == 0;
}

static bool offers(struct link *link, const uint8_t rom[8], const char *property, int element)
{
	(void)link, (void)rom;
	calls++;
	return strcmp(property, "temperature") == 0 && element == 0;
}

static int read_area(struct link *link, const uint8_t rom[8], const struct area *area, unsigned at,
                     uint8_t *bytes, unsigned n)
{
	(void)link, (void)rom, (void)area;
	calls++;
	memset(bytes, (int)at, n);
	return at > 8 ? -ENOENT : 0;
}

static int write_area(struct link *link, const uint8_t rom[8], const struct area *area, unsigned at,
                      const uint8_t *bytes, unsigned n)
{
	(void)link, (void)rom, (void)area, (void)at, (void)n;
	calls++;
	return bytes[0] ? 0 : -EACCES;
}

static int convert(struct link *link, const uint8_t *rom, const char *what)
{
	(void)link, (void)what;
	calls++;
	return rom ? 0 : -EOPNOTSUPP;
}

static const struct link_ops ops = {.name = "all",
                                    .run = run,
                                    .recover = recover,
                                    .slot = slot,
                                    .path = path,
                                    .search = search,
                                    .verify = verify};
static const struct driver_ops driver = {.has = has,
                                         .offers = offers,
                                         .area_read = read_area,
                                         .area_write = write_area,
                                         .convert = convert};
static const struct link_facts facts = {.strong = true};
static struct link wire = {
	.ops = &ops, .facts = &facts, .env = &host.env, .chip = 3, .driver = &driver};

void setUp(void)
{
	snprintf(file, sizeof(file), "%s", folder_file("it", "trace"));
	host_init_virtual(&host);
	calls = 0;
}

void tearDown(void)
{
	trace_end(trace);
	free(text);
	text = NULL;
}

static int note_found(void *ctx, const uint8_t rom[8])
{
	char *said = ctx;

	sprintf(said + strlen(said), "found %02X%02X ", rom[0], rom[1]);
	return 0;
}

static int stop_found(void *ctx, const uint8_t rom[8])
{
	note_found(ctx, rom);
	return 7;
}

/* All that a bus can call, and what it hears. */
static void call_all(struct link *link, char *said)
{
	uint8_t in[4] = {0}, out[2] = {0xcc, 0x44}, rom[8] = {0}, conflict[8];
	char roms[100] = "";
	struct link_part part = {.reset = true, .out = out, .out_n = 1, .in = in, .in_n = 4};

	said += sprintf(said, "chip %u strong %d splits %d ", link->chip, link->facts->strong,
	                link->facts->splits);
	said += sprintf(said, "run %d", link->ops->run(link, &part));
	said += sprintf(said, " %02X%02X ", in[0], in[3]);
	part = (struct link_part){.out = out, .out_n = 2, .after = LINK_STRONG};
	said += sprintf(said, "again %d ", link->ops->run(link, &part));
	said += sprintf(said, "recover %d %d ", link->ops->recover(link, LINK_CHIP_RESET),
	                link->ops->recover(link, LINK_POWER_CYCLE));
	said += sprintf(said, "slot %d %d ", link->ops->slot(link, true, LINK_STRONG),
	                link->ops->slot(link, false, LINK_IDLE));
	said += sprintf(said, "path %d", link->ops->path(link, true, 0xf0, rom, conflict));
	said += sprintf(said, " %02X%02X ", rom[1], conflict[1]);
	memset(rom, 0, 8);
	rom[1] = 8;
	said += sprintf(said, "other %d", link->ops->path(link, false, 0xf0, rom, conflict));
	said += sprintf(said, " %02X ", rom[1]);
	said += sprintf(said, "none %d ", link->ops->path(link, true, 0xec, rom, conflict));
	int err = link->ops->search(link, false, 0, note_found, roms);
	said += sprintf(said, "search %d %s", err, roms);
	roms[0] = '\0';
	err = link->ops->search(link, true, 0x28, stop_found, roms);
	said += sprintf(said, "alarm %d %s", err, roms);
	said += sprintf(said, "verify %d %d %d ", link->ops->verify(link, one, false),
	                link->ops->verify(link, two, false), link->ops->verify(link, one, true));
	said += sprintf(said, "has %d %d ", link->driver->has(link, one),
	                link->driver->has(link, two));
	said += sprintf(said, "offers %d %d ", link->driver->offers(link, one, "temperature", 0),
	                link->driver->offers(link, one, "type", 0));
	said += sprintf(said, "area %d", link->driver->area_read(link, one, &pad, 2, in, 2));
	said += sprintf(said, " %02X ", in[1]);
	said += sprintf(said, "area %d ", link->driver->area_read(link, one, &pad, 9, in, 2));
	said += sprintf(said, "write %d ", link->driver->area_write(link, one, &pad, 2, out, 2));
	sprintf(said, "convert %d %d", link->driver->convert(link, one, "temperature"),
	        link->driver->convert(link, NULL, "temperature"));
}

static void record_all(char *said)
{
	FILE *out = open_memstream(&text, &len);

	trace = trace_record(out, false, false);
	call_all(trace->tap.link(&trace->tap, 0, &wire), said);
	trace_end(trace);
	fclose(out);
}

static void begin_replay(void)
{
	char why[200] = "";
	FILE *made = fopen(file, "w");

	fputs(text, made);
	fclose(made);
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, trace_replay(&trace, file, why, sizeof(why)), why);
}

static void test_each_call_is_answered_as_it_was(void)
{
	char before[500] = "", after[500] = "";
	struct link none = {.env = &host.env};

	record_all(before);
	TEST_ASSERT_NOT_NULL_MESSAGE(strstr(before, "path 0 0108 other 0 09"), before);
	TEST_ASSERT_NOT_NULL_MESSAGE(strstr(before, "found 2801 found 2809"), before);
	begin_replay();
	calls = 0;
	TEST_ASSERT_EQUAL_UINT(1, trace_links(trace));
	call_all(trace->tap.link(&trace->tap, 0, &none), after);
	TEST_ASSERT_EQUAL_STRING(before, after);
	TEST_ASSERT_EQUAL_UINT(0, calls);
	TEST_ASSERT_EQUAL_UINT(0, host_events(&host, BUS_NOTE));
}

static void test_a_call_takes_the_time_that_it_took(void)
{
	char said[500] = "";
	struct link none = {.env = &host.env};
	int64_t begun;

	record_all(said);
	begin_replay();
	struct link *link = trace->tap.link(&trace->tap, 0, &none);
	begun = host.now;
	call_all(link, said);
	TEST_ASSERT_EQUAL_INT64(2 * HOST_MS, host.now - begun);
}

/* Nothing is there that was not recorded, and a shorter answer is ones. */
static void test_a_link_has_what_its_line_says(void)
{
	struct link none = {.env = &host.env};
	uint8_t in[4] = {0};
	const struct link_part part = {.reset = true, .in = in, .in_n = 4};

	text = strdup(TRACE_BEGIN "0 0 0: link > \" splits slot\" =1\n0 0 0: run r - 4 > 11\n");
	begin_replay();
	struct link *link = trace->tap.link(&trace->tap, 0, &none);
	TEST_ASSERT_NULL(link->driver);
	TEST_ASSERT_EQUAL_UINT(1, link->chip);
	TEST_ASSERT_NULL(link->ops->path);
	TEST_ASSERT_NULL(link->ops->recover);
	TEST_ASSERT_NOT_NULL(link->ops->slot);
	TEST_ASSERT_TRUE(link->facts->splits);
	TEST_ASSERT_FALSE(link->facts->strong);
	TEST_ASSERT_EQUAL_INT(0, link->ops->run(link, &part));
	TEST_ASSERT_EQUAL_HEX8(0x11, in[0]);
	TEST_ASSERT_EQUAL_HEX8(0xff, in[3]);
	TEST_ASSERT_EQUAL_INT(-EHOSTDOWN, link->ops->slot(link, true, LINK_IDLE));
}

/* What a call cannot return by link.h is an error of the wire. */
static void test_a_result_is_one_that_its_call_can_have(void)
{
	struct link none = {.env = &host.env};
	const struct link_part part = {.reset = true};
	uint8_t rom[8] = {0}, conflict[8];

	text = strdup(TRACE_BEGIN "0 0 0: link > \" slot path verify recover\"\n"
	                          "0 0 0: run r - 0 > =5\n"
	                          "0 0 0: run r - 0 > =-9999\n"
	                          "0 0 0: run r - 0 > !EWHATEVER\n"
	                          "0 0 0: run r - 0 > !EADDRINUSE\n"
	                          "0 0 0: slot 1 > =2\n"
	                          "0 0 0: path r F0 > =1\n"
	                          "0 0 0: verify all 28.01020304050\n"
	                          "0 0 0: recover 1 > =99999999999\n");
	begin_replay();
	struct link *link = trace->tap.link(&trace->tap, 0, &none);
	TEST_ASSERT_EQUAL_INT(-EIO, link->ops->run(link, &part));
	TEST_ASSERT_EQUAL_INT(-EIO, link->ops->run(link, &part));
	TEST_ASSERT_EQUAL_INT(-EIO, link->ops->run(link, &part));
	TEST_ASSERT_EQUAL_INT(-EADDRINUSE, link->ops->run(link, &part));
	TEST_ASSERT_EQUAL_INT(-EIO, link->ops->slot(link, true, LINK_IDLE));
	TEST_ASSERT_EQUAL_INT(-EIO, link->ops->path(link, true, 0xf0, rom, conflict));
	TEST_ASSERT_EQUAL_INT(-EHOSTDOWN, link->ops->verify(link, one, false));
	TEST_ASSERT_EQUAL_INT(-EIO, link->ops->recover(link, LINK_CHIP_RESET));
}

static int one_bit(struct link *link, bool out, enum link_after after)
{
	static unsigned slots;

	(void)link, (void)out, (void)after;
	return slots++ % 3 == 0; /* each bit of the id is 1 */
}

/* Its bits, one slot after the other, would show an id in no form that is found. */
static void test_a_search_of_slots_is_one_line(void)
{
	const struct link_ops slots = {.name = "slots", .run = run, .slot = one_bit};
	struct link bits = {.ops = &slots, .facts = &facts, .env = &host.env};
	uint8_t rom[8] = {0}, conflict[8];
	FILE *out = open_memstream(&text, &len);

	trace = trace_record(out, false, false);
	struct link *link = trace->tap.link(&trace->tap, 0, &bits);
	TEST_ASSERT_EQUAL_INT(0, link->ops->path(link, true, 0xf0, rom, conflict));
	TEST_ASSERT_EACH_EQUAL_HEX8(0xff, rom, 8);
	TEST_ASSERT_EACH_EQUAL_HEX8(0, conflict, 8);
	TEST_ASSERT_EQUAL_INT(2, trace_end(trace));
	fclose(out);
	begin_replay();
	TEST_ASSERT_NOT_NULL(strstr(text, "0: path r F0 > FF.FFFFFFFFFFFFFFFF.FFFFFFFFFFFFFF\n"));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_each_call_is_answered_as_it_was);
	RUN_TEST(test_a_call_takes_the_time_that_it_took);
	RUN_TEST(test_a_link_has_what_its_line_says);
	RUN_TEST(test_a_search_of_slots_is_one_line);
	RUN_TEST(test_a_result_is_one_that_its_call_can_have);
	return UNITY_END();
}
