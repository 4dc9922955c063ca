/* SPDX-License-Identifier: MIT */
/* The driver of the DS2490 on a simulated one: transactions, searches, pull-ups, recovery. */
#include <errno.h>
#include <string.h>

#include "unity.h"

#include "hal/usb/ds2490.h"
#include "hal/wire/search.h"
#include "tests/unit/aid/parts.h"
#include "tests/unit/aid/usb_scene.h"

static const char house[] = "chip DS2482-100 0x18\n"
			    "DS1420 81.000000000001\n"
			    "DS18B20 28.0000000000E3 as t temperature 21.5\n"
			    "DS18B20 28.0000000000A2 as u temperature 85 parasite\n"
			    "DS2413 3A.0000000000E3 as s\n"
			    "DS2401 01.000000000001\n";
static const char nobody[] = "chip DS2482-100 0x18\n";

static struct sim_ds2490 *chip;

void setUp(void)
{
	sticks_begin();
	chip = &sticks.stick[0].chip;
}

void tearDown(void)
{
	/* whatever a test does, the driver does nothing that the data sheet forbids */
	TEST_ASSERT_EQUAL_UINT64(0, sim_ds2490_forbidden(chip));
	sticks_end();
}

static void anew(void)
{
	tearDown();
	setUp();
}

static void test_a_reading_takes_its_time_on_the_wire_and_few_transfers(void)
{
	int64_t begun, wire;
	uint64_t transfers;

	sticks_start(house);
	begun = sticks.host.now;
	wire = chip->wire_ns;
	transfers = sticks.transfers;
	sticks_check("t");
	TEST_ASSERT_LESS_OR_EQUAL_UINT64(8, sticks.transfers - transfers);
	TEST_ASSERT_LESS_THAN_INT64(chip->wire_ns - wire + 8 * HOST_MS, sticks.host.now - begun);
}

static void test_the_chip_is_set_up_and_its_slew_rate_is_that_of_power_on(void)
{
	sticks_start(house);
	TEST_ASSERT_EQUAL_UINT(3, chip->alternate);
	TEST_ASSERT_EQUAL_UINT(1, chip->state[DS2490_AT_SPEED]);
	TEST_ASSERT_EQUAL_UINT(0, chip->state[DS2490_AT_PULLUP]);
	TEST_ASSERT_EQUAL_UINT(5, chip->state[DS2490_AT_SLEW]);
	TEST_ASSERT_EQUAL_UINT(4, chip->state[DS2490_AT_WRITE1]);
	TEST_ASSERT_EQUAL_UINT(4, chip->state[DS2490_AT_SAMPLE]);
}

static void test_a_long_transaction_goes_in_pieces(void)
{
	uint8_t out[150], in[150];
	const struct link_part part = {
		.reset = true, .out = out, .out_n = 150, .in = in, .in_n = 150};

	sticks_start(house);
	memset(out, 0, sizeof(out));
	TEST_ASSERT_EQUAL_INT(0, sticks.wire->ops->run(sticks.wire, &part));
	for (unsigned i = 0; i < sizeof(in); i++)
		TEST_ASSERT_EQUAL_HEX8(0xFF, in[i]);
}

static void test_a_short_and_nobody_are_told_apart(void)
{
	sticks_start(house);
	stick_event(&sticks.stick[0], "short 0x18 for 10ms");
	TEST_ASSERT_EQUAL_INT(-ECOMM, part_reset(sticks.wire));
	TEST_ASSERT_EQUAL_INT(-ECOMM, sticks.wire->ops->recover(sticks.wire, LINK_BUS_RESET));
	sticks.host.now += 20 * HOST_MS;
	TEST_ASSERT_EQUAL_INT(1, part_reset(sticks.wire));
	anew();
	sticks_start(nobody);
	TEST_ASSERT_EQUAL_INT(0, part_reset(sticks.wire));
	TEST_ASSERT_EQUAL_INT(0, part_reset(sticks.wire));
}

static unsigned found_by(bool alarm, uint8_t family)
{
	struct search search;
	unsigned count = 0;

	search_begin(&search, alarm, family);
	for (int found = 1; found == 1 && count < 20; count += found == 1) {
		found = search_next(&search, sticks.wire);
		TEST_ASSERT_GREATER_OR_EQUAL_INT(0, found);
		if (found == 1)
			TEST_ASSERT_TRUE(!family || search.rom[0] == family);
	}
	return count;
}

