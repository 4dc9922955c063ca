/* SPDX-License-Identifier: MIT */
/*
 * Texts that stand for something: values of every type, names of signals and attributes, paths,
 * device ids, addresses, points of a line. What was read, printed, is read as the same. The first
 * byte picks the type.
 */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/owfs/path.h"
#include "src/config/read/listen.h"
#include "src/ground/signal/attribute.h"
#include "src/ground/signal/scale.h"
#include "src/ground/signal/value.h"
#include "src/ground/text/printable.h"
#include "tests/fuzz/fuzz.h"

size_t fuzz_memory(size_t n)
{
	return 10000 + 4 * n;
}

static void print_and_read(enum ows_type type, int64_t value)
{
	char text[VALUE_TEXT_MAX];
	int64_t again;
	uint8_t quality;
	int n;

	TEST_ASSERT_TRUE_MESSAGE(value_holds(type, value), "a value that its type cannot hold");
	memset(text, 'x', sizeof(text));
	n = value_to_text(type, value, text);
	TEST_ASSERT_TRUE(n > 0 && n < VALUE_TEXT_MAX);
	TEST_ASSERT_EQUAL_size_t(n, strlen(text));
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, value_parse(type, text, &again), text);
	TEST_ASSERT_TRUE_MESSAGE(value_number(type, value) == value_number(type, again), text);
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, value_from_text(type, text, (size_t)n, &again, &quality),
	                              text);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(OWS_Q_GOOD, quality, text);
	TEST_ASSERT_TRUE_MESSAGE(value_number(type, value) == value_number(type, again), text);
}

static void check_value(enum ows_type type, const char *text, size_t n)
{
	int64_t value;
	uint8_t quality;
	double number;
	int err;

	if (type == OWS_STRING)
		return;
	err = value_parse(type, text, &value);
	TEST_ASSERT_TRUE(err == 0 || err == -ERANGE || err == -EINVAL);
	if (!err)
		print_and_read(type, value);
	err = value_from_text(type, text, n, &value, &quality);
	TEST_ASSERT_TRUE(err == 0 || err == -EILSEQ);
	if (!err)
		print_and_read(type, value);
	if (n < sizeof(number))
		return;
	memcpy(&number, text, sizeof(number));
	if (value_set_double(type, number, &value) == 0)
		print_and_read(type, value);
	if (value_from_number(type, number, &value, &quality) == 0)
		print_and_read(type, value);
	memcpy(&value, text, sizeof(value));
	if (value_set_integer(type, value, &value) == 0)
		print_and_read(type, value);
}

/* A line through points is exact at them, in both directions, and finite everywhere. */
static void check_points(const char *text)
{
	static const double raws[] = {0, -1, 1e300, -1e300};
	struct scale_point points[SCALE_POINTS_MAX];
	int count = scale_parse(text, points);
	struct scale scale = {.points = points, .count = (unsigned)count};
	uint8_t quality;
	double raw;

	if (count < 0)
		return;
	TEST_ASSERT_TRUE(count >= 2 && count <= SCALE_POINTS_MAX);
	for (int i = 0; i < count; i++) {
		TEST_ASSERT_TRUE(scale_value(&scale, points[i].raw, &quality) == points[i].value);
		TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, quality);
		TEST_ASSERT_EQUAL_INT(0, scale_raw(&scale, points[i].value, &raw));
		TEST_ASSERT_TRUE(raw == points[i].raw);
	}
	for (size_t i = 0; i < sizeof(raws) / sizeof(raws[0]); i++)
		TEST_ASSERT_TRUE(isfinite(scale_value(&scale, raws[i], &quality)));
}

/* Every second beginning of the text is the name of a signal. */
static int find(void *ctx, const char *name, size_t len)
{
	const char *text = ctx;

	TEST_ASSERT_TRUE(name >= text && len <= strlen(name));
	return len % 2 ? (int)len : -1;
}

static void check_name(const char *text)
{
	enum attribute attribute = ATTR_COUNT;
	int record = attribute_lookup("OWS", text, find, (void *)(uintptr_t)text, &attribute);
	const char *fault = signal_name_fault(text);

	TEST_ASSERT_TRUE(record >= 0 || record == -ENOENT);
	if (record >= 0)
		TEST_ASSERT_TRUE(attribute < ATTR_COUNT);
	if (!fault)
		TEST_ASSERT_TRUE(strlen(text) <= SIGNAL_NAME_MAX);
}

