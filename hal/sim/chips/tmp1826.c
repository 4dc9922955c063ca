/* SPDX-License-Identifier: MIT */
/*
 * TMP1826 and TMP1827 (data sheets SBOSA45, SBOSA15): a thermometer of 16 bits with 2 kbit of
 * EEPROM. They answer with the family code of the DS2438. The command codes are those of the data
 * sheets' tables and of published drivers, which cite the times of the EEPROM, too. The maker's
 * pages say that a CRC8 follows each block of the EEPROM, drivers read none: the chip is either.
 * Not simulated: pins, flexible addresses, arbitration, the modes in which the chip
 * converts by itself, the TMP1827's SHA-256.
 */
#include <math.h>
#include <string.h>

#include "hal/base/time.h"
#include "hal/sim/chips/tmp1826.h"
#include "hal/sim/crc.h"
#include "hal/sim/families.h"

/* Configuration 1, configuration 2, status. */
enum { TEMP_FMT = 0x80, ALWAYS = 0x40, LONG = 0x20, ALERT_MODE = 0x10, AVERAGE = 0x08 };
enum { OD_EN = 0x80, LOCK_EN = 0x01 };
enum { ALERT_HIGH = 0x80, ALERT_LOW = 0x40, RESERVED = 0x30, DATA_VALID = 0x08, FED_BY_BUS = 0x04 };
enum { KEY = 0xA5, LOCK_PAGE = 0x80, LOCK_CODE = 0x55 };
enum work { CONVERSION, COPY_SETTINGS, COPY_MEMORY, FETCH };

#define DELAY_NS 300000  /* tDELAY */
#define SHORT_NS 3370000 /* tACT with CONV_TIME_SEL 0 and 1, at most */
#define LONG_NS 6120000
#define PROGRAM_NS (21 * NS_PER_MS)
#define READ_IDLE_NS 560000 /* tREADIDLE */

static void tmp1826_create(struct sim_slave *slave)
{
	static const uint8_t factory[SIM_TMP1826_SETTINGS] = {
		ALWAYS | LONG | ALERT_MODE, OD_EN, 0, 0x00, 0x00, 0xF0, 0x07};
	struct sim_tmp1826 *s = slave->state;

	memcpy(s->stored, factory, sizeof(factory));
	memset(s->memory, 0xFF, sizeof(s->memory));
}

static void tmp1826_power_on(struct sim_slave *slave)
{
	struct sim_tmp1826 *s = slave->state;

	memcpy(s->settings, s->stored, sizeof(s->settings));
	s->temperature = 0;
	s->status = 0;
	s->target = SIM_TMP1826_NOWHERE;
}

/* A register of two bytes in 1/128 degrees, whatever the format. */
static int in_128ths(const struct sim_tmp1826 *s, const uint8_t *at)
{
	int raw = (int16_t)(at[0] | at[1] << 8);

	return s->settings[0] & TEMP_FMT ? raw : raw * 8;
}

static void tmp1826_measure(struct sim_slave *slave)
{
	struct sim_tmp1826 *s = slave->state;
	int raw = sim_within(sim_input_now(slave, 0) * 128, -55 * 128, 150 * 128) +
	          in_128ths(s, s->settings + 7);

	s->status &= (uint8_t) ~(s->settings[0] & ALERT_MODE ? ALERT_HIGH | ALERT_LOW : 0);
	if (raw >= in_128ths(s, s->settings + 5))
		s->status |= ALERT_HIGH;
	if (raw <= in_128ths(s, s->settings + 3))
		s->status |= ALERT_LOW;
	s->status |= DATA_VALID;
	s->temperature = (int16_t)(s->settings[0] & TEMP_FMT ? raw : (int)floor(raw / 8.0));
	slave->conversions++;
}

static bool is_locked(const struct sim_tmp1826 *s)
{
	return s->locked_pages >> (s->target / SIM_TMP1826_PAGE) & 1;
}

/* The block that was fetched; behind the last one are ones. */
static void send_fetched(struct sim_slave *slave)
{
	struct sim_tmp1826 *s = slave->state;
	uint8_t out[SIM_TMP1826_BLOCK + 1];

	if (slave->layer != SIM_FUNCTION)
		return;
	if (slave->address >= SIM_TMP1826_MEMORY) {
		sim_end(slave);
		return;
	}
	memcpy(out, s->memory + slave->address, SIM_TMP1826_BLOCK);
	out[SIM_TMP1826_BLOCK] = sim_crc8(0, out, SIM_TMP1826_BLOCK);
	slave->address += SIM_TMP1826_BLOCK;
	sim_send(slave, out, SIM_TMP1826_BLOCK + s->checked_blocks);
}

