/* SPDX-License-Identifier: MIT */
/* A fleet of thermometers on a wire with the option DoubleBuffer. */
#include "hal/native/state.h"
#include "unity.h"

#include "tests/unit/aid/buffered.h"

void buffered_again(void)
{
	native_end();
	native_begin();
	fleet_begin();
}

static void buffered_add(const char *chip, unsigned count)
{
	unsigned from = fleet.count;

	fleet_add(chip, count);
	for (unsigned i = from; i < fleet.count; i++) {
		struct sim_slave *slave = fleet.slave[i];

		TEST_ASSERT_EQUAL_INT(0, slave->family->option(slave, "spread", 1));
		/* Some ignore a Convert T while they convert, others begin anew. */
		TEST_ASSERT_EQUAL_INT(0, slave->family->option(slave, "once", i % 2));
	}
}

/* The wire, with chips of the time of genuine ones. */
void buffered_set_out(unsigned count, const char *chip)
{
	wire_init(&host, 1, 1);
	buffered_add(chip, count);
	/* Until a chip has passed its trial its time is that of the data sheet. */
	fleet.early_ns = 170 * HOST_MS;
}

void buffered_start(const char *what)
{
	char why[100] = "";

	bus = wire_open();
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, bus_option(bus, "DoubleBuffer", what, why, sizeof(why)),
	                              why);
	TEST_ASSERT_TRUE(host_run_events(&host, bus, 1, host.now + HOST_S));
	TEST_ASSERT_EQUAL_UINT8(BUS_UP, host.event[0].news);
}

struct thermometer *buffered_chip(unsigned i)
{
	struct native *native = (struct native *)bus;

	return thermometer_of(device_find(&native->table, fleet.slave[i]->rom));
}

/* As if the trials were over: they take six seconds of each chip. */
void buffered_trust(uint32_t shortest_us)
{
	for (unsigned i = 0; i < fleet.count; i++) {
		struct thermometer *chip = buffered_chip(i);

		if (chip->make != MAKE_GENUINE || chip->ahead != AHEAD_UNTRIED)
			continue;
		chip->ahead = AHEAD_TRUSTED;
		chip->shortest_us = shortest_us;
	}
}

void buffered_run(int64_t ns)
{
	fleet_run(host.now + ns);
	host.events = 0;
}

void buffered_run_trials(unsigned seconds)
{
	for (unsigned i = 0; i < seconds; i += 20)
		buffered_run(20 * HOST_S);
}
