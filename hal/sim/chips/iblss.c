/* SPDX-License-Identifier: MIT */
/*
 * iButtonLink SmartSlave SS-WALL-TH: temperature and humidity. No data sheet can be had; the facts
 * are those of OWFS's driver. No source says what its checksum covers: the page alone, or, with the
 * option "command" 1, what was sent before it, too; with 2 it fits neither.
 */

#include "hal/base/time.h"
#include "hal/sim/families.h"

enum { TEMPERATURE, HUMIDITY }; /* inputs */
/* Bytes of its page. */
enum { SUBTYPE = 0, VERSION = 1, BUSY = 2, TEMPERATURE_AT = 4, HUMIDITY_AT = 6, VALID = 8 };
enum { PAGE = 32 };

/* The driver waits a second for a conversion. */
#define CONVERT_NS (900 * NS_PER_MS)

struct iblss {
	uint8_t page[PAGE], led;
	int64_t done; /* the conversion under way ends then; 0: none is */
	uint8_t covers;
};

static void iblss_power_on(struct sim_slave *slave)
{
	struct iblss *s = slave->state;

	*s = (struct iblss){.page = {[SUBTYPE] = 0x04, [VERSION] = 0x12}, .covers = s->covers};
}

static void iblss_advance(struct sim_slave *slave)
{
	struct iblss *s = slave->state;

	if (!s->done || slave->now < s->done)
		return;
	sim_put_high(s->page + TEMPERATURE_AT, 2,
	             sim_round(sim_input_at(slave, TEMPERATURE, s->done) * 128));
	sim_put_high(s->page + HUMIDITY_AT, 2,
	             sim_round(sim_input_at(slave, HUMIDITY, s->done) * 128));
	s->page[BUSY] = 0;
	s->page[VALID] = 1;
	s->done = 0;
	slave->conversions++;
}

static void iblss_convert(struct sim_slave *slave)
{
	struct iblss *s = slave->state;

	s->page[BUSY] = 1;
	s->done = slave->now + CONVERT_NS;
	sim_end(slave);
}

static const struct sim_option options[] = {SIM_OPTION(iblss, "command", 0, 2, covers), {0}};

static void iblss_read_page(struct sim_slave *slave)
{
	struct iblss *s = slave->state;

	if (slave->address) {
		sim_end(slave);
		return;
	}
	if (s->covers == 0)
		slave->crc = 0;
	else if (s->covers == 2)
		slave->crc ^= 0x5AA5;
	sim_send_checked(slave, s->page, PAGE);
}

static void set_led(struct sim_slave *slave)
{
	if (slave->taken[0] == 0)
		sim_state(slave, iblss)->led = slave->taken[1];
	sim_end(slave);
}

static const struct sim_function functions[] = {
	{.code = 0xB4, .start = iblss_convert},
	{.code = 0xF0, .takes = 1, .start = iblss_read_page},
	{.code = 0xA5, .takes = 2, .start = set_led},
	{0},
};

static const struct sim_input inputs[] = {
	[TEMPERATURE] = {SIM_TEMPERATURE_INPUT},
	[HUMIDITY] = {.name = "humidity", .start = 50, .least = 0, .most = 100},
	{0},
};

const struct sim_family sim_iblss = {
	.name = "IBLSS",
	.code = 0xFE,
	.state_size = sizeof(struct iblss),
	.functions = functions,
	.inputs = inputs,
	.power_on = iblss_power_on,
	.advance = iblss_advance,
	.options = options,
	SIM_MEMORY(iblss, led, 1),
};
