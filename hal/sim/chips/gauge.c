/* SPDX-License-Identifier: MIT */
/*
 * What battery gauges with 256 addresses do, by a kind that says where a part has its registers:
 * DS2720, DS2740, DS2751, DS2755, DS2760, DS2770, DS2780, DS2781.
 */
#include <string.h>

#include "hal/base/time.h"
#include "hal/sim/chips/gauge.h"

enum { LOCK_BLOCK = 0x6A, START_CHARGE = 0xB5 }; /* commands */

/* tEEC: 10 ms at most. */
#define COPY_NS (10 * NS_PER_MS)
/* The accumulated current: 6.25 uVh in mV * ns. */
#define ACR_UNIT (6.25e-3 * 3600 * NS_PER_S)
/* The elapsed time register of the DS2770: 1024 h in 65536 counts. */
#define TICK_NS (INT64_C(56250) * NS_PER_MS)

static unsigned block_of(const struct gauge_kind *kind, unsigned address)
{
	unsigned b = 0;

	while (b < GAUGE_BLOCKS && (address < kind->block[b].at ||
	                            address >= kind->block[b].at + (unsigned)kind->block[b].size))
		b++;
	return b;
}

static bool is_locked(const struct gauge *s, unsigned block)
{
	return s->memory[s->kind->eeprom] >> block & 1;
}

static uint8_t *stored_block(struct gauge *s, unsigned block)
{
	return s->eeprom[0] + block * (s->kind->no_gauge ? s->kind->block[0].size : GAUGE_BLOCK);
}

/* The unit of a current in mV. */
static double unit_mv(const struct gauge_kind *k)
{
	return k->fine ? 1.5625e-3 : 15.625e-3;
}

/* What a current bias adds to the current, in mV. */
static double bias_mv(const struct gauge *s)
{
	const struct gauge_kind *k = s->kind;
	double bias;

	if (!k->bias)
		return 0;
	bias = k->wide_bias ? (int16_t)sim_get_high(s->memory + k->bias, 2)
	                    : (int8_t)s->memory[k->bias];
	return k->add_bias ? bias * unit_mv(k) : -bias * unit_mv(k);
}

/* The current between two looks is that at sixteen times between them. */
static void accumulate(struct sim_slave *slave)
{
	struct gauge *s = slave->state;
	const struct gauge_kind *k = s->kind;
	double most = 32767 * ACR_UNIT, mv = bias_mv(s);
	int64_t step = (slave->now - s->last) / 16;

	if (k->accumbias)
		mv += (int8_t)s->memory[k->accumbias] * unit_mv(k);
	for (unsigned i = 0; i < 16; i++)
		mv += sim_input_at(slave, VIS, s->last + step * i + step / 2) / 16;
	s->accumulated += mv * (double)(slave->now - s->last);
	if (s->accumulated > most)
		s->accumulated = most;
	if (s->accumulated < -most)
		s->accumulated = -most;
	s->last = slave->now;
	sim_put_high(s->memory + ACCUMULATED, 2,
	             sim_within(s->accumulated / ACR_UNIT, -32768, 32767));
}

static void gauge_measure(struct sim_slave *slave)
{
	struct gauge *s = slave->state;
	const struct gauge_kind *k = s->kind;
	double mv = sim_input_now(slave, VIS) + bias_mv(s);

	accumulate(slave);
	if (k->fine)
		sim_put_high(s->memory + CURRENT, 2, sim_within(mv / unit_mv(k), -32768, 32767));
	else
		sim_put_high(s->memory + CURRENT, 2, sim_within(mv / unit_mv(k), -4096, 4095) * 8);
	if (k->average)
		sim_put_high(
			s->memory + k->average, 2,
			sim_within(mv / (k->fine ? unit_mv(k) : unit_mv(k) / 8), -32768, 32767));
	if (k->celsius)
		sim_put_high(s->memory + k->celsius, 2,
		             sim_within(sim_input_now(slave, TEMPERATURE) * 8, -1023, 1023) * 32);
	if (k->volt > 0)
		sim_put_high(s->memory + VOLTAGE, 2,
		             sim_within(sim_input_now(slave, VOLT) / k->volt, 0, 1023) * 32);
}

static bool is_on(const struct sim_slave *slave, unsigned input)
{
	return sim_input_now(slave, input) >= 0.5;
}

/*
 * DS2720, DS2760: a condition sets its flag, which stays; the flags and the enables decide on the
 * FETs. CC and DC of a DS2760 mirror their pins, which are high to switch off.
 */
