/* SPDX-License-Identifier: MIT */
/*
 * BAE 0910 and 0911 by Pascal Baerten: microcontrollers whose functions are registers. What a
 * command gives has a CRC16; a command that writes is acknowledged with one, and acts when the
 * master confirms it. Nothing but what is read back shows whether the confirmation was heard.
 *
 * No data sheet could be had: commands and registers are those of OWFS's driver. Registers are read
 * and written, and the EEPROM is read. What no register shows is refused: the programs that run in
 * a 0911 (I2C, card, texts), raw commands, what writes EEPROM and firmware.
 *
 * Clocks may have gone on for two seconds when they are read back, and a sector of the card is read
 * twice. Nothing shows a confirmation of registers that change by themselves (counters, latches),
 * of those that start something (`init`), of texts, and of `command`.
 */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "hal/chips/field.h"

#define BLOCK 32
#define PAGE 512
#define REGISTERS 0x7800 /* of the 0911 */
#define LATE_S 2         /* a clock may be so much ahead of the time since it was written */
#define S_NS (1000 * TXN_MS)

#define EEPROM_910 0xe000
#define CONFIRM 0xbc

enum { READ_VERSION = 0x11, READ_TYPE, READ_BLOCK = 0x14, WRITE_BLOCK };
enum { BAE_910 = 1, BAE_911, BAE_OTHER }; /* device.kind */

static int bae_identify(struct txn *txn)
{
	uint8_t type[2];
	int err = txn_ask_crc16(txn, TXN_BYTES(READ_TYPE), type, sizeof(type));

	if (!err)
		txn->device->kind = type[0] == 2 ? BAE_910 : type[0] == 3 ? BAE_911 : BAE_OTHER;
	return err;
}

/* A command of n bytes, its checksum, the confirmation. */
static int bae_confirmed(struct txn *txn, const uint8_t *command, unsigned n)
{
	uint8_t none;
	int err = txn_ask_crc16(txn, command, n, &none, 0);

	return err ? err : txn_write(txn, TXN_BYTES(CONFIRM));
}

/* The EEPROM of a 0910 stands elsewhere. */
static unsigned bae_address(const struct txn *txn, const struct area *area, unsigned at)
{
	bool moved = area->size > 0x3000 && txn->device->kind == BAE_910;

	return area->at + at + (moved ? EEPROM_910 : 0);
}

static int bae_load(struct txn *txn, const struct area *area, unsigned at, uint8_t *bytes,
                    unsigned n)
{
	unsigned where = bae_address(txn, area, at);
	const uint8_t command[] = {READ_BLOCK, (uint8_t)where, (uint8_t)(where >> 8), (uint8_t)n};
	return txn_ask_crc16(txn, command, sizeof(command), bytes, n);
}

static int bae_store(struct txn *txn, const struct area *area, unsigned at, const uint8_t *bytes,
                     unsigned n)
{
	unsigned where = bae_address(txn, area, at);
	uint8_t command[4 + AREA_UNIT] = {WRITE_BLOCK, (uint8_t)where, (uint8_t)(where >> 8),
	                                  (uint8_t)n};

	memcpy(command + 4, bytes, n);
	return bae_confirmed(txn, command, 4 + n);
}

#define MEMORY(text, at_, size_, block_) \
	.name = (text), .at = (at_), .size = (size_), .block = (block_), .row = (block_), \
	.load = bae_load, .store = bae_store

static uint32_t big_endian_of(const uint8_t *bytes, unsigned n)
{
	uint32_t number = 0;

	for (unsigned i = 0; i < n; i++)
		number = number << 8 | bytes[i];
	return number;
}

/*
 * The ways. KEPT, LIVE and CLOCK also say how what is read back shows that a register was written:
 * it is the same; it changes by itself, or by being written, so that a lost confirmation is not
 * seen; it counts seconds, and may have gone on.
 */
enum { KEPT = 1, LIVE, CLOCK, WAY_WORDS, WAY_PAGE, WAY_REFUSED };