static void tmp1826_worked(struct sim_slave *slave)
{
	struct sim_tmp1826 *s = slave->state;

	switch (s->work) {
	case CONVERSION:
		tmp1826_measure(slave);
		break;
	case COPY_SETTINGS:
		memcpy(s->stored, s->settings, sizeof(s->stored));
		break;
	case COPY_MEMORY:
		if (s->target >> 8 == LOCK_PAGE && s->second[0] == LOCK_CODE)
			s->locked_pages |= (uint8_t)(1u << (s->target & 7));
		else if (s->target < SIM_TMP1826_MEMORY && !is_locked(s))
			memcpy(s->memory + s->target, s->second, SIM_TMP1826_BLOCK);
		break;
	case FETCH:
		send_fetched(slave);
		break;
	}
}

static void tmp1826_work(struct sim_slave *slave, enum work what, int64_t takes)
{
	sim_state(slave, sim_tmp1826)->work = what;
	sim_work(slave, takes);
}

static void tmp1826_convert(struct sim_slave *slave)
{
	const uint8_t config = sim_state(slave, sim_tmp1826)->settings[0];
	int64_t takes = config & LONG ? LONG_NS : SHORT_NS;

	tmp1826_work(slave, CONVERSION, DELAY_NS + (config & AVERAGE ? 8 * takes : takes));
}

static void copy_settings(struct sim_slave *slave)
{
	tmp1826_work(slave, COPY_SETTINGS, PROGRAM_NS);
}

/* Two times eight bytes, each with its checksum. */
static void tmp1826_read_scratchpad(struct sim_slave *slave)
{
	struct sim_tmp1826 *s = slave->state;
	uint8_t *out = s->sent;

	memset(out, 0xFF, sizeof(s->sent));
	sim_put(out, 2, s->temperature);
	out[2] = (uint8_t)(s->status | RESERVED | (slave->parasite ? FED_BY_BUS : 0) |
	                   (s->settings[1] & LOCK_EN));
	memcpy(out + 4, s->settings, 3);
	out[8] = sim_crc8(0, out, 8);
	memcpy(out + 9, s->settings + 3, 6);
	out[17] = sim_crc8(0, out + 9, 8);
	sim_send_byte(slave, out[0]);
}

/* The flags are cleared when the status register was read. */
static void read_more(struct sim_slave *slave)
{
	struct sim_tmp1826 *s = slave->state;

	if (slave->address == 2)
		s->status = 0;
	if (++slave->address < sizeof(s->sent))
		sim_send_byte(slave, s->sent[slave->address]);
}

static void tmp1826_write_settings(struct sim_slave *slave, uint8_t byte)
{
	struct sim_tmp1826 *s = slave->state;
	unsigned at = slave->address++;

	s->sent[at] = byte;
	if (at == 1)
		byte |= OD_EN;
	if (!(s->settings[1] & LOCK_EN))
		s->settings[at] = byte;
	if (at == SIM_TMP1826_SETTINGS - 1)
		sim_send_byte(slave, sim_crc8(0, s->sent, SIM_TMP1826_SETTINGS));
}

/* --- The memory: blocks of 8 bytes by a second scratchpad; its addresses begin with the MSB. -- */

static uint16_t taken_address(const struct sim_slave *slave)
{
	return (uint16_t)sim_get_high(slave->taken, 2);
}

static void begin_block(struct sim_slave *slave)
{
	struct sim_tmp1826 *s = slave->state;

	s->target = taken_address(slave);
	if (s->target < SIM_TMP1826_MEMORY)
		s->target &= (uint16_t) ~(SIM_TMP1826_BLOCK - 1);
	slave->address = 0;
}

/* Of a page lock there is one byte. */
static unsigned block_size(const struct sim_tmp1826 *s)
{
	return s->target >> 8 == LOCK_PAGE ? 1 : SIM_TMP1826_BLOCK;
}

