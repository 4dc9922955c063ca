/* SPDX-License-Identifier: MIT */
/*
 * DS2404 and DS1994 (data sheet 020998): 4 kbit of RAM with a battery, a clock, an interval timer
 * and a counter of cycles, and an alarm for each. Nothing has a checksum. To read the status
 * register clears its flags: they are kept with the device until they are asked for.
 *
 * Each is read until three in a row are the same. A clock that was written may have gone on for two
 * seconds. Ahead of the status register, as only one read of it shows the flags, comes a
 * conditional search, and the counters if that found nothing: of two alarms that are enabled, one
 * may be lost or added if a bit is turned over in just that read.
 */
#include <errno.h>
#include <string.h>

#include "hal/chips/family.h"
#include "hal/chips/steady.h"

#define FLAGS 0x07
#define SEARCHES 3 /* a disturbed one finds no chip */
#define ENABLES_SHIFT 3
#define ENABLES (FLAGS << ENABLES_SHIFT) /* 0 enables */

/* Each register is written by itself: the others go on. */
#define RAM .address_bytes = 2, .read = 0xf0, .write = 0x0f, .verify = 0xaa, .copy = 0x55
#define TIMER .size = 5, .block = 5, .row = 5, RAM
#define RUNS .load = steady_clock_load, .is_written = steady_clock_is_written

struct ds2404 {
	uint8_t flags;      /* that were read, and not asked for yet */
	uint8_t unproven;   /* what the looks showed so far, over all tries of a request */
	bool open, alarmed; /* the looks have begun; the chip was in alarm before them */
};

struct looks {
	uint8_t stage, status;
};

static AREA_NAMED(registers, "registers", .at = 0x202, .size = 28, .address_bytes = 2,
                  .read = 0xf0);

/* The flags whose counter has passed its alarm a moment ago. */
static uint8_t just_set(const uint8_t *bytes)
{
	static const uint8_t counter[] = {1, 6, 10}, alarm[] = {15, 20, 24};
	uint8_t flags = 0;

	for (unsigned i = 0; i < sizeof(counter); i++)
		if (area_le32(bytes + counter[i]) - area_le32(bytes + alarm[i]) <= 2)
			flags |= (uint8_t)(1 << i);
	return flags;
}

/*
 * Only one look shows a flag. What proves it is the search for chips in alarm before it; or the
 * counter, if the alarm came between them. A flag that is not enabled proves nothing and is left
 * out.
 */
static int judge_flags(struct txn *txn, uint8_t status)
{
	struct ds2404 *chip = txn->device->own;
	uint8_t enabled = FLAGS & ~(status >> ENABLES_SHIFT), flags = chip->unproven & enabled;
	uint8_t bytes[28];

	if (chip->alarmed && !flags) {
		chip->open = !(enabled & (enabled - 1));
		flags = enabled;
	} else if (!chip->alarmed && flags) {
		int err = area_fetch(txn, &registers, 0, bytes, sizeof(bytes));

		if (err || txn->silent)
			return err ? err : -EBADMSG;
		flags &= just_set(bytes);
	}
	if (!chip->open)
		return -EIO; /* one of several was lost */
	chip->flags |= flags;
	chip->open = false;
	return 0;
}

static int look_for_alarm(struct txn *txn, struct looks *looks)
{
	struct ds2404 *chip = txn->device->own;
	int alarm = chip->open && chip->alarmed ? 1 : txn_verify(txn, true);

	if (alarm < 0)
		return alarm;
	if (++looks->stage < SEARCHES && !alarm)
		return TXN_MORE;
	looks->stage = SEARCHES;
	if (!chip->open)
		chip->unproven = 0;
	chip->alarmed = alarm;
	chip->open = true;
	return TXN_MORE;
}

static int load_status(struct txn *txn, const struct area *area, unsigned at, uint8_t *bytes,
                       unsigned n)
{
	struct looks *looks = txn_own(txn, struct looks);
	struct ds2404 *chip = txn->device->own;
	int err;

	if (looks->stage < SEARCHES)
		return look_for_alarm(txn, looks);
	if (looks->stage < SEARCHES + (txn->silent ? 2 * AREA_LOOKS : AREA_LOOKS)) {
		err = area_fetch(txn, area, at, bytes, n);
		if (err)
			return err;
		chip->unproven |= bytes[0] & FLAGS;
		if (looks->stage++ > SEARCHES && ((bytes[0] ^ looks->status) & ENABLES))
			return -EBADMSG;
		looks->status = bytes[0] & ENABLES;
		return TXN_MORE;
	}
	err = judge_flags(txn, looks->status);
	bytes[0] = looks->status | chip->flags;
	memset(looks, 0, sizeof(*looks));
	return err;
}

static bool status_is_written(struct txn *txn, const uint8_t *have, const uint8_t *want, unsigned n)
{
	(void)txn, (void)n;
	return ((have[0] ^ want[0]) & ENABLES) == 0;
}

static void adjust_time(struct txn *txn, uint8_t *want)
{
	(void)txn;
	want[0] = 0; /* of a second */
}

static AREA_NAMED(status, "status", .at = 0x200, .size = 1, .row = 1, RAM, .load = load_status,
                  .is_written = status_is_written);

