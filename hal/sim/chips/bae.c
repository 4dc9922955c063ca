/* SPDX-License-Identifier: MIT */
/*
 * BAE 0910 and 0911 by Pascal Baerten: microcontrollers with memory-mapped functions. No data sheet
 * can be had; the facts are those of OWFS's driver. Commands that write answer with a CRC16 and act
 * when BCh confirms it. Registers have their high byte first.
 */
#include <stddef.h>
#include <string.h>

#include "hal/base/time.h"
#include "hal/sim/families.h"

enum { VERSION = 0x11, TYPE, EXTENDED, READ_BLOCK, WRITE_BLOCK, ERASE_PAGE, WRITE_RUN };
enum { SEQUENCE_WRITE = 0x18, SEQUENCE_READ, QUERY, CONFIRM = 0xBC };
enum { MOST = 255 + 4, BLOCK = 32, PAGE = 512 };
enum { BUSY = 0xFF, DONE = 0, FAILED = 1 };

/* The 0910: registers, two pages. The 0911: eight pages, registers from 7800h on. */
enum { REGISTERS_910 = 128, EEPROM_910 = 0xE000, EEPROM_911 = 0x0000, REGISTERS_911 = 0x7800 };
enum { PAGES_910 = 2, PAGES_911 = 8, REGISTERS = 0x800 };
enum { CLOCK_910 = 40, CLOCK_911 = 0x7F7A - REGISTERS_911 };
enum { POWER_ON_FLAGS = 0x7A29 - REGISTERS_911 };

/* Of the 0911: what the functions that run do, and what the sequences carry. */
enum { BEGIN_I2C, END_I2C, BEGIN_SD_WRITE, END_SD_WRITE, BEGIN_SD_READ, END_SD_READ };
enum { TO_DISPLAY = 0, TO_SD = 2, TO_SERIAL = 4, FROM_SD = 0 };
enum { SECTORS = 4, CAT9554 = 0x40, CAT9554_REGISTERS = 4 };

struct bae {
	uint8_t registers[REGISTERS], eeprom[PAGES_911 * PAGE];
	uint8_t sd[SECTORS * PAGE], expander[CAT9554_REGISTERS], text[256];
	uint8_t taken[MOST]; /* the bytes of a command that writes */
	uint16_t got;
	uint8_t texts; /* bytes in text */
	bool sent;     /* its checksum */
	uint32_t sd_at;
	uint8_t result, answer[BLOCK], answers;
	int64_t done;    /* the function that runs ends then */
	int64_t started; /* the clock was 0 */
};

static bool is_911(const struct sim_slave *slave)
{
	return slave->family == &sim_bae0911;
}

/* NULL: there is nothing at this address. */
static uint8_t *cell_at(struct sim_slave *slave, unsigned at)
{
	struct bae *s = slave->state;
	unsigned eeprom = is_911(slave) ? EEPROM_911 : EEPROM_910;
	unsigned pages = is_911(slave) ? PAGES_911 : PAGES_910;
	unsigned registers = is_911(slave) ? REGISTERS_911 : 0;

	if (at >= eeprom && at < eeprom + pages * PAGE)
		return s->eeprom + (at - eeprom);
	if (at >= registers && at < registers + (is_911(slave) ? REGISTERS : REGISTERS_910))
		return s->registers + (at - registers);
	return NULL;
}

static bool is_eeprom(struct sim_slave *slave, const uint8_t *to)
{
	const struct bae *s = slave->state;

	return to >= s->eeprom && to < s->eeprom + sizeof(s->eeprom);
}

static void bae_create(struct sim_slave *slave)
{
	struct bae *s = slave->state;

	memset(s->eeprom, 0xFF, sizeof(s->eeprom));
}

static void bae_power_on(struct sim_slave *slave)
{
	struct bae *s = slave->state;

	memset(s->registers, 0, sizeof(s->registers));
	memset(s->expander, 0, sizeof(s->expander));
	s->expander[3] = 0xFF; /* all are inputs */
	s->result = DONE;
	s->answers = 0;
	s->started = slave->now;
	if (is_911(slave))
		s->registers[POWER_ON_FLAGS] = 0x80;
}