static void test_the_macro_finds_all_devices_of_a_family_of_an_alarm_or_none(void)
{
	sticks_start(house);
	TEST_ASSERT_EQUAL_UINT(5, found_by(false, 0));
	TEST_ASSERT_EQUAL_UINT(2, found_by(false, 0x28));
	TEST_ASSERT_EQUAL_UINT(1, found_by(false, 0x3A));
	TEST_ASSERT_EQUAL_UINT(0, found_by(false, 0x29));
	TEST_ASSERT_EQUAL_UINT(0, found_by(true, 0));
	sticks_check("t");
	anew();
	sticks_start(nobody);
	TEST_ASSERT_EQUAL_UINT(0, found_by(false, 0));
}

static void test_a_search_for_one_id_says_whether_it_is_there_and_leaves_it_selected(void)
{
	static const uint8_t absent[8] = {0x28, 1, 2, 3, 4, 5, 6, 0x7b};
	const uint8_t *rom;
	uint8_t state = 0;

	sticks_start(house);
	rom = sim_net_slave(&sticks.stick[0].net, "s")->rom;
	TEST_ASSERT_EQUAL_INT(1, search_verify(sticks.wire, rom, false));
	state = 0xF5; /* PIO access read */
	TEST_ASSERT_EQUAL_INT(0, part_write(sticks.wire, &state, 1, LINK_IDLE));
	TEST_ASSERT_EQUAL_INT(0, part_read(sticks.wire, &state, 1));
	TEST_ASSERT_EQUAL_HEX8(0x0F, (state & 0x0F) ^ (state >> 4 & 0x0F));
	TEST_ASSERT_EQUAL_INT(0, search_verify(sticks.wire, absent, false));
	TEST_ASSERT_EQUAL_INT(0, search_verify(sticks.wire, rom, true));
}

static void test_ids_that_are_not_there_are_decided_as_a_slot_by_slot_search_does(void)
{
	static const uint8_t near[8] = {0x28, 0xA2}, far[8] = {0x28, 0, 0, 0, 0, 0x43};
	const uint8_t *roms[4] = {near, far};
	bool away[4] = {false};

	sticks_start(house);
	roms[2] = sim_net_slave(&sticks.stick[0].net, "t")->rom;
	roms[3] = sim_net_slave(&sticks.stick[0].net, "u")->rom;
	TEST_ASSERT_EQUAL_INT(0, search_among(sticks.wire, roms, away, 4, 64));
	TEST_ASSERT_TRUE(away[0]);
	TEST_ASSERT_FALSE(away[2]);
	TEST_ASSERT_FALSE(away[3]);
}

/* Of what the search's macro does not say, nothing is concluded. */
static void test_a_path_says_of_another_branch_only_what_is_known(void)
{
	uint8_t near[8] = {0x28, 0, 0, 0, 0, 0, 0x01}, absent[8];
	const uint8_t *roms[2] = {near};
	bool away[2] = {false};

	sticks_start("chip DS2482-100 0x18\n"
	             "DS18B20 28.0000000000E3 as t\n"
	             "DS18B20 28.0000000000A2 as u\n");
	/* it goes the way of t, where u is on the other branch, and leaves it at the next bit */
	roms[1] = sim_net_slave(&sticks.stick[0].net, "u")->rom;
	TEST_ASSERT_EQUAL_INT(0, search_among(sticks.wire, roms, away, 2, 64));
	TEST_ASSERT_TRUE(away[0]);
	TEST_ASSERT_FALSE(away[1]);
	/* it differs from t in one bit, where t alone is left and has the 1 */
	memcpy(absent, sim_net_slave(&sticks.stick[0].net, "t")->rom, 8);
	absent[6] = 0xE1;
	TEST_ASSERT_EQUAL_INT(0, search_verify(sticks.wire, absent, false));
}

