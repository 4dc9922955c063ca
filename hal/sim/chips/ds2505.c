/* SPDX-License-Identifier: MIT */
/*
 * DS2505 and DS2506 (data sheets, "16kbit Add-Only Memory", "64kbit Add-Only Memory"), and the
 * same with contents from the factory, DS1985U and DS1986U: EPROM in pages of 32 bytes, and status
 * bytes. They are programmed with 12 V, which nothing here gives: the flow chart of a write runs,
 * no bit changes.
 */
#include <string.h>

#include "hal/sim/families.h"

enum { PAGE = 32, STATUS_PAGE = 8, REDIRECTION = 0x100, MOST = 8192 + 0x200 };
enum { READ_MEMORY = 0xF0, WRITE_STATUS = 0x55 };

struct ds2505 {
	uint8_t bytes[MOST]; /* the status bytes after the data */
	unsigned size, status_size;
	bool in_page; /* the redirection byte of this page was sent */
};

/* Write protection, bitmap and redirection bytes, all from the factory as ones. */
static void ds2505_create(struct sim_slave *slave)
{
	struct ds2505 *s = slave->state;

	s->size = (slave->family->code & 0x7F) == 0x0F ? 8192 : 2048;
	s->status_size = REDIRECTION + s->size / PAGE;
	memset(s->bytes, 0xFF, sizeof(s->bytes));
}

/* Read Memory has its checksum at the end of the memory. */
static void ds2505_send(struct sim_slave *slave)
{
	struct ds2505 *s = slave->state;

	sim_send_memory(slave, s->bytes, s->size, s->size);
}

/* Read Status: a checksum after each eight bytes. */
static void send_status(struct sim_slave *slave)
{
	struct ds2505 *s = slave->state;

	sim_send_memory(slave, s->bytes + s->size, s->status_size, STATUS_PAGE);
}

/* Extended Read Memory: redirection byte, checksum, the rest of the page, checksum, and so on. */
static void send_page(struct sim_slave *slave)
{
	struct ds2505 *s = slave->state;
	unsigned page = slave->address / PAGE;

	if (slave->address >= s->size) {
		sim_end(slave);
	} else if (!s->in_page) {
		s->in_page = true;
		sim_send_checked(slave, s->bytes + s->size + REDIRECTION + page, 1);
	} else {
		sim_send_memory(slave, s->bytes, s->size, PAGE);
		s->in_page = slave->address % PAGE != 0;
	}
}

static void begin_pages(struct sim_slave *slave)
{
	sim_state(slave, ds2505)->in_page = false;
	send_page(slave);
}

/* Send the checksum; the pulse would come here; send the byte as it is; the next byte follows. */
static void ds2505_write(struct sim_slave *slave, uint8_t byte)
{
	struct ds2505 *s = slave->state;
	bool is_status = slave->function->code == WRITE_STATUS;

	(void)byte;
	if (slave->address >= (is_status ? s->status_size : s->size))
		sim_end(slave);
	else
		sim_send_stored(slave, s->bytes[slave->address + (is_status ? s->size : 0)]);
}

static const struct sim_function functions[] = {
	{.code = READ_MEMORY, .takes = 2, .start = ds2505_send, .next = ds2505_send},
	{.code = 0xA5, .takes = 2, .start = begin_pages, .next = send_page},
	{.code = 0xAA, .takes = 2, .start = send_status, .next = send_status},
	{.code = 0x0F, .takes = 2, .byte = ds2505_write, .next = sim_receive},
	{.code = WRITE_STATUS, .takes = 2, .byte = ds2505_write, .next = sim_receive},
	{0},
};

#define EPROM(part, family, size, fast) \
	.name = (part), .code = (family), .overdrive = (fast), .functions = functions, \
	.state_size = sizeof(struct ds2505), .create = ds2505_create, \
	SIM_MEMORY(ds2505, bytes, (size) + REDIRECTION + (size) / PAGE)

const struct sim_family sim_ds2505 = {EPROM("DS2505", 0x0B, 2048, false)};
const struct sim_family sim_ds1985u = {EPROM("DS1985U", 0x8B, 2048, false)};
const struct sim_family sim_ds2506 = {EPROM("DS2506", 0x0F, 8192, true)};
const struct sim_family sim_ds1986u = {EPROM("DS1986U", 0x8F, 8192, true)};