static unsigned clock_at(const struct sim_slave *slave)
{
	return is_911(slave) ? CLOCK_911 : CLOCK_910;
}

static void bae_advance(struct sim_slave *slave)
{
	struct bae *s = slave->state;
	unsigned adc = (unsigned)sim_round(sim_input_now(slave, 0) * 1023 / 5);

	sim_put_high(s->registers + clock_at(slave), 4, (slave->now - s->started) / NS_PER_S);
	if (is_911(slave)) {
		sim_put_high(s->registers + 0x700, 2, adc); /* ADC0 */
	} else {
		s->registers[50] = (uint8_t)(adc >> 2); /* 8 bits, and 10 */
		sim_put_high(s->registers + 62, 2, adc);
	}
}

static void bae_version(struct sim_slave *slave)
{
	sim_send_checked(slave, (const uint8_t[]){0x02, 0x0C}, 2);
}

static void bae_type(struct sim_slave *slave)
{
	sim_send_checked(slave, (const uint8_t[]){is_911(slave) ? 3 : 2, 0x24}, 2);
}

static void read_block(struct sim_slave *slave)
{
	unsigned at = slave->address, n = slave->taken[2];
	uint8_t out[BLOCK];

	if (!n || n > BLOCK) {
		sim_end(slave);
		return;
	}
	for (unsigned i = 0; i < n; i++) {
		const uint8_t *from = cell_at(slave, at + i);

		out[i] = from ? *from : 0xFF;
	}
	sim_send_checked(slave, out, n);
}

/* EEPROM can only be cleared bit by bit; erasing sets all. */
static void bae_write_block(struct sim_slave *slave)
{
	struct bae *s = slave->state;
	unsigned at = (unsigned)sim_get(s->taken, 2);

	for (unsigned i = 0; i < s->taken[2]; i++) {
		uint8_t *to = cell_at(slave, at + i);

		if (to)
			*to = is_eeprom(slave, to) ? *to & s->taken[3 + i] : s->taken[3 + i];
	}
	s->started = slave->now -
	             (int64_t)sim_get_high(s->registers + clock_at(slave), 4) * NS_PER_S;
}

static void erase_page(struct sim_slave *slave)
{
	struct bae *s = slave->state;
	uint8_t *page = cell_at(slave, (unsigned)sim_get(s->taken, 2));

	if (page && is_eeprom(slave, page))
		memset(s->eeprom + (page - s->eeprom) / PAGE * PAGE, 0xFF, PAGE);
}

static void i2c(struct bae *s, const uint8_t *bytes, unsigned n)
{
	unsigned at = n > 1 ? bytes[1] % CAT9554_REGISTERS : 0;

	if (n < 2 || bytes[0] != CAT9554)
		s->result = FAILED;
	else if (n > 2)
		s->expander[at] = bytes[2];
	else
		s->answer[0] = at == 0 ? s->expander[1] : s->expander[at];
}

/* taken: bytes of the argument, function, bytes of the answer, argument. */
static void run_function(struct bae *s)
{
	s->answers = s->taken[2] > BLOCK ? BLOCK : s->taken[2];
	switch (s->taken[1]) {
	case BEGIN_I2C:
		i2c(s, s->taken + 3, s->taken[0]);
		break;
	case BEGIN_SD_WRITE:
	case BEGIN_SD_READ:
		s->sd_at = (uint32_t)sim_get_high(s->taken + 3, 4);
		if (s->sd_at >= sizeof(s->sd))
			s->result = FAILED;
		break;
	case END_I2C:
	case END_SD_WRITE:
	case END_SD_READ:
		break;
	default:
		s->result = FAILED;
	}
}

static void run_sequence(struct bae *s, bool write)
{
	unsigned n = s->taken[0] > BLOCK ? BLOCK : s->taken[0];
	const uint8_t *bytes = s->taken + 2;

	if (s->taken[1] == (write ? TO_SD : FROM_SD) && s->sd_at + n <= sizeof(s->sd)) {
		if (write)
			memcpy(s->sd + s->sd_at, bytes, n);
		else
			memcpy(s->answer, s->sd + s->sd_at, n);
		s->answers = (uint8_t)(write ? 0 : n);
		s->sd_at += n;
	} else if (write && (s->taken[1] == TO_DISPLAY || s->taken[1] == TO_SERIAL)) {
		for (unsigned i = 0; i < n; i++)
			s->text[s->texts++] = bytes[i];
	} else {
		s->result = FAILED;
	}
}