static void test_devices_that_leave_in_the_middle_of_a_search_are_an_error(void)
{
	uint8_t rom[8] = {0}, conflict[8];

	sticks_start(house);
	TEST_ASSERT_EQUAL_INT(1, part_reset(sticks.wire));
	for (unsigned i = 0; i < 5; i++) {
		const struct sim_event pull = {
			.what = SIM_PLUG,
			.slave = sticks.stick[0].net.chip[0].wire[0].slaves[i],
			.at_ns = sticks.stick[0].net.time + 8 * HOST_MS};

		TEST_ASSERT_EQUAL_INT(0, sim_net_add_event(&sticks.stick[0].net, &pull));
	}
	TEST_ASSERT_EQUAL_INT(-EBADMSG, sticks.wire->ops->path(sticks.wire, false, ONEWIRE_SEARCH,
	                                                       rom, conflict));
	TEST_ASSERT_EQUAL_INT(0, part_reset(sticks.wire));
}

static void test_the_strong_pull_up_lasts_until_the_next_call(void)
{
	uint8_t out[10] = {0x55}, in[9];
	const struct link_part part = {
		.reset = true, .out = out, .out_n = 10, .after = LINK_STRONG};

	sticks_start(house);
	memcpy(out + 1, sim_net_slave(&sticks.stick[0].net, "u")->rom, 8);
	out[9] = 0x44;
	TEST_ASSERT_EQUAL_INT(0, sticks.wire->ops->run(sticks.wire, &part));
	TEST_ASSERT_TRUE(sticks.stick[0].net.chip[0].wire[0].strong);
	sticks.host.now += 800 * HOST_MS;
	TEST_ASSERT_EQUAL_INT(0, sticks_scratchpad("u", in));
	TEST_ASSERT_FALSE(sticks.stick[0].net.chip[0].wire[0].strong);
	TEST_ASSERT_EQUAL_UINT64(1, sim_net_slave(&sticks.stick[0].net, "u")->conversions);
	TEST_ASSERT_EQUAL_UINT64(1, sim_net_slave(&sticks.stick[0].net, "u")->power_ons);
	TEST_ASSERT_EQUAL_INT(0, sticks.wire->ops->run(sticks.wire, &part));
	sticks.master->ops->close(sticks.master);
	TEST_ASSERT_FALSE(sticks.stick[0].net.chip[0].wire[0].strong);
}

static void test_a_slot_is_read_and_may_be_followed_by_the_strong_pull_up(void)
{
	sticks_start(house);
	TEST_ASSERT_EQUAL_INT(1, part_reset(sticks.wire));
	TEST_ASSERT_EQUAL_INT(1, link_slot(sticks.wire, true, LINK_IDLE));
	TEST_ASSERT_EQUAL_INT(0, link_slot(sticks.wire, false, LINK_STRONG));
	TEST_ASSERT_TRUE(sticks.stick[0].net.chip[0].wire[0].strong);
	TEST_ASSERT_EQUAL_INT(1, link_slot(sticks.wire, true, LINK_IDLE));
	TEST_ASSERT_FALSE(sticks.stick[0].net.chip[0].wire[0].strong);
}

/* Bytes that an error has left are never taken for an answer. */
static void test_what_is_left_in_the_buffers_is_an_error_once_and_is_cleared(void)
{
	uint8_t in[9];

	sticks_start(house);
	for (unsigned n = 1; n <= 20; n++) {
		chip->in.count = n;
		TEST_ASSERT_EQUAL_INT(-EIO, sticks_scratchpad("t", in));
		sticks_check("t");
		chip->out.count = n;
		TEST_ASSERT_EQUAL_INT(-EIO, sticks_scratchpad("t", in));
		sticks_check("t");
	}
	TEST_ASSERT_EQUAL_UINT(5, chip->state[DS2490_AT_SLEW]);
	/* at once, before anything is written; and in a slot, which no reset precedes */
	chip->out.count = 3;
	TEST_ASSERT_EQUAL_INT(-EIO, part_reset(sticks.wire));
	TEST_ASSERT_EQUAL_INT(1, part_reset(sticks.wire));
	chip->in.count = 1;
	TEST_ASSERT_EQUAL_INT(-EIO, link_slot(sticks.wire, true, LINK_IDLE));
}

