/* SPDX-License-Identifier: MIT */
/* What all adapters with one wire share, over a kind that writes down what it is asked for. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "hal/wire/adapter.h"
#include "tests/unit/aid/host.h"
#include "tests/unit/aid/parts.h"

static struct host host;
static struct adapter adapter;
static char asked[256]; /* "settle", "pass R 4 0", "bits 44 8 S" */
static int fails;       /* what the next of them returns */
static uint8_t back;    /* what bits() reads */
static bool nobody;     /* no chip answers a reset */

static int note(const char *text)
{
	int err = fails;

	snprintf(asked + strlen(asked), sizeof(asked) - strlen(asked), "%s%s", *asked ? ", " : "",
	         text);
	fails = 0;
	return err;
}

static int settle(struct adapter *base)
{
	(void)base;
	return note("settle");
}

static int pass(struct adapter *base, bool reset, const uint8_t *out, size_t out_n, uint8_t *in,
                size_t in_n)
{
	char text[40];

	TEST_ASSERT_EQUAL_PTR(&adapter, base);
	for (size_t i = 0; i < out_n; i++)
		TEST_ASSERT_EQUAL_HEX8(out[0] + i, out[i]);
	if (in_n)
		memset(in, 0x5A, in_n);
	snprintf(text, sizeof(text), "pass%s %zu %zu", reset ? " R" : "", out_n, in_n);
	int err = note(text);

	return err ? err : reset && nobody ? -EHOSTDOWN : 0;
}

static int bits(struct adapter *base, uint8_t byte, unsigned n, bool strong)
{
	char text[40];

	(void)base;
	snprintf(text, sizeof(text), "bits %02X %u%s", byte, n, strong ? " S" : "");
	int err = note(text);

	return err ? err : back;
}

static int path(struct adapter *base, bool reset, uint8_t command, uint8_t rom[8],
                uint8_t conflict[8])
{
	(void)base, (void)reset, (void)command, (void)rom, (void)conflict;
	return note("path");
}

static int renew(struct adapter *base)
{
	(void)base;
	return note("renew");
}

static const struct link_ops link_ops = {.name = "test", ADAPTER_LINK_SLOTS};
static const struct adapter_kind strong = {.link = &link_ops,
                                           .facts = {.strong = true},
                                           .piece = 4,
                                           .settle = settle,
                                           .pass = pass,
                                           .bits = bits,
                                           .path = path,
                                           .renew = renew};
static const struct adapter_kind weak = {
	.link = &link_ops, .piece = 4, .settle = settle, .pass = pass, .bits = bits};
static const struct link_master_ops master_ops = {ADAPTER_MASTER_SLOTS};

static void start(const struct adapter_kind *kind)
{
	memset(&adapter, 0, sizeof(adapter));
	adapter_init(&adapter, kind, &master_ops, &host.env);
	adapter.open = true;
}

void setUp(void)
{
	host_init_virtual(&host);
	*asked = '\0';
	fails = 0;
	nobody = false;
	start(&strong);
}

void tearDown(void)
{
}

/* And forgets it. */
static void was_asked(const char *text)
{
	TEST_ASSERT_EQUAL_STRING(text, asked);
	*asked = '\0';
}

static void test_a_part_goes_in_pieces_and_its_reset_with_the_first(void)
{
	uint8_t out[6] = {1, 2, 3, 4, 5, 6}, in[5] = {0};
	struct link_part part = {.reset = true, .out = out, .out_n = 6, .in = in, .in_n = 5};

	TEST_ASSERT_EQUAL_INT(0, adapter_run(&adapter.link, &part));
	was_asked("pass R 4 0, pass 2 2, pass 0 3");
	TEST_ASSERT_EACH_EQUAL_HEX8(0x5A, in, 5);
	TEST_ASSERT_EQUAL_INT(1, part_reset(&adapter.link));
	was_asked("pass R 0 0");
	part = (struct link_part){.reset = false};
	TEST_ASSERT_EQUAL_INT(0, adapter_run(&adapter.link, &part));
	was_asked("");
}

static void test_the_byte_before_a_pull_up_goes_alone_and_has_to_come_back(void)
{
	uint8_t out[5] = {0x40, 0x41, 0x42, 0x43, 0x44};

	back = 0x44;
	TEST_ASSERT_EQUAL_INT(0, part_write(&adapter.link, out, 5, LINK_STRONG));
	was_asked("pass 4 0, bits 44 8 S");
	TEST_ASSERT_EQUAL_INT(0, part_write(&adapter.link, out + 4, 1, LINK_STRONG));
	was_asked("bits 44 8 S");
	back = 0x45;
	TEST_ASSERT_EQUAL_INT(-EIO, part_write(&adapter.link, out + 4, 1, LINK_STRONG));
	TEST_ASSERT_TRUE(adapter.lost);
}

