/* SPDX-License-Identifier: MIT */
/*
 * DS2415 or DS1904 (data sheet, "1-Wire Time Chip") and DS2417, which has an interrupt pin besides:
 * a counter of seconds and a control byte, without a checksum.
 *
 * It is read until three in a row are the same; a clock that was written may have gone on for two
 * seconds. All eight bits of Read Clock (66h) turned over are Write Clock (99h): then the chip
 * takes ones for its control byte and its time.
 */
#include <errno.h>

#include "hal/chips/family.h"
#include "hal/chips/steady.h"

#define READ_CLOCK 0x66
#define WRITE_CLOCK 0x99
#define OSCILLATOR 0x0c /* both bits */
#define INTERRUPT 0x80
#define INTERVAL 0x70

/* The lowest two bits are 0. */
static void adjust(struct txn *txn, uint8_t *want)
{
	(void)txn;
	want[0] &= 0xfc;
}

/* A write of the control byte alone leaves the counter as it is. */
static AREA_NAMED(control, "control", .size = 1, .read = READ_CLOCK, .row = 1, .write = WRITE_CLOCK,
                  .adjust = adjust);
static AREA_NAMED(clock_area, "clock", .size = 5, .block = 5, .read = READ_CLOCK, .row = 5,
                  .write = WRITE_CLOCK, .load = steady_clock_load,
                  .is_written = steady_clock_is_written);

static int family_24_put(struct txn *txn, uint8_t bits, uint8_t mask)
{
	return area_write(txn, &control, 0, &bits, &mask, 1);
}

static int write_running(struct txn *txn)
{
	return family_24_put(txn, txn->number[0] != 0 ? OSCILLATOR : 0, OSCILLATOR);
}

static const int32_t seconds[] = {1, 4, 32, 64, 2048, 4096, 65536, 131072};

static int read_time(struct txn *txn)
{
	uint8_t byte;
	int err = area_read(txn, &control, 0, &byte, 1);

	if (!err)
		txn->number[0] = seconds[byte >> 4 & 7];
	return err;
}

/* The next interval that is as long, and the interrupt; 0 switches the interrupt off. */
static int write_time(struct txn *txn)
{
	unsigned n = 0;

	if (txn->number[0] < 0)
		return -EINVAL;
	if (txn->number[0] < 1)
		return family_24_put(txn, 0, INTERRUPT);
	while (n < 7 && txn->number[0] > seconds[n])
		n++;
	return family_24_put(txn, (uint8_t)(INTERRUPT | n << 4), INTERRUPT | INTERVAL);
}

enum { CONTROL = 1, CLOCK };
static const struct area *const areas[] = {[CONTROL] = &control, [CLOCK] = &clock_area};

enum { WAY_RUNNING = 1, WAY_TIME };
static const struct property_how how[] = {
	[WAY_RUNNING] = {.write = write_running},
	[WAY_TIME] = {.read = read_time, .write = write_time},
};

#define CONTROL_ROW \
	PROPERTY("ControlRegister", UNSIGNED, STABLE, BOTH, .hidden = true, FIELD(CONTROL))
#define TIME(text, kind, life_) PROPERTY(text, kind, life_, BOTH, FIELD(CLOCK, .at = 1, .bytes = 4))
#define RUNNING \
	PROPERTY("running", YESNO, VOLATILE, BOTH, FIELD(CONTROL, .shift = 3, .bits = 1), \
	         .how = WAY_RUNNING)

static const struct property ds2415[] = {
	CONTROL_ROW,
	TIME("date", DATE, VOLATILE),
	RUNNING,
	TIME("udate", UNSIGNED, SECOND),
	PROPERTY("user", UNSIGNED, VOLATILE, BOTH, FIELD(CONTROL, .shift = 4)),
};

static const struct property ds2417[] = {
	CONTROL_ROW,
	TIME("date", DATE, VOLATILE),
	PROPERTY("enable", YESNO, VOLATILE, BOTH, FIELD(CONTROL, .shift = 7)),
	PROPERTY("interval", INTEGER, VOLATILE, BOTH, FIELD(CONTROL, .shift = 4, .bits = 3)),
	PROPERTY("itime", INTEGER, VOLATILE, BOTH, .how = WAY_TIME),
	RUNNING,
	TIME("udate", UNSIGNED, SECOND),
};

CHIP_FAMILY(24, "DS2415", PRESENCE, AREAS(areas), HOW(how), PROPERTIES(ds2415));
CHIP_FAMILY(27, "DS2417", PRESENCE, AREAS(areas), HOW(how), PROPERTIES(ds2417));