static void test_after_an_error_a_transaction_does_not_go_on(void)
{
	uint8_t byte = 0xBE;
	uint64_t transfers;

	sticks_start(house);
	chip->in.count = 1;
	TEST_ASSERT_EQUAL_INT(-EIO, part_reset(sticks.wire));
	transfers = sticks.transfers;
	TEST_ASSERT_EQUAL_INT(-EIO, part_write(sticks.wire, &byte, 1, LINK_IDLE));
	TEST_ASSERT_EQUAL_INT(-EIO, link_slot(sticks.wire, true, LINK_IDLE));
	TEST_ASSERT_EQUAL_UINT64(transfers, sticks.transfers);
	sticks_check("t");
}

static void short_in(int64_t ns)
{
	struct sim_net *net = &sticks.stick[0].net;
	struct sim_event event = {.what = SIM_SHORT, .on = true};

	event.at_ns = net->time + ns;
	TEST_ASSERT_EQUAL_INT(0, sim_net_add_event(net, &event));
	event.on = false;
	event.at_ns += 200 * HOST_MS;
	TEST_ASSERT_EQUAL_INT(0, sim_net_add_event(net, &event));
}

static void test_what_did_not_reach_the_wire_is_an_error(void)
{
	uint8_t out[2] = {0xCC, 0xBE}, in[9];
	const struct link_part strong = {
		.reset = true, .out = out, .after = LINK_STRONG, .out_n = 1};

	sticks_start(house);
	for (int64_t ms = 3; ms < 9; ms++) {
		short_in(ms * HOST_MS);
		TEST_ASSERT_EQUAL_INT(-EIO, sticks_scratchpad("t", in));
		sticks.host.now += HOST_S;
		sticks_check("t");
	}
	TEST_ASSERT_EQUAL_INT(1, part_reset(sticks.wire));
	short_in(2 * HOST_MS + HOST_MS / 2);
	TEST_ASSERT_EQUAL_INT(-EIO, sticks.wire->ops->run(sticks.wire, &strong));
	sticks.host.now += HOST_S;
	sticks_check("t");
}

/* Where there is none, that it stays idle is enough; a chip that has given one gives it always. */
static void test_a_reset_without_a_result_is_no_presence(void)
{
	stick_add(house);
	sticks.stick[0].mute = true;
	sticks_make("");
	TEST_ASSERT_EQUAL_INT(0, sticks_try());
	sticks_check("t");
	sticks.stick[0].mute = false;
	sticks_check("t");
	sticks.stick[0].mute = true;
	TEST_ASSERT_EQUAL_INT(-ETIMEDOUT, part_reset(sticks.wire));
}

static void test_a_halted_chip_goes_on_and_one_that_lost_a_command_is_reset(void)
{
	uint8_t in[9];

	sticks_start(house);
	chip->halted = true;
	TEST_ASSERT_NOT_EQUAL_INT(0, sticks_scratchpad("t", in));
	sticks_check("t");
	chip->ep0_full = true;
	TEST_ASSERT_EQUAL_INT(-EIO, sticks_scratchpad("t", in));
	sticks_check("t");
	TEST_ASSERT_GREATER_THAN_UINT64(0, chip->faults.setups_lost);
	chip->faults.setups_lost = 0; /* of the test */
}

static void test_an_adapter_that_has_lost_its_settings_is_noticed(void)
{
	uint8_t in[9];

	sticks_start(house);
	chip->state[DS2490_AT_PULLUP] = 0x20;
	TEST_ASSERT_EQUAL_INT(-ENXIO, sticks_scratchpad("t", in));
	TEST_ASSERT_EQUAL_INT(0, sticks.wire->ops->recover(sticks.wire, LINK_CHIP_RESET));
	TEST_ASSERT_EQUAL_UINT(0, chip->state[DS2490_AT_PULLUP]);
	sticks_check("t");
}

static void test_a_silent_adapter_is_an_error_in_time_and_serves_when_it_is_back(void)
{
	uint8_t in[9];
	int64_t begun;

	sticks_start(house);
	for (unsigned endpoint = 0; endpoint < 4; endpoint++) {
		begun = sticks.host.now;
		chip->silent = (uint8_t)(1 << endpoint);
		TEST_ASSERT_EQUAL_INT(-ETIMEDOUT, sticks_scratchpad("t", in));
		(void)sticks.wire->ops->recover(sticks.wire, LINK_BUS_RESET);
		(void)sticks.wire->ops->recover(sticks.wire, LINK_CHIP_RESET);
		TEST_ASSERT_EQUAL_INT(-EOPNOTSUPP,
		                      sticks.wire->ops->recover(sticks.wire, LINK_POWER_CYCLE));
		TEST_ASSERT_LESS_THAN_INT64(2 * HOST_S, sticks.host.now - begun);
		chip->silent = 0;
		TEST_ASSERT_EQUAL_INT(0, sticks.wire->ops->recover(sticks.wire, LINK_BUS_RESET));
		sticks_check("t");
	}
}