/* All bytes of a register at once; then they are read back. */
static int write_register(struct txn *txn)
{
	const struct field *field = &txn->property->field;
	const struct area *area = family_area(txn);
	unsigned n = field->bytes, at = field->at + (unsigned)txn->element * field->stride;
	uint8_t bytes[4], in[4];
	int64_t *written_ns = txn_own(txn, int64_t); /* other requests may come before the look */
	double left = txn->number[0];
	int err;

	if (!(left >= 0 && left <= UINT32_MAX) || (n < 4 && left >= (double)(UINT32_C(1) << 8 * n)))
		return -EINVAL;
	for (unsigned i = 0; i < n; i++)
		bytes[i] = (uint8_t)((uint32_t)left >> 8 * (n - 1 - i));
	if (txn->phase == 0) {
		txn_void(txn);
		txn->phase = 1;
		*written_ns = txn_now(txn);
		err = bae_store(txn, area, at, bytes, n);
		return err ? err : txn->property->how == LIVE ? 0 : TXN_MORE;
	}
	err = bae_load(txn, area, at, in, n);
	if (err)
		return err;
	uint32_t gone = txn->property->how == CLOCK
	                        ? (uint32_t)((txn_now(txn) - *written_ns) / S_NS) + LATE_S
	                        : 0;

	return big_endian_of(in, n) - (uint32_t)left <= gone ? 0 : -EIO;
}

/* Two bytes, as text the second is first. */
static int read_words(struct txn *txn)
{
	const struct area *area = txn->device->family->areas[txn->property->arg];
	uint8_t bytes[2];
	char text[8];
	int err = area_read(txn, area, 0, bytes, sizeof(bytes));

	if (err)
		return err;
	snprintf(text, sizeof(text), "%.2X.%.2X", bytes[1], bytes[0]);
	return property_text(txn, text);
}

static int read_page(struct txn *txn)
{
	bool there = txn->element < (txn->device->kind == BAE_910 ? 2 : 8);

	return there ? field_read(txn) : -ENOENT;
}

enum { REGISTERS_910 = 1, REGISTERS_911, GENERIC, EEPROM, VERSION, TYPE };
static const struct area *const areas[] = {
	[REGISTERS_910] = AREA(MEMORY("registers", 0, 128, 1)),
	[REGISTERS_911] = AREA(MEMORY("registers", REGISTERS, 0x800, 1)),
	[GENERIC] = AREA(MEMORY("memory", 0, 128, BLOCK)),
	[EEPROM] = AREA(MEMORY("EEPROM", 0, 32 * PAGE, BLOCK)),
	[VERSION] = AREA(.name = "version", .size = 2, .block = 2, .read = READ_VERSION,
                         .check = AREA_CRC16),
	[TYPE] = AREA(.name = "type", .size = 2, .block = 2, .read = READ_TYPE,
                      .check = AREA_CRC16),
};

static const struct property_how how[] = {
	[KEPT] = {.write = write_register},
	[LIVE] = {.write = write_register},
	[CLOCK] = {.write = write_register},
	[WAY_WORDS] = {.read = read_words},
	[WAY_PAGE] = {.read = read_page, .write = property_refuse},
	[WAY_REFUSED] = {.read = property_refuse, .write = property_refuse},
};

/* clang-format off */
#define OLD KIND(BAE_910)
#define NEW KIND(BAE_911)
#define UNKNOWN_KIND KIND(BAE_OTHER)
#define FOLDER(text, which) PROPERTY(text, DIRECTORY, STATIC, NONE, .kinds = (which))
/* High byte first. */
#define REGISTER_910(text, kind, life_, access_, at_, bytes_, ...) \
	PROPERTY(text, kind, life_, access_, .kinds = OLD, \
	         FIELD(REGISTERS_910, .at = (at_), .bytes = (bytes_), .big_endian = true), \
	         .how = __VA_ARGS__)
#define REGISTER_911(text, kind, life_, access_, at_, bytes_, way) \
	PROPERTY(text, kind, life_, access_, .kinds = NEW, \
	         FIELD(REGISTERS_911, .at = (at_) - REGISTERS, .bytes = (bytes_), .big_endian = true), \
	         .how = (way))
#define ARRAY_911(text, kind, access_, n, at_, bytes_, ...) \
	PROPERTY(text, kind, VOLATILE, access_, ELEMENTS(n, NUMBERS), .kinds = NEW, \
	         FIELD(REGISTERS_911, .at = (at_) - REGISTERS, .bytes = (bytes_), \
	               .stride = (bytes_), .big_endian = true), .how = __VA_ARGS__)
#define REFUSED(text, kind, life_, access_, ...) \
	PROPERTY(text, kind, life_, access_, .kinds = NEW, .how = WAY_REFUSED, __VA_ARGS__)