static void test_after_an_error_nothing_goes_on_until_it_is_settled_before_a_reset(void)
{
	uint8_t byte = 0;

	fails = -EIO;
	TEST_ASSERT_EQUAL_INT(-EIO, part_read(&adapter.link, &byte, 1));
	was_asked("pass 0 1");
	TEST_ASSERT_EQUAL_INT(-EIO, part_read(&adapter.link, &byte, 1));
	TEST_ASSERT_EQUAL_INT(-EIO, adapter_slot(&adapter.link, true, LINK_IDLE));
	was_asked("");
	fails = -ETIMEDOUT;
	TEST_ASSERT_EQUAL_INT(-ETIMEDOUT, part_reset(&adapter.link));
	was_asked("settle");
	TEST_ASSERT_EQUAL_INT(1, part_reset(&adapter.link));
	was_asked("settle, pass R 0 0");
	back = 1;
	TEST_ASSERT_EQUAL_INT(1, adapter_slot(&adapter.link, true, LINK_STRONG));
	was_asked("bits 01 1 S");
}

static void test_errors_that_say_what_the_wire_had_leave_nothing_to_settle(void)
{
	static const int known[] = {-ECOMM, -EHOSTDOWN, -EBADMSG},
			 others[] = {-EIO, -ETIMEDOUT, -ENXIO, -ENODEV, -ECANCELED};
	uint8_t rom[8] = {0}, conflict[8];

	for (size_t i = 0; i < sizeof(known) / sizeof(known[0]); i++) {
		fails = known[i];
		TEST_ASSERT_EQUAL_INT(known[i],
		                      adapter_path(&adapter.link, true, 0xF0, rom, conflict));
		was_asked("path");
	}
	for (size_t i = 0; i < sizeof(others) / sizeof(others[0]); i++) {
		fails = others[i];
		TEST_ASSERT_EQUAL_INT(others[i],
		                      adapter_path(&adapter.link, true, 0xF0, rom, conflict));
		was_asked("path");
		TEST_ASSERT_EQUAL_INT(-EIO,
		                      adapter_path(&adapter.link, false, 0xF0, rom, conflict));
		was_asked("");
		TEST_ASSERT_EQUAL_INT(0, adapter_path(&adapter.link, true, 0xF0, rom, conflict));
		was_asked("settle, path");
		fails = others[i];
		TEST_ASSERT_EQUAL_INT(others[i], adapter_slot(&adapter.link, true, LINK_IDLE));
		was_asked("bits 01 1");
		TEST_ASSERT_EQUAL_INT(1, part_reset(&adapter.link));
		was_asked("settle, pass R 0 0");
	}
}

static void test_each_rung_ends_with_a_reset(void)
{
	TEST_ASSERT_EQUAL_INT(0, adapter_recover(&adapter.link, LINK_BUS_RESET));
	was_asked("settle, pass R 0 0");
	TEST_ASSERT_EQUAL_INT(0, adapter_recover(&adapter.link, LINK_CHIP_RESET));
	was_asked("renew, pass R 0 0");
	fails = -EIO;
	TEST_ASSERT_EQUAL_INT(-EIO, adapter_recover(&adapter.link, LINK_CHIP_RESET));
	was_asked("renew");
	TEST_ASSERT_EQUAL_INT(-EOPNOTSUPP, adapter_recover(&adapter.link, LINK_POWER_CYCLE));
	adapter.lost = false;
	nobody = true; /* so may a wire be */
	TEST_ASSERT_EQUAL_INT(0, adapter_recover(&adapter.link, LINK_CHIP_RESET));
}

static void test_one_without_chip_and_pull_up_says_so_and_does_nothing(void)
{
	uint8_t byte = 0x44;

	start(&weak);
	TEST_ASSERT_EQUAL_INT(-EOPNOTSUPP, part_write(&adapter.link, &byte, 1, LINK_STRONG));
	TEST_ASSERT_EQUAL_INT(-EOPNOTSUPP, adapter_slot(&adapter.link, true, LINK_STRONG));
	TEST_ASSERT_EQUAL_INT(-EOPNOTSUPP, adapter_recover(&adapter.link, LINK_CHIP_RESET));
	was_asked("");
}

static void test_a_closed_one_is_gone(void)
{
	adapter.open = false;
	TEST_ASSERT_EQUAL_INT(-ENODEV, part_reset(&adapter.link));
	TEST_ASSERT_EQUAL_INT(-ENODEV, adapter_slot(&adapter.link, true, LINK_IDLE));
	TEST_ASSERT_EQUAL_INT(-ENODEV, adapter_recover(&adapter.link, LINK_POWER_CYCLE));
	TEST_ASSERT_EQUAL_UINT(0, adapter_channels(&adapter.master));
	TEST_ASSERT_EQUAL_PTR(&adapter.link, adapter_channel(&adapter.master, 0));
	TEST_ASSERT_NULL(adapter_channel(&adapter.master, 1));
	was_asked("");
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_part_goes_in_pieces_and_its_reset_with_the_first);
	RUN_TEST(test_the_byte_before_a_pull_up_goes_alone_and_has_to_come_back);
	RUN_TEST(test_after_an_error_nothing_goes_on_until_it_is_settled_before_a_reset);
	RUN_TEST(test_errors_that_say_what_the_wire_had_leave_nothing_to_settle);
	RUN_TEST(test_each_rung_ends_with_a_reset);
	RUN_TEST(test_one_without_chip_and_pull_up_says_so_and_does_nothing);
	RUN_TEST(test_a_closed_one_is_gone);
	return UNITY_END();
}