static void test_an_endpoint_that_stalls_is_cleared(void)
{
	uint8_t in[9];

	sticks_start(house);
	for (unsigned endpoint = 1; endpoint < 4; endpoint++) {
		chip->stalled = (uint8_t)(1 << endpoint);
		TEST_ASSERT_EQUAL_INT(-EIO, sticks_scratchpad("t", in));
		sticks_check("t");
	}
	TEST_ASSERT_EQUAL_UINT(0, sticks.stick[0].resets);
}

static void test_an_adapter_that_does_not_answer_is_reset_by_its_hub_when_it_is_opened(void)
{
	stick_add(house);
	sticks_make("");
	chip->silent = 0x0F;
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, sticks_try(), sticks.why);
	TEST_ASSERT_EQUAL_UINT(1, sticks.stick[0].resets);
	sticks_check("t");
}

/* A transaction with a strong pull-up, a reading, and a path of a search. */
static int visit(void)
{
	uint8_t out = 0xCC, in[9];
	const struct link_part part = {
		.reset = true, .out = &out, .out_n = 1, .after = LINK_STRONG};
	struct search search;
	int err = sticks.wire->ops->run(sticks.wire, &part);

	if (!err)
		err = sticks_scratchpad("t", in);
	if (!err)
		TEST_ASSERT_EQUAL_HEX8(0x50, in[0]);
	search_begin(&search, false, 0);
	return err ? err : search_next(&search, sticks.wire);
}

static void test_a_transfer_that_fails_anywhere_spoils_one_transaction_and_no_value(void)
{
	static const int errors[] = {-EIO, -ETIMEDOUT};
	int err = -EIO;

	sticks_start(house);
	for (unsigned n = 1; err != 1; n++) {
		sticks.fail = errors[n % 2];
		sticks.fail_at = sticks.transfers + n;
		err = visit();
		sticks.fail_at = 0;
		if (err != 1)
			TEST_ASSERT_TRUE(err == -EIO || err == -ETIMEDOUT);
		else
			TEST_ASSERT_GREATER_THAN_UINT(15, n);
		sticks_check("t");
	}
}

/* Nobody else would end it, and the next device that is read would have it. */
static void test_a_strong_pull_up_that_may_be_on_is_ended_when_the_adapter_is_closed(void)
{
	static const int errors[] = {-EIO, -ETIMEDOUT, -ECANCELED};
	uint8_t out = 0xCC;
	const struct link_part strong = {
		.reset = true, .out = &out, .out_n = 1, .after = LINK_STRONG};

	sticks_start(house);
	for (unsigned n = 0; n < 25 * 6 * 3; n++) {
		sticks.fail = errors[n % 3];
		sticks.fail_at = sticks.transfers + 1 + n / 18;
		(void)sticks.wire->ops->run(sticks.wire, &strong);
		sticks.fail_at = sticks.transfers + 1 + n / 3 % 6;
		(void)part_reset(sticks.wire);
		sticks.fail_at = 0;
		sticks.master->ops->close(sticks.master);
		TEST_ASSERT_FALSE(sticks.stick[0].net.chip[0].wire[0].strong);
		TEST_ASSERT_EQUAL_INT_MESSAGE(0, sticks_try(), sticks.why);
	}
	sticks_check("t");
}

