/* SPDX-License-Identifier: MIT */
/*
 * EPROM in pages of 32 bytes, and status bytes: DS2502 (data sheet 19-5076), DS2505 and DS2506
 * (data sheets, "16kbit Add-Only Memory", "64kbit Add-Only Memory"), and the same with contents
 * from the factory, DS1982U, DS1985U and DS1986U. They are programmed with 12 V, which nothing here
 * gives: the flow chart of a write runs, no bit changes.
 */
#include <string.h>

#include "hal/sim/families.h"

enum { PAGE = 32, STATUS_PAGE = 8, REDIRECTION = 0x100, MOST = 8192 + 0x200 };
enum { READ_MEMORY = 0xF0, READ_PAGES = 0xC3, READ_STATUS = 0xAA, WRITE_STATUS = 0x55 };

struct eprom_kind {
	uint16_t size, status;
};
static const struct eprom_kind ds2502 = {128, 8};
static const struct eprom_kind ds2505 = {2048, REDIRECTION + 2048 / PAGE};
static const struct eprom_kind ds2506 = {8192, REDIRECTION + 8192 / PAGE};

struct eprom {
	uint8_t bytes[MOST]; /* the status bytes after the data */
	bool in_page;        /* the redirection byte of this page was sent */
};

static const struct eprom_kind *eprom_kind_of(const struct sim_slave *slave)
{
	return slave->family->kind;
}

/* Write protection, bitmap and redirection bytes, all from the factory as ones. */
static void eprom_create(struct sim_slave *slave)
{
	struct eprom *s = slave->state;

	memset(s->bytes, 0xFF, sizeof(s->bytes));
	if (eprom_kind_of(slave) == &ds2502)
		s->bytes[ds2502.size + 7] = 0;
}

/*
 * Read Memory has its checksum at the end of the memory, Read Data/Generate CRC of a DS2502 after
 * each page, Read Status after each eight bytes.
 */
static void eprom_send(struct sim_slave *slave)
{
	const uint8_t *bytes = sim_state(slave, eprom)->bytes;
	const struct eprom_kind *kind = eprom_kind_of(slave);

	if (slave->function->code == READ_STATUS)
		sim_send_memory(slave, bytes + kind->size, kind->status, STATUS_PAGE);
	else
		sim_send_memory(slave, bytes, kind->size,
		                slave->function->code == READ_MEMORY ? kind->size : PAGE);
}

/* Extended Read Memory: redirection byte, checksum, the rest of the page, checksum, and so on. */
static void eprom_send_page(struct sim_slave *slave)
{
	struct eprom *s = slave->state;
	unsigned page = slave->address / PAGE, size = eprom_kind_of(slave)->size;

	if (slave->address >= size) {
		sim_end(slave);
	} else if (!s->in_page) {
		s->in_page = true;
		sim_send_checked(slave, s->bytes + size + REDIRECTION + page, 1);
	} else {
		sim_send_memory(slave, s->bytes, size, PAGE);
		s->in_page = slave->address % PAGE != 0;
	}
}

static void begin_pages(struct sim_slave *slave)
{
	sim_state(slave, eprom)->in_page = false;
	eprom_send_page(slave);
}

/* Send the checksum; the pulse would come here; send the byte as it is; the next byte follows. */
static void eprom_write(struct sim_slave *slave, uint8_t byte)
{
	const struct eprom_kind *kind = eprom_kind_of(slave);
	bool is_status = slave->function->code == WRITE_STATUS;
	const uint8_t *bytes = sim_state(slave, eprom)->bytes + (is_status ? kind->size : 0);

	(void)byte;
	if (slave->address >= (is_status ? kind->status : kind->size))
		sim_end(slave);
	else
		sim_send_stored(slave, bytes[slave->address]);
}

#define WRITES \
	{.code = 0x0F, .takes = 2, .byte = eprom_write, .next = sim_receive}, \
	{ \
		.code = WRITE_STATUS, .takes = 2, .byte = eprom_write, .next = sim_receive \
	}
/* A DS2502 sends the checksum of command and address first. */
static const struct sim_function ds2502_functions[] = {
	{.code = READ_MEMORY, .takes = 2, .start = sim_send_checksum, .next = eprom_send},
	{.code = READ_STATUS, .takes = 2, .start = sim_send_checksum, .next = eprom_send},
	{.code = READ_PAGES, .takes = 2, .start = sim_send_checksum, .next = eprom_send},
	WRITES,
	{0},
};
static const struct sim_function ds2505_functions[] = {
	{.code = READ_MEMORY, .takes = 2, .start = eprom_send, .next = eprom_send},
	{.code = 0xA5, .takes = 2, .start = begin_pages, .next = eprom_send_page},
	{.code = READ_STATUS, .takes = 2, .start = eprom_send, .next = eprom_send},
	WRITES,
	{0},
};

#define EPROM(part, family, sizes, bytes_, commands) \
	.name = (part), .code = (family), .kind = &(sizes), .functions = (commands), \
	.state_size = sizeof(struct eprom), .create = eprom_create, \
	SIM_MEMORY(eprom, bytes, bytes_)
#define SMALL(part, family) EPROM(part, family, ds2502, 128 + 8, ds2502_functions), .crc8 = true
#define LARGE(part, family, sizes, size) \
	EPROM(part, family, sizes, (size) + REDIRECTION + (size) / PAGE, ds2505_functions)

const struct sim_family sim_ds2502 = {SMALL("DS2502", 0x09)};
const struct sim_family sim_ds1982u = {SMALL("DS1982U", 0x89)};
const struct sim_family sim_ds2505 = {LARGE("DS2505", 0x0B, ds2505, 2048)};
const struct sim_family sim_ds1985u = {LARGE("DS1985U", 0x8B, ds2505, 2048)};
const struct sim_family sim_ds2506 = {LARGE("DS2506", 0x0F, ds2506, 8192), .overdrive = true};
const struct sim_family sim_ds1986u = {LARGE("DS1986U", 0x8F, ds2506, 8192), .overdrive = true};