/* The checksum is that of the address and the bytes. */
static void send_block_crc(struct sim_slave *slave)
{
	const struct sim_tmp1826 *s = slave->state;
	uint8_t crc = sim_crc8(0, slave->taken, 2);

	sim_send_byte(slave, sim_crc8(crc, s->second, block_size(s)));
}

static void tmp1826_write_block(struct sim_slave *slave, uint8_t byte)
{
	struct sim_tmp1826 *s = slave->state;

	s->second[slave->address++] = byte;
	if (slave->address == block_size(s))
		send_block_crc(slave);
}

static void read_block(struct sim_slave *slave)
{
	struct sim_tmp1826 *s = slave->state;

	if (taken_address(slave) != s->target) {
		sim_end(slave);
		return;
	}
	slave->address = 0;
	sim_send(slave, s->second, block_size(s));
}

static void end_block(struct sim_slave *slave)
{
	if (slave->address++ == 0)
		send_block_crc(slave);
}

static void copy_block(struct sim_slave *slave)
{
	if (slave->taken[0] == KEY && sim_state(slave, sim_tmp1826)->target != SIM_TMP1826_NOWHERE)
		tmp1826_work(slave, COPY_MEMORY, PROGRAM_NS);
	else
		sim_end(slave);
}

/* Before each block the line has to stay high while the chip fetches it. */
static void fetch_block(struct sim_slave *slave)
{
	tmp1826_work(slave, FETCH, READ_IDLE_NS);
}

static void tmp1826_read_memory(struct sim_slave *slave)
{
	slave->address = taken_address(slave) & (uint16_t) ~(SIM_TMP1826_BLOCK - 1);
	fetch_block(slave);
}

/* No data sheet promises a busy slot: the host has to leave the bus idle meanwhile. */
static const struct sim_function functions[] = {
	{.code = 0x44, .start = tmp1826_convert},
	/* Write, Read, Copy Scratchpad-1: temperature and settings */
	{.code = 0x4E, .byte = tmp1826_write_settings},
	{.code = 0xBE, .start = tmp1826_read_scratchpad, .next = read_more},
	{.code = 0x48, .start = copy_settings},
	/* Write, Read, Copy Scratchpad-2, Read EEPROM */
	{.code = 0x0F, .takes = 2, .start = begin_block, .byte = tmp1826_write_block},
	{.code = 0xAA, .takes = 2, .start = read_block, .next = end_block},
	{.code = 0x55, .takes = 1, .start = copy_block},
	{.code = 0xF0, .takes = 2, .start = tmp1826_read_memory, .next = fetch_block},
	{0},
};

static bool tmp1826_alarm(struct sim_slave *slave)
{
	return (sim_state(slave, sim_tmp1826)->status & (ALERT_HIGH | ALERT_LOW)) != 0;
}

static void store_flag(struct sim_slave *slave, uint8_t flag, bool on)
{
	uint8_t *settings = sim_state(slave, sim_tmp1826)->stored;

	settings[0] = (uint8_t)(on ? settings[0] | flag : settings[0] & ~flag);
}

static void set_precise(struct sim_slave *slave, int64_t on)
{
	store_flag(slave, TEMP_FMT, on);
}

static void set_averaging(struct sim_slave *slave, int64_t on)
{
	store_flag(slave, AVERAGE, on);
}

/* Which settings the EEPROM holds: "precise" is the format, "averaging" that of 8 conversions. */
static const struct sim_option options[] = {
	{"precise", 0, 1, .set = set_precise}, {"averaging", 0, 1, .set = set_averaging}, {0}};

static const struct sim_input inputs[] = {
	{.name = "temperature", .start = 20, .least = -55, .most = 150},
	{0},
};

#define PART(part) \
	.name = (part), .code = 0x26, .overdrive = true, .crc8 = true, \
	.state_size = sizeof(struct sim_tmp1826), .inputs = inputs, .functions = functions, \
	.create = tmp1826_create, .power_on = tmp1826_power_on, .alarm = tmp1826_alarm, \
	.bit = sim_ones, .worked = tmp1826_worked, .options = options, \
	SIM_MEMORY(sim_tmp1826, memory, SIM_TMP1826_MEMORY)

const struct sim_family sim_tmp1826 = {PART("TMP1826")};
const struct sim_family sim_tmp1827 = {PART("TMP1827")};
