/* SPDX-License-Identifier: MIT */
/*
 * DS1963L and DS1963S (data sheet 021704): memories with a battery that count how often a page is
 * written. The secrets of a DS1963S cannot be written here, and it computes no SHA-1. The four
 * bytes of a DS1963L that show a break-in, 55h, are from published drivers.
 */
#include <string.h>

#include "hal/sim/chips/scratchpad.h"
#include "hal/sim/families.h"

enum { PAGES = 16, SECRETS = 8 };
/* Counters of the pages from 8 on, of the secrets, of the random numbers. */
enum { HIDDEN = 0x200, COUNTERS = 0x260, SECRET_COUNTERS = 0x280, END = 0x2B0 };

struct ds1963 {
	struct sim_scratchpad memory; /* first */
	uint32_t count[PAGES];
	bool hide;    /* the HIDE flag of a DS1963S */
	bool copying; /* the work under way is a copy */
};

/* tPROG of a RAM: 32 us. */
static const struct sim_scratchpad_kind ds1963l = {
	.size = 512, .writable = 512, .page = 32, .copy_ns = 32000, .to_end = true};
static const struct sim_scratchpad_kind ds1963s = {
	.size = END, .writable = 512, .page = 32, .copy_ns = 32000, .to_end = true};

static bool has_secrets(const struct sim_slave *slave)
{
	return slave->family->code == 0x18;
}

static void ds1963_create(struct sim_slave *slave)
{
	memset(sim_state(slave, ds1963)->memory.memory + HIDDEN, 0xFF, COUNTERS - HIDDEN);
}

static void ds1963_power_on(struct sim_slave *slave)
{
	sim_scratchpad_power_on(slave);
	sim_state(slave, ds1963)->hide = has_secrets(slave);
}

/* The number of the first page with a counter. */
static unsigned first_counted(const struct sim_slave *slave)
{
	return has_secrets(slave) ? 8 : 12;
}

static void ds1963_worked(struct sim_slave *slave)
{
	struct ds1963 *s = slave->state;
	unsigned page = s->memory.target / 32u;

	if (!s->copying)
		return;
	sim_scratchpad_worked(slave);
	if (page >= first_counted(slave) && s->count[page] < UINT32_MAX)
		s->count[page]++;
}

static void ds1963_send_page(struct sim_slave *slave)
{
	static const uint8_t intact[4] = {0x55, 0x55, 0x55, 0x55};
	const struct ds1963 *s = slave->state;
	unsigned page = slave->address / 32u % PAGES;
	const uint8_t *secret = s->memory.memory + SECRET_COUNTERS + page % SECRETS * 4;

	sim_scratchpad_send_counted(slave,
	                            page < first_counted(slave) ? UINT32_MAX : s->count[page],
	                            has_secrets(slave) ? secret : intact);
}

/* Compute for 1 ms; then 0 and 1 in turns. The result, in the scratchpad, is hidden. */
static void authenticate(struct sim_slave *slave)
{
	struct ds1963 *s = slave->state;

	s->hide = true;
	s->copying = false;
	slave->got = 1;
	sim_work(slave, 1000000);
}

static void erase_scratchpad(struct sim_slave *slave)
{
	struct ds1963 *s = slave->state;

	s->hide = s->copying = false;
	memset(s->memory.pad, 0xFF, sizeof(s->memory.pad));
	slave->got = 1;
	sim_work(slave, 32000);
}

static void ds1963_write_scratchpad(struct sim_slave *slave, uint8_t byte)
{
	if (sim_state(slave, ds1963)->hide)
		sim_end(slave);
	else
		sim_scratchpad_write(slave, byte);
}

static void ds1963_read_scratchpad(struct sim_slave *slave)
{
	uint8_t pad[32];
	struct ds1963 *s = slave->state;

	memcpy(pad, s->memory.pad, sizeof(pad));
	if (s->hide)
		memset(s->memory.pad, 0xFF, sizeof(pad));
	sim_scratchpad_read(slave);
	memcpy(s->memory.pad, pad, sizeof(pad));
}

static void ds1963_copy(struct sim_slave *slave)
{
	struct ds1963 *s = slave->state;

	s->copying = true;
	if (s->hide)
		sim_end(slave);
	else
		sim_scratchpad_copy(slave);
}

static void ds1963_dump(struct sim_slave *slave)
{
	struct ds1963 *s = slave->state;

	for (unsigned i = 0; i < PAGES - 8 && has_secrets(slave); i++)
		sim_put(s->memory.memory + COUNTERS + 4 * i, 4, s->count[8 + i]);
	sim_scratchpad_dump(slave);
}

#define FUNCTIONS(copy) \
	{.code = 0x0F, \
	 .takes = 2, \
	 .start = sim_scratchpad_target, \
	 .byte = ds1963_write_scratchpad}, \
		{.code = 0xAA, .start = ds1963_read_scratchpad}, \
		{.code = (copy), .takes = 3, .start = ds1963_copy}, \
	{ \
		.code = 0xF0, .takes = 2, .start = ds1963_dump, .next = ds1963_dump \
	}
static const struct sim_function ds1963l_functions[] = {
	FUNCTIONS(0x5A),
	/* Read Memory and Counter */
	{.code = 0xA5, .takes = 2, .start = ds1963_send_page, .next = ds1963_send_page},
	{0},
};
static const struct sim_function ds1963s_functions[] = {
	FUNCTIONS(0x55),
	/* Read Authenticated Page, Erase Scratchpad */
	{.code = 0xA5, .takes = 2, .start = ds1963_send_page, .next = authenticate},
	{.code = 0xC3, .takes = 2, .start = erase_scratchpad},
	{0},
};

#define COUNTED(part, family, sizes, commands) \
	.name = (part), .code = (family), .overdrive = true, .resume = (family) == 0x18, \
	.state_size = sizeof(struct ds1963), .kind = &(sizes), .functions = (commands), \
	.create = ds1963_create, .power_on = ds1963_power_on, .bit = sim_scratchpad_bit, \
	.worked = ds1963_worked, SIM_MEMORY(ds1963, memory.memory, 512)

const struct sim_family sim_ds1963l = {COUNTED("DS1963L", 0x1A, ds1963l, ds1963l_functions)};
const struct sim_family sim_ds1963s = {COUNTED("DS1963S", 0x18, ds1963s, ds1963s_functions)};