#define PWM(folder, duty0, duty1, mode0, mode1, period, clock) \
	FOLDER(folder, NEW), \
	REGISTER_911(folder "/duty_ch0", UNSIGNED, VOLATILE, BOTH, duty0, 2, KEPT), \
	REGISTER_911(folder "/duty_ch1", UNSIGNED, VOLATILE, BOTH, duty1, 2, KEPT), \
	REGISTER_911(folder "/mode_ch0", UNSIGNED, VOLATILE, BOTH, mode0, 1, KEPT), \
	REGISTER_911(folder "/mode_ch1", UNSIGNED, VOLATILE, BOTH, mode1, 1, KEPT), \
	REGISTER_911(folder "/period", UNSIGNED, VOLATILE, BOTH, period, 2, KEPT), \
	REGISTER_911(folder "/ref_clock", UNSIGNED, VOLATILE, BOTH, clock, 1, KEPT)
/* The two bytes of the version and of the type: each alone, and together. */
#define WORD(text, area_, byte) \
	PROPERTY(text, UNSIGNED, VOLATILE, READ, FIELD(area_, .at = (byte)))
#define STATE(text, area_) \
	PROPERTY(text, UNSIGNED, VOLATILE, READ, .hidden = true, \
	         FIELD(area_, .at = 0, .bytes = 2, .big_endian = true))
#define DOTTED(text, area_) \
	PROPERTY(text, ASCII, VOLATILE, READ, .size = 5, .arg = (area_), .how = WAY_WORDS)