static void follow_protection(struct sim_slave *slave)
{
	static const uint8_t of_ds2760[] = {OV, UV, COC, DOC}, of_ds2720[] = {OV, UV, DOC, 0};
	struct gauge *s = slave->state;
	const struct gauge_kind *k = s->kind;
	uint8_t *protection = s->memory, *special = &s->memory[k->special];
	bool cold, charges, discharges;

	for (unsigned i = 0; i < 4; i++)
		if (is_on(slave, k->conditions + i))
			*protection |= k->no_gauge ? of_ds2720[i] : of_ds2760[i];
	if (k->no_gauge && is_on(slave, k->conditions + 3))
		*special |= OT;
	if (!is_on(slave, k->conditions + 4))
		*special &= (uint8_t)~PSF; /* PS */
	cold = !k->no_gauge || !(*special & OT);
	charges = cold && (*protection & CE) && !(*protection & (OV | COC));
	discharges = cold && (*protection & DE) && !(*protection & (UV | DOC));
	*protection &= (uint8_t) ~(CC | DC);
	*protection |= charges == k->no_gauge ? CC : 0;
	*protection |= discharges == k->no_gauge ? DC : 0;
}

/* DS2770: the charge status of figure 12, and the timer. */
static void follow_charger(struct sim_slave *slave)
{
	struct gauge *s = slave->state;
	bool source = is_on(slave, CHARGER);
	uint8_t was = s->memory[STATUS] & CSTAT, status = source ? 0x80 : 0x00;

	if (was == 0 && source && (s->memory[STATUS] & CINI))
		s->charging = true;
	s->charging = s->charging && source;
	if (s->charging && is_on(slave, FULL)) {
		s->charging = false;
		s->full = true;
	}
	if (s->charging)
		status = 0x40;
	if (s->full)
		status = CSTAT;
	s->memory[STATUS] = (uint8_t)((s->memory[STATUS] & ~CSTAT) | status);
	sim_put_high(s->memory + 0x02, 2, (slave->now - s->started) / TICK_NS);
}

/* DS2780, DS2781: flags of the capacity, and the voltage below which they sleep. */
static void gauge_watch(struct sim_slave *slave)
{
	struct gauge *s = slave->state;
	bool high = s->kind->add_bias && (s->memory[0x60] & UVTH);
	uint8_t *status = &s->memory[STATUS];

	*status &= 0x0F;
	for (unsigned i = 0; i < 4; i++)
		*status |= (uint8_t)(is_on(slave, FLAGS + i) << (7 - i));
	if (sim_input_now(slave, VOLT) < (high ? 4.9 : 2.45))
		*status |= UVF;
}

void sim_gauge_advance(struct sim_slave *slave)
{
	struct gauge *s = slave->state;
	const struct gauge_kind *k = s->kind;

	if (!k->no_gauge)
		gauge_measure(slave);
	if (k->protects)
		follow_protection(slave);
	if (slave->family->code == 0x2E)
		follow_charger(slave);
	if (slave->family->code == 0x32 || slave->family->code == 0x3D)
		gauge_watch(slave);
	if (!k->pio)
		return;
	s->memory[k->special] &= (uint8_t)~k->pio;
	if (!s->low && is_on(slave, PIN))
		s->memory[k->special] |= k->pio;
}

static void take_defaults(struct gauge *s, uint8_t from)
{
	const struct gauge_kind *k = s->kind;

	if (k->defaults)
		s->memory[STATUS] = (uint8_t)((s->memory[STATUS] & ~k->defaults) |
		                              (from & k->defaults));
}

static void recall_block(struct sim_slave *slave, unsigned block)
{
	struct gauge *s = slave->state;
	const struct gauge_kind *k = s->kind;

	memcpy(s->memory + k->block[block].at, stored_block(s, block), k->block[block].size);
	if (slave->family->code != 0x2E && k->from && block_of(k, k->from) == block)
		take_defaults(s, s->memory[k->from]);
	if (slave->family->code == 0x30 && block == 1)
		s->memory[0] = (uint8_t)((s->memory[0] & ~(CE | DE)) |
		                         (s->memory[0x30] & (CE | DE)));
}

void sim_gauge_power_on(struct sim_slave *slave)
{
	struct gauge *s = slave->state;
	const struct gauge_kind *k = slave->family->kind;
	uint8_t locks = s->memory[k->eeprom] & 7;

	s->kind = k;
	memset(s->memory, 0, sizeof(s->memory));
	if (k->eeprom)
		s->memory[k->eeprom] = locks;
	for (unsigned b = 0; b < GAUGE_BLOCKS && k->block[b].size; b++)
		recall_block(slave, b);
	if (slave->family->code == 0x2E)
		take_defaults(s, s->eeprom[1][1]);
	s->memory[k->por_at] |= k->por;
	if (k->no_gauge)
		s->memory[0] = CE | DE;
	s->low = s->charging = s->full = false;
	if (!k->keeps)
		s->accumulated = 0;
	s->last = s->started = slave->now;
	sim_gauge_advance(slave);
}

void sim_gauge_worked(struct sim_slave *slave)
{
	struct gauge *s = slave->state;

	memcpy(stored_block(s, s->copied), s->memory + s->kind->block[s->copied].at,
	       s->kind->block[s->copied].size);
	s->memory[s->kind->eeprom] &= (uint8_t)~EEC;
}