static void check_rom(const char *text, size_t n)
{
	uint8_t rom[ROM_LEN], again[ROM_LEN];
	char printed[ROM_TEXT_MAX];

	if (rom_parse(text, n, rom))
		return;
	TEST_ASSERT_EQUAL_UINT8(0, rom_crc8(rom, ROM_LEN));
	for (int format = ROM_F_I; format <= ROM_FIC; format++) {
		int len = rom_print(rom, (enum rom_format)format, printed);

		TEST_ASSERT_EQUAL_size_t(len, strlen(printed));
		TEST_ASSERT_EQUAL_INT_MESSAGE(0, rom_parse(printed, (size_t)len, again), printed);
		TEST_ASSERT_EQUAL_MEMORY_MESSAGE(rom, again, ROM_LEN, printed);
	}
}

static void check_slice(const char *text, size_t n, struct path_slice slice)
{
	TEST_ASSERT_TRUE(!slice.len || (slice.text >= text && slice.text + slice.len <= text + n));
}

static void check_path(const char *text, size_t n)
{
	struct path path;

	if (path_split(text, n, &path))
		return;
	check_slice(text, n, path.device);
	check_slice(text, n, path.last);
	check_slice(text, n, path.property);
	TEST_ASSERT_TRUE(path.bus >= -1);
	TEST_ASSERT_TRUE(!path.has_rom || path.last.len);
	if (path.device.len && path.last.len)
		TEST_ASSERT_TRUE(path_same_device(&path, &path));
}

static void check_addresses(const char *text, size_t n)
{
	static const uint8_t mapped[12] = {[10] = 0xff, [11] = 0xff};
	struct listen_address addresses[2], again[2];
	struct listen_peers peers, same;
	char printed[LISTEN_TEXT_MAX];
	const char *why = NULL;
	int count = listen_parse(text, n, addresses, &why);

	TEST_ASSERT_TRUE(count > 0 || (count == -EINVAL && why));
	for (int i = 0; i < count; i++) {
		listen_print(&addresses[i], printed);
		TEST_ASSERT_TRUE_MESSAGE(listen_parse(printed, strlen(printed), again, &why) > 0,
		                         printed);
		TEST_ASSERT_EQUAL_UINT16(addresses[i].port, again[0].port);
		TEST_ASSERT_EQUAL(addresses[i].is_v6, again[0].is_v6);
		TEST_ASSERT_EQUAL_MEMORY_MESSAGE(addresses[i].bytes, again[0].bytes,
		                                 addresses[i].is_v6 ? 16 : 4, printed);
	}
	if (listen_peers_parse(text, n, &peers, &why))
		return;
	listen_peers_print(&peers, printed);
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, listen_peers_parse(printed, strlen(printed), &same, &why),
	                              printed);
	TEST_ASSERT_EQUAL_UINT_MESSAGE(peers.bits, same.bits, printed);
	/*
	 * An address of IPv4 is looked up in ranges of IPv4, also in the form that IPv6 has for it.
	 */
	bool is_v4_in_v6 = peers.is_v6 && memcmp(peers.bytes, mapped, sizeof(mapped)) == 0;
	TEST_ASSERT_TRUE_MESSAGE(
		listen_peers_have(&same, 1, peers.is_v6, peers.bytes) != is_v4_in_v6, printed);
}

static void check_printable(char *text, size_t n)
{
	size_t len = printable(text, n);

	TEST_ASSERT_TRUE(len <= n);
	for (size_t i = 0; i < len; i++)
		TEST_ASSERT_TRUE((unsigned char)text[i] >= ' ' && text[i] != 0x7f);
	TEST_ASSERT_EQUAL_size_t_MESSAGE(len, printable(text, len), "made printable twice");
}

void fuzz_one(const uint8_t *bytes, size_t n)
{
	enum ows_type type = n ? (enum ows_type)(bytes[0] % 16) : OWS_BOOL;
	char *text, *ended;
	size_t len;

	if (n)
		bytes++, n--;
	/* one with its end, one without */
	text = malloc(n ? n : 1);
	ended = malloc(n + 1);
	TEST_ASSERT_TRUE(text && ended);
	if (n) {
		memcpy(text, bytes, n);
		memcpy(ended, bytes, n);
	}
	ended[n] = '\0';
	len = strlen(ended);
	if (value_type_ok((int)type))
		check_value(type, ended, n);
	check_name(ended);
	check_points(ended);
	check_rom(text, n);
	check_path(text, len);
	check_addresses(text, len);
	check_printable(text, n);
	free(text);
	free(ended);
}