/* Three bits as three decimal digits. */
static double digits_of(unsigned bits)
{
	return (bits & 1) + 10.0 * (bits >> 1 & 1) + 100.0 * (bits >> 2 & 1);
}

static int read_alarm(struct txn *txn)
{
	struct ds2404 *chip = txn->device->own;
	uint8_t byte;
	int err = area_read(txn, &status, 0, &byte, 1);

	if (err)
		return err;
	txn->number[0] = digits_of(byte & FLAGS);
	chip->flags = 0;
	return 0;
}

static int read_set_alarm(struct txn *txn)
{
	uint8_t byte;
	int err = area_read(txn, &status, 0, &byte, 1);

	if (!err)
		txn->number[0] = digits_of(byte >> ENABLES_SHIFT & FLAGS);
	return err;
}

static int write_set_alarm(struct txn *txn)
{
	unsigned digits = (unsigned)txn->number[0];
	unsigned bits = digits % 10 | digits / 10 % 10 << 1 | digits / 100 << 2;
	uint8_t byte = (uint8_t)(bits << ENABLES_SHIFT);

	return area_write(txn, &status, 0, &byte, TXN_BYTES(FLAGS << ENABLES_SHIFT));
}

enum { MEMORY = 1, CONTROL, CLOCK, INTERVAL, CYCLE, CLOCK_ALARM, INTERVAL_ALARM, CYCLE_ALARM };
static const struct area *const areas[] = {
	[MEMORY] = AREA(.name = "memory", .size = 512, .row = 32, RAM),
	[CONTROL] = AREA(.name = "control", .at = 0x201, .size = 1, .row = 1, RAM),
	[CLOCK] = AREA(.name = "clock", .at = 0x202, TIMER, RUNS, .adjust = adjust_time),
	[INTERVAL] = AREA(.name = "interval", .at = 0x207, TIMER, RUNS, .adjust = adjust_time),
	[CYCLE] = AREA(.name = "cycle", .at = 0x20c, .size = 4, .block = 4, .row = 4, RAM),
	[CLOCK_ALARM] = AREA(.name = "clock alarm", .at = 0x210, TIMER, .adjust = adjust_time),
	[INTERVAL_ALARM] = AREA(.name = "interval alarm", .at = 0x215, TIMER,
                                .adjust = adjust_time),
	[CYCLE_ALARM] = AREA(.name = "cycle alarm", .at = 0x21a, .size = 4, .block = 4, .row = 4,
                             RAM),
};

enum { WAY_ALARM = 1, WAY_SET_ALARM };
static const struct property_how how[] = {
	[WAY_ALARM] = {.read = read_alarm},
	[WAY_SET_ALARM] = {.read = read_set_alarm, .write = write_set_alarm},
};

#define FLAG(text, shift_) \
	PROPERTY(text, YESNO, STABLE, BOTH, FIELD(CONTROL, .shift = (shift_), .bits = 1))
/* STOP/START of the interval timer: 1 stops it. */
#define START \
	PROPERTY("start", YESNO, STABLE, BOTH, \
	         FIELD(CONTROL, .shift = 6, .bits = 1, .inverted = true))
#define DATE_OF(text, area_) PROPERTY(text, DATE, VOLATILE, BOTH, FIELD(area_, .at = 1, .bytes = 4))
#define SECONDS_OF(text, area_) \
	PROPERTY(text, UNSIGNED, SECOND, BOTH, FIELD(area_, .at = 1, .bytes = 4))
#define CYCLES_OF(text, area_) \
	PROPERTY(text, UNSIGNED, SECOND, BOTH, FIELD(area_, .bytes = 4), COUNTS_TO(UINT32_MAX))

static const struct property properties[] = {
	PROPERTY("alarm", UNSIGNED, VOLATILE, READ, .flag = true, .alarm = ALARM_LATCH,
                 .how = WAY_ALARM),
	FLAG("auto", 5),
	CYCLES_OF("cycle", CYCLE),
	DATE_OF("date", CLOCK),
	FLAG("delay", 7),
	PROPERTY_DIR("interval"),
	DATE_OF("interval/date", INTERVAL),
	SECONDS_OF("interval/udate", INTERVAL),
	AREA_MEMORY(MEMORY, 512),
	PROPERTY_DIR("pages"),
	AREA_PAGES(MEMORY, 16, 32),
	PROPERTY_DIR("readonly"),
	FLAG("readonly/clock", 0),
	FLAG("readonly/cycle", 2),
	FLAG("readonly/interval", 1),
	FLAG("readonly/memory", 3),
	FLAG("running", 4),
	PROPERTY("set_alarm", UNSIGNED, STABLE, BOTH, .digits = 111, .how = WAY_SET_ALARM),
	START,
	PROPERTY_DIR("trigger"),
	CYCLES_OF("trigger/cycle", CYCLE_ALARM),
	DATE_OF("trigger/date", CLOCK_ALARM),
	DATE_OF("trigger/interval_date", INTERVAL_ALARM),
	SECONDS_OF("trigger/interval_udate", INTERVAL_ALARM),
	SECONDS_OF("trigger/udate", CLOCK_ALARM),
	SECONDS_OF("udate", CLOCK),
};

CHIP_FAMILY(04, "DS2404", PRESENCE, .alarms = true, .flags = FLAG_ALARM, AREAS(areas), HOW(how),
            PROPERTIES(properties));
