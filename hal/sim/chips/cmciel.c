/* SPDX-License-Identifier: MIT */
/*
 * Sensors of CMC Industrial Electronics: mRS001 (rotation), mCM001 (alternating current), mDI001
 * (four fail-safe contacts), mAM001 (analog input). No data sheet can be had; the facts are those
 * of OWFS's driver and manual pages.
 */
#include "hal/sim/families.h"

/* Bits of a word of the mDI001, from which on there is one for each contact. */
enum { CLOSED = 0, SHORTED = 4, OPEN = 8, STATUS_WORD = 0x8000 };

/* What the sensor has measured, 16 bits. */
static unsigned reading(const struct sim_slave *slave, int64_t t)
{
	unsigned word = STATUS_WORD;

	switch (slave->family->code) {
	case 0xA0: /* turns a minute, below zero in reverse */
		return (unsigned)sim_within(sim_input_at(slave, 0, t), -1000, 1000);
	case 0xA2: /* 10 mA */
		return (unsigned)sim_within(sim_input_at(slave, 0, t) * 100, 0, 500);
	case 0xB2: /* 10,000 is 10 V or 20 mA */
		return (unsigned)sim_within(sim_input_at(slave, 0, t) * 1000, 0, 10000);
	}
	for (unsigned i = 0; i < 4; i++) {
		int contact = sim_within(sim_input_at(slave, i, t), 0, 3);

		if (contact)
			word |= 1u << (contact == 1 ? CLOSED : contact == 2 ? SHORTED : OPEN) << i;
	}
	return word;
}

static void cmciel_read_scratchpad(struct sim_slave *slave)
{
	unsigned word = reading(slave, slave->now);
	uint8_t out[2] = {(uint8_t)word, (uint8_t)(word >> 8)};

	sim_send_crc8(slave, out, 2);
}

static const struct sim_function functions[] = {
	{.code = 0xBE, .start = cmciel_read_scratchpad},
	{.code = 0x4E, .takes = 3}, /* Write Config: its effect is not known */
	{0},
};

static const struct sim_input rotation[] = {{.name = "rpm", .least = -1000, .most = 1000}, {0}};
static const struct sim_input current[] = {{.name = "current", .least = 0, .most = 5}, {0}};
static const struct sim_input analog[] = {{.name = "volts", .least = 0, .most = 10}, {0}};

/* 0: the contact is open, 1: closed, 2: its loop is shorted, 3: its loop is interrupted. */
#define CONTACT(text) .name = (text), .least = 0, .most = 3
static const struct sim_input contacts[] = {{CONTACT("contact.0")},
                                            {CONTACT("contact.1")},
                                            {CONTACT("contact.2")},
                                            {CONTACT("contact.3")},
                                            {0}};

#define SENSOR(part, family, inputs_) \
	.name = (part), .code = (family), .functions = functions, .inputs = (inputs_)

const struct sim_family sim_mrs001 = {SENSOR("mRS001", 0xA0, rotation)};
const struct sim_family sim_mcm001 = {SENSOR("mCM001", 0xA2, current)};
const struct sim_family sim_mdi001 = {SENSOR("mDI001", 0xA5, contacts)};
const struct sim_family sim_mam001 = {SENSOR("mAM001", 0xB2, analog)};