static void test_pulled_anywhere_the_adapter_is_gone_and_is_back_when_it_is_plugged_in(void)
{
	int err = -ENODEV;

	sticks_start(house);
	for (unsigned n = 1; err != 1; n++) {
		sticks.pulls = true;
		sticks.fail_at = sticks.transfers + n;
		err = visit();
		sticks.pulls = false;
		sticks.fail_at = 0;
		if (err == 1)
			break;
		TEST_ASSERT_EQUAL_INT(-ENODEV, err);
		sticks.master->ops->close(sticks.master);
		TEST_ASSERT_EQUAL_INT(-ENODEV, part_reset(sticks.wire));
		TEST_ASSERT_EQUAL_INT(-ENODEV,
		                      sticks.wire->ops->recover(sticks.wire, LINK_BUS_RESET));
		TEST_ASSERT_EQUAL_INT(-ENODEV, sticks_try());
		stick_plug(&sticks.stick[0], n % 2 ? "1-1.4" : "2-1");
		TEST_ASSERT_EQUAL_INT_MESSAGE(0, sticks_try(), sticks.why);
		sticks_check("t");
	}
}

static void test_a_shutdown_ends_every_wait(void)
{
	uint8_t in[9];

	sticks_start(house);
	sticks.host.shutdown = true;
	TEST_ASSERT_EQUAL_INT(-ECANCELED, sticks_scratchpad("t", in));
	sticks.master->ops->close(sticks.master);
	TEST_ASSERT_EQUAL_INT(-ECANCELED, sticks_try());
}

static void test_what_a_transaction_costs_is_counted(void)
{
	struct link_cost before, after;
	struct link_master_cost shared;

	sticks_start(house);
	sticks.wire->ops->cost(sticks.wire, &before);
	sticks_check("t");
	sticks.wire->ops->cost(sticks.wire, &after);
	TEST_ASSERT_EQUAL_UINT64(1, after.resets - before.resets);
	TEST_ASSERT_EQUAL_UINT64(1096000 + 19 * 8 * 69000, after.wire_ns - before.wire_ns);
	sticks.master->ops->cost(sticks.master, &shared);
	TEST_ASSERT_GREATER_THAN_UINT64(20, shared.bytes);
	TEST_ASSERT_EQUAL_UINT64(sticks.transfers, shared.transfers + 1); /* clear is none */
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_reading_takes_its_time_on_the_wire_and_few_transfers);
	RUN_TEST(test_the_chip_is_set_up_and_its_slew_rate_is_that_of_power_on);
	RUN_TEST(test_a_long_transaction_goes_in_pieces);
	RUN_TEST(test_a_short_and_nobody_are_told_apart);
	RUN_TEST(test_the_macro_finds_all_devices_of_a_family_of_an_alarm_or_none);
	RUN_TEST(test_a_search_for_one_id_says_whether_it_is_there_and_leaves_it_selected);
	RUN_TEST(test_ids_that_are_not_there_are_decided_as_a_slot_by_slot_search_does);
	RUN_TEST(test_a_path_says_of_another_branch_only_what_is_known);
	RUN_TEST(test_devices_that_leave_in_the_middle_of_a_search_are_an_error);
	RUN_TEST(test_the_strong_pull_up_lasts_until_the_next_call);
	RUN_TEST(test_a_slot_is_read_and_may_be_followed_by_the_strong_pull_up);
	RUN_TEST(test_what_is_left_in_the_buffers_is_an_error_once_and_is_cleared);
	RUN_TEST(test_after_an_error_a_transaction_does_not_go_on);
	RUN_TEST(test_what_did_not_reach_the_wire_is_an_error);
	RUN_TEST(test_a_reset_without_a_result_is_no_presence);
	RUN_TEST(test_a_halted_chip_goes_on_and_one_that_lost_a_command_is_reset);
	RUN_TEST(test_an_adapter_that_has_lost_its_settings_is_noticed);
	RUN_TEST(test_a_silent_adapter_is_an_error_in_time_and_serves_when_it_is_back);
	RUN_TEST(test_an_endpoint_that_stalls_is_cleared);
	RUN_TEST(test_an_adapter_that_does_not_answer_is_reset_by_its_hub_when_it_is_opened);
	RUN_TEST(test_a_transfer_that_fails_anywhere_spoils_one_transaction_and_no_value);
	RUN_TEST(test_a_strong_pull_up_that_may_be_on_is_ended_when_the_adapter_is_closed);
	RUN_TEST(test_pulled_anywhere_the_adapter_is_gone_and_is_back_when_it_is_plugged_in);
	RUN_TEST(test_a_shutdown_ends_every_wait);
	RUN_TEST(test_what_a_transaction_costs_is_counted);
	return UNITY_END();
}