static const struct property properties[] = {
	FOLDER("910", OLD),
	REGISTER_910("910/adc", UNSIGNED, VOLATILE, READ, 0x32, 1, KEPT),
	REGISTER_910("910/adc10", UNSIGNED, VOLATILE, READ, 0x3e, 2, KEPT),
	REGISTER_910("910/adcan", UNSIGNED, VOLATILE, READ, 0x18, 2, KEPT),
	REGISTER_910("910/adcap", UNSIGNED, VOLATILE, READ, 0x16, 2, KEPT),
	REGISTER_910("910/adcc", UNSIGNED, VOLATILE, BOTH, 0x2, 1, KEPT),
	REGISTER_910("910/adctotn", UNSIGNED, VOLATILE, BOTH, 0x24, 4, LIVE),
	REGISTER_910("910/adctotp", UNSIGNED, VOLATILE, BOTH, 0x20, 4, LIVE),
	REGISTER_910("910/alan", UNSIGNED, VOLATILE, BOTH, 0x42, 2, KEPT),
	REGISTER_910("910/alap", UNSIGNED, VOLATILE, BOTH, 0x40, 2, KEPT),
	REGISTER_910("910/alarm", UNSIGNED, VOLATILE, BOTH, 0x34, 1, LIVE),
	REGISTER_910("910/alarmc", UNSIGNED, VOLATILE, BOTH, 0x6, 1, KEPT),
	REGISTER_910("910/alcps", UNSIGNED, VOLATILE, BOTH, 0x44, 2, KEPT),
	REGISTER_910("910/alct", UNSIGNED, VOLATILE, BOTH, 0x46, 4, KEPT),
	REGISTER_910("910/cnt", UNSIGNED, VOLATILE, READ, 0x33, 1, KEPT),
	REGISTER_910("910/cntc", UNSIGNED, VOLATILE, BOTH, 0x3, 1, KEPT),
	REGISTER_910("910/count", UNSIGNED, VOLATILE, BOTH, 0x2c, 4, LIVE, COUNTS_TO(UINT32_MAX)),
	REGISTER_910("910/cps", UNSIGNED, VOLATILE, READ, 0x1e, 2, KEPT),
	REGISTER_910("910/date", DATE, VOLATILE, BOTH, 0x28, 4, CLOCK),
	REGISTER_910("910/duty1", UNSIGNED, VOLATILE, BOTH, 0xe, 2, KEPT),
	REGISTER_910("910/duty2", UNSIGNED, VOLATILE, BOTH, 0x10, 2, KEPT),
	REGISTER_910("910/duty3", UNSIGNED, VOLATILE, BOTH, 0x12, 2, KEPT),
	REGISTER_910("910/duty4", UNSIGNED, VOLATILE, BOTH, 0x14, 2, KEPT),
	REGISTER_910("910/maxan", UNSIGNED, VOLATILE, BOTH, 0x1c, 2, LIVE),
	REGISTER_910("910/maxap", UNSIGNED, VOLATILE, BOTH, 0x1a, 2, LIVE),
	REGISTER_910("910/maxcps", UNSIGNED, VOLATILE, BOTH, 0x5e, 2, LIVE),
	REGISTER_910("910/out", UNSIGNED, VOLATILE, BOTH, 0x30, 1, KEPT),
	REGISTER_910("910/outc", UNSIGNED, VOLATILE, BOTH, 0x4, 1, KEPT),
	REGISTER_910("910/ovruncnt", UNSIGNED, VOLATILE, BOTH, 0x5c, 2, LIVE),
	REGISTER_910("910/pc0", UNSIGNED, VOLATILE, BOTH, 0x36, 2, LIVE),
	REGISTER_910("910/pc1", UNSIGNED, VOLATILE, BOTH, 0x38, 2, LIVE),
	REGISTER_910("910/pc2", UNSIGNED, VOLATILE, BOTH, 0x3a, 2, LIVE),
	REGISTER_910("910/pc3", UNSIGNED, VOLATILE, BOTH, 0x3c, 2, LIVE),
	REGISTER_910("910/period1", UNSIGNED, VOLATILE, BOTH, 0xa, 2, KEPT),
	REGISTER_910("910/period2", UNSIGNED, VOLATILE, BOTH, 0xc, 2, KEPT),
	REGISTER_910("910/pio", UNSIGNED, VOLATILE, BOTH, 0x31, 1, KEPT),
	REGISTER_910("910/pioc", UNSIGNED, VOLATILE, BOTH, 0x5, 1, KEPT),
	REGISTER_910("910/resetcnt", UNSIGNED, VOLATILE, BOTH, 0x56, 2, LIVE),
	REGISTER_910("910/rtcc", UNSIGNED, VOLATILE, BOTH, 0x7, 1, KEPT),
	REGISTER_910("910/selectcnt", UNSIGNED, VOLATILE, BOTH, 0x58, 2, LIVE),
	REGISTER_910("910/stalledcnt", UNSIGNED, VOLATILE, BOTH, 0x5a, 2, LIVE),
	REGISTER_910("910/tpm1c", UNSIGNED, VOLATILE, BOTH, 0x8, 1, KEPT),
	REGISTER_910("910/tpm2c", UNSIGNED, VOLATILE, BOTH, 0x9, 1, KEPT),
	REGISTER_910("910/udate", UNSIGNED, SECOND, BOTH, 0x28, 4, CLOCK),
	REGISTER_910("910/usera", UNSIGNED, VOLATILE, BOTH, 0x60, 1, KEPT),
	REGISTER_910("910/userb", UNSIGNED, VOLATILE, BOTH, 0x61, 1, KEPT),
	REGISTER_910("910/userc", UNSIGNED, VOLATILE, BOTH, 0x62, 1, KEPT),
	REGISTER_910("910/userd", UNSIGNED, VOLATILE, BOTH, 0x63, 1, KEPT),
	REGISTER_910("910/usere", UNSIGNED, VOLATILE, BOTH, 0x64, 1, KEPT),
	REGISTER_910("910/userf", UNSIGNED, VOLATILE, BOTH, 0x65, 1, KEPT),
	REGISTER_910("910/userg", UNSIGNED, VOLATILE, BOTH, 0x66, 1, KEPT),
	REGISTER_910("910/userh", UNSIGNED, VOLATILE, BOTH, 0x67, 1, KEPT),
	REGISTER_910("910/useri", UNSIGNED, VOLATILE, BOTH, 0x68, 2, KEPT),
	REGISTER_910("910/userj", UNSIGNED, VOLATILE, BOTH, 0x6a, 2, KEPT),
	REGISTER_910("910/userk", UNSIGNED, VOLATILE, BOTH, 0x6c, 2, KEPT),
	REGISTER_910("910/userl", UNSIGNED, VOLATILE, BOTH, 0x6e, 2, KEPT),
	REGISTER_910("910/userm", UNSIGNED, VOLATILE, BOTH, 0x70, 4, KEPT),
	REGISTER_910("910/usern", UNSIGNED, VOLATILE, BOTH, 0x74, 4, KEPT),
	REGISTER_910("910/usero", UNSIGNED, VOLATILE, BOTH, 0x78, 4, KEPT),
	REGISTER_910("910/userp", UNSIGNED, VOLATILE, BOTH, 0x7c, 4, KEPT),
	FOLDER("911", NEW),
	FOLDER("911/alarm", NEW),
	REGISTER_911("911/alarm/clear_latchs", YESNO, VOLATILE, BOTH, 0x7e09, 1, LIVE),
	REGISTER_911("911/alarm/enable_global", UNSIGNED, VOLATILE, BOTH, 0x7f78, 1, KEPT),
	ARRAY_911("911/alarm/enable_latch", YESNO, BOTH, 22, 0x7984, 1, KEPT),
	ARRAY_911("911/alarm/latch", YESNO, BOTH, 22, 0x7958, 1, LIVE),
	REGISTER_911("911/alarm/userbits", UNSIGNED, VOLATILE, BOTH, 0x7f83, 4, LIVE),
	REGISTER_911("911/alarm/userbits_enable", UNSIGNED, VOLATILE, BOTH, 0x7f87, 4, KEPT),
	FOLDER("911/analog", NEW),
	ARRAY_911("911/analog/adc", UNSIGNED, READ, 16, 0x7f00, 2, KEPT),
	REGISTER_911("911/analog/adc_enable", YESNO, VOLATILE, BOTH, 0x79b1, 1, KEPT),
	FOLDER("911/analog/comparator", NEW),
	REGISTER_911("911/analog/comparator/acmp_enable", YESNO, VOLATILE, BOTH, 0x79ac, 1, KEPT),
	REGISTER_911("911/analog/comparator/changed", YESNO, VOLATILE, BOTH, 0x79ae, 1, LIVE),
	REGISTER_911("911/analog/comparator/internal_ref", YESNO, VOLATILE, BOTH, 0x79ad, 1, KEPT),
	REGISTER_911("911/analog/comparator/out_enable", YESNO, VOLATILE, BOTH, 0x79b0, 1, KEPT),
	REGISTER_911("911/analog/comparator/out_state", YESNO, VOLATILE, READ, 0x79af, 1, KEPT),
	FOLDER("911/automation_engine", NEW),
	ARRAY_911("911/automation_engine/global_mem", UNSIGNED, BOTH, 64, 0x7c00, 1, KEPT),
	REFUSED("911/automation_engine/global_memory", UNSIGNED, VOLATILE, BOTH, SPARSE(NUMBERS)),
	REGISTER_911("911/automation_engine/pc0", UNSIGNED, VOLATILE, BOTH, 0x7e07, 2, LIVE),
	FOLDER("911/counters", NEW),
	ARRAY_911("911/counters/count", UNSIGNED, BOTH, 18, 0x7f20, 4, LIVE,
		  COUNTS_TO(UINT32_MAX)),
	ARRAY_911("911/counters/enable_counter", YESNO, BOTH, 18, 0x796e, 1, KEPT),
	REGISTER_911("911/counters/enable_encoder0", YESNO, VOLATILE, BOTH, 0x799a, 1, KEPT),
	REGISTER_911("911/counters/enable_encoder16", YESNO, VOLATILE, BOTH, 0x799e, 1, KEPT),
	REGISTER_911("911/counters/enable_encoder17", YESNO, VOLATILE, BOTH, 0x799f, 1, KEPT),
	REGISTER_911("911/counters/enable_encoder5", YESNO, VOLATILE, BOTH, 0x799b, 1, KEPT),
	REGISTER_911("911/counters/enable_encoder8", YESNO, VOLATILE, BOTH, 0x799c, 1, KEPT),
	REGISTER_911("911/counters/enable_encoder9", YESNO, VOLATILE, BOTH, 0x799d, 1, KEPT),
	FOLDER("911/iic", NEW),
	FOLDER("911/iic/cat9554", NEW),
	REFUSED("911/iic/cat9554/direction", UNSIGNED, VOLATILE, BOTH, .arg = 0),
	REFUSED("911/iic/cat9554/pio", UNSIGNED, VOLATILE, BOTH, .arg = 0),
	REGISTER_911("911/iic/init", UNSIGNED, VOLATILE, BOTH, 0x7e00, 1, LIVE),
	FOLDER("911/lcd", NEW),
	REGISTER_911("911/lcd/init", UNSIGNED, VOLATILE, BOTH, 0x7e01, 1, LIVE),
	REFUSED("911/lcd/text", ASCII, VOLATILE, WRITE, .size = 255),
	FOLDER("911/pio", NEW),
	ARRAY_911("911/pio/direction", YESNO, BOTH, 22, 0x7916, 1, KEPT),
	ARRAY_911("911/pio/pio", YESNO, BOTH, 22, 0x7900, 1, KEPT),
	ARRAY_911("911/pio/pull_down", YESNO, BOTH, 8, 0x79a0, 1, KEPT),
	ARRAY_911("911/pio/pull_enable", YESNO, BOTH, 22, 0x7942, 1, KEPT),
	ARRAY_911("911/pio/strength", YESNO, BOTH, 22, 0x792c, 1, KEPT),
	PWM("911/pwm1", 0x7a06, 0x7a08, 0x7a0e, 0x7a0f, 0x7a02, 0x7a00),
	PWM("911/pwm2", 0x7a0a, 0x7a0c, 0x7a10, 0x7a11, 0x7a04, 0x7a01),
	FOLDER("911/sdcard", NEW),
	REGISTER_911("911/sdcard/init", UNSIGNED, VOLATILE, BOTH, 0x7e04, 1, LIVE),
	REFUSED("911/sdcard/sector_data", BINARY, STABLE, BOTH, .size = 512),
	REFUSED("911/sdcard/sector_nr", UNSIGNED, STABLE, BOTH, .arg = 0),
	FOLDER("911/serial", NEW),
	REGISTER_911("911/serial/baud_divisor", UNSIGNED, VOLATILE, BOTH, 0x7a13, 2, KEPT),
	REFUSED("911/serial/dataout", ASCII, VOLATILE, WRITE, .size = 255),
	REGISTER_911("911/serial/scic", UNSIGNED, VOLATILE, BOTH, 0x7e0a, 1, KEPT),
	FOLDER("911/system", NEW),
	REGISTER_911("911/system/owidletime", UNSIGNED, VOLATILE, BOTH, 0x7f79, 1, KEPT),
	REGISTER_911("911/system/poweronflags", UNSIGNED, VOLATILE, READ, 0x7a29, 1, KEPT),
	REGISTER_911("911/system/watchdog1w", UNSIGNED, VOLATILE, BOTH, 0x7ffb, 1, KEPT),
	FOLDER("911/timers", NEW),
	REGISTER_911("911/timers/clock", UNSIGNED, VOLATILE, BOTH, 0x7f7a, 4, CLOCK),
	ARRAY_911("911/timers/countdown", UNSIGNED, BOTH, 32, 0x7f8b, 1, LIVE),
	REGISTER_911("911/timers/countdown_number", UNSIGNED, VOLATILE, BOTH, 0x7a12, 1, KEPT),
	REGISTER_911("911/timers/random", UNSIGNED, VOLATILE, READ, 0x7f7e, 1, KEPT),
	FOLDER("911/user_registers", NEW),
	ARRAY_911("911/user_registers/byte", UNSIGNED, BOTH, 16, 0x7fab, 1, KEPT),
	ARRAY_911("911/user_registers/dword", UNSIGNED, BOTH, 8, 0x7fdb, 4, KEPT),
	ARRAY_911("911/user_registers/word", UNSIGNED, BOTH, 16, 0x7fbb, 2, KEPT),
	WORD("bootstrap_version", VERSION, 1),
	WORD("chip_type", TYPE, 1),
	PROPERTY("command", BINARY, STABLE, WRITE, .size = 255, .how = WAY_REFUSED),
	WORD("device_type", TYPE, 0),
	WORD("device_version", VERSION, 0),
	PROPERTY_DIR("eeprom"),
	PROPERTY("eeprom/erase", YESNO, VOLATILE, WRITE, ELEMENTS(32, NUMBERS), .kinds = OLD | NEW,
		 .how = WAY_REFUSED),
	PROPERTY("eeprom/page", BINARY, VOLATILE, BOTH, ELEMENTS(32, NUMBERS), .size = 512,
		 .kinds = OLD | NEW, FIELD(EEPROM), .how = WAY_PAGE),
	REGISTER_911("eeprom/pagecrc", UNSIGNED, VOLATILE, BOTH, 0x7e0b, 2, LIVE),
	PROPERTY_DIR("firmware"),
	PROPERTY("firmware/function", BINARY, STABLE, WRITE, .size = 16384, .how = WAY_REFUSED),
	FOLDER("generic", UNKNOWN_KIND),
	PROPERTY("generic/memory", BINARY, VOLATILE, BOTH, .size = 128, .kinds = UNKNOWN_KIND,
		 FIELD(GENERIC)),
	DOTTED("localtype", TYPE),
	STATE("typestate", TYPE),
	DOTTED("version", VERSION),
	STATE("versionstate", VERSION),
};
/* clang-format on */

CHIP_FAMILY(fc, "BAE", PRESENCE, .flags = FLAG_RESUME | FLAG_ALARM, .several = true,
            .identify = bae_identify, SCAN({"910/count", "count"}, {"911/counters/count", "count"}),
            AREAS(areas), HOW(how), PROPERTIES(properties));