static void bae_act(struct sim_slave *slave)
{
	struct bae *s = slave->state;

	switch (slave->function->code) {
	case WRITE_BLOCK:
		bae_write_block(slave);
		return;
	case ERASE_PAGE:
		erase_page(slave);
		return;
	case EXTENDED:
		return; /* the firmware that is under test has none */
	}
	s->result = DONE;
	s->answers = 0;
	s->done = slave->now + NS_PER_MS;
	if (slave->function->code == WRITE_RUN)
		run_function(s);
	else
		run_sequence(s, slave->function->code == SEQUENCE_WRITE);
}

/* How many bytes has the command that is coming in? */
static unsigned command_size(const struct sim_slave *slave, const struct bae *s)
{
	switch (slave->function->code) {
	case WRITE_BLOCK:
		return 3u + (s->got > 2 ? s->taken[2] : 1);
	case WRITE_RUN:
		return 3u + (s->got ? s->taken[0] : 1);
	case SEQUENCE_WRITE:
	case EXTENDED:
		return 2u + (s->got ? s->taken[0] : 1);
	}
	return 2; /* page to erase; bytes and function of a sequence */
}

static void bae_begin(struct sim_slave *slave)
{
	struct bae *s = slave->state;

	s->got = 0;
	s->sent = false;
}

static void bae_take(struct sim_slave *slave, uint8_t byte)
{
	struct bae *s = slave->state;

	if (s->sent) {
		if (byte == CONFIRM)
			bae_act(slave);
		sim_end(slave);
		return;
	}
	s->taken[s->got++] = byte;
	if (s->got < command_size(slave, s) && s->got < MOST)
		return;
	if (slave->function->code == WRITE_BLOCK && s->taken[2] > BLOCK) {
		sim_end(slave);
		return;
	}
	s->sent = true;
	sim_send_checked(slave, NULL, 0);
}

static void bae_query(struct sim_slave *slave)
{
	struct bae *s = slave->state;
	uint8_t out[2 + BLOCK] = {s->result, s->answers};

	if (slave->now < s->done) {
		sim_send(slave, (const uint8_t[]){BUSY, 0}, 2);
		return;
	}
	memcpy(out + 2, s->answer, s->answers);
	sim_send_checked(slave, out, 2u + s->answers);
}

/* After the checksum the confirmation may come. */
#define WRITES(code_) .code = (code_), .start = bae_begin, .byte = bae_take, .next = sim_receive
static const struct sim_function functions[] = {
	{.code = VERSION, .start = bae_version},
	{.code = TYPE, .start = bae_type},
	{WRITES(EXTENDED)},
	{.code = READ_BLOCK, .takes = 3, .start = read_block},
	{WRITES(WRITE_BLOCK)},
	{WRITES(ERASE_PAGE)},
	{WRITES(WRITE_RUN)},
	{WRITES(SEQUENCE_WRITE)},
	{WRITES(SEQUENCE_READ)},
	{.code = QUERY, .start = bae_query},
	{0},
};

static const struct sim_input inputs[] = {{.name = "adc", .start = 2.5, .least = 0, .most = 5},
                                          {0}};

/* Its memory: registers (the 0910 has 128, the 0911 2048), EEPROM, SD card, I2C expander, text. */
#define BAE(part) \
	.name = (part), .code = 0xFC, .state_size = sizeof(struct bae), .functions = functions, \
	.inputs = inputs, .create = bae_create, .power_on = bae_power_on, .advance = bae_advance, \
	SIM_MEMORY(bae, registers, offsetof(struct bae, taken))

const struct sim_family sim_bae0910 = {BAE("BAE0910")};
const struct sim_family sim_bae0911 = {BAE("BAE0911")};