/* Any command other than the lock itself cancels the permission to lock. */
void sim_gauge_begun(struct sim_slave *slave)
{
	struct gauge *s = slave->state;

	if (s->kind->eeprom && slave->function->code != LOCK_BLOCK)
		s->memory[s->kind->eeprom] &= (uint8_t)~LOCK;
}

static void read_data(struct sim_slave *slave)
{
	sim_send_memory(slave, sim_state(slave, gauge)->latched, 256, 0);
}

/* The bytes of a register stay as they are while one command reads them. */
static void begin_read(struct sim_slave *slave)
{
	struct gauge *s = slave->state;

	memcpy(s->latched, s->memory, sizeof(s->latched));
	read_data(slave);
}

/* What is written has a consequence beyond its byte. */
static void act_on_write(struct sim_slave *slave, unsigned at, uint8_t byte)
{
	struct gauge *s = slave->state;

	if (at == s->kind->special && s->kind->pio)
		s->low = !(byte & s->kind->pio);
	if (at == ACCUMULATED || at == ACCUMULATED + 1)
		s->accumulated = (int16_t)sim_get_high(s->memory + ACCUMULATED, 2) * ACR_UNIT;
	if (slave->family->code != 0x2E)
		return;
	if (at == STATUS)
		s->full = false;
	if (at == 0x02 || at == 0x03)
		s->started = slave->now - (int64_t)sim_get_high(s->memory + 2, 2) * TICK_NS;
}

/* What is read-only, reserved or locked stays unchanged. */
static void write_data(struct sim_slave *slave, uint8_t byte)
{
	struct gauge *s = slave->state;
	const struct gauge_kind *k = s->kind;
	unsigned at = slave->address, block = block_of(k, at);

	if (at >= sizeof(s->memory))
		return;
	slave->address++;
	if (block < GAUGE_BLOCKS && !slave->busy && !is_locked(s, block))
		s->memory[at] = byte;
	for (const struct gauge_rule *r = k->rules; r < k->rules + GAUGE_RULES; r++) {
		uint8_t *to = &s->memory[at];

		if (!r->used || at < r->first || at > r->last)
			continue;
		*to = (uint8_t)((byte & r->write) | (*to & ~r->write));
		*to &= (uint8_t)(byte | ~r->clear);
		*to |= byte & r->set;
		act_on_write(slave, at, byte);
	}
	sim_gauge_advance(slave);
}

static void gauge_copy(struct sim_slave *slave)
{
	struct gauge *s = slave->state;
	unsigned block = block_of(s->kind, slave->address);

	if (block < GAUGE_BLOCKS && !is_locked(s, block)) {
		s->copied = (uint8_t)block;
		s->memory[s->kind->eeprom] |= EEC;
		sim_work(slave, COPY_NS);
	}
	sim_end(slave);
}

static void gauge_recall(struct sim_slave *slave)
{
	unsigned block = block_of(sim_state(slave, gauge)->kind, slave->address);

	if (block < GAUGE_BLOCKS)
		recall_block(slave, block);
	sim_gauge_advance(slave);
	sim_end(slave);
}

static void lock_block(struct sim_slave *slave)
{
	struct gauge *s = slave->state;
	uint8_t *reg = &s->memory[s->kind->eeprom];
	unsigned block = block_of(s->kind, slave->address);

	if (block < GAUGE_BLOCKS && (*reg & LOCK))
		*reg |= (uint8_t)(1 << block);
	*reg &= (uint8_t)~LOCK;
	sim_end(slave);
}

static void set_charge(struct sim_slave *slave)
{
	sim_state(slave, gauge)->charging = slave->function->code == START_CHARGE;
	sim_gauge_advance(slave);
	sim_end(slave);
}

/* The status comes from the EEPROM itself, not from its shadow. */
static void refresh_status(struct sim_slave *slave)
{
	struct gauge *s = slave->state;

	take_defaults(s, s->eeprom[1][1]);
	sim_end(slave);
}

#define DATA_FUNCTIONS \
	{.code = 0x69, .takes = 1, .start = begin_read, .next = read_data}, /* Read Data */ \
	{ \
		.code = 0x6C, .takes = 1, .byte = write_data \
	}
#define EEPROM_FUNCTIONS \
	DATA_FUNCTIONS, {.code = 0x48, .takes = 1, .start = gauge_copy}, \
		{.code = 0xB8, .takes = 1, .start = gauge_recall}, \
	{ \
		.code = LOCK_BLOCK, .takes = 1, .start = lock_block \
	}

const struct sim_function sim_gauge_functions[] = {EEPROM_FUNCTIONS, {0}};
const struct sim_function sim_ds2740_functions[] = {DATA_FUNCTIONS, {0}};
const struct sim_function sim_ds2770_functions[] = {
	EEPROM_FUNCTIONS,
	{.code = START_CHARGE, .start = set_charge},
	{.code = 0xBE, .start = set_charge}, /* Stop Charge */
	{.code = 0x63, .start = refresh_status},
	{0},
};
