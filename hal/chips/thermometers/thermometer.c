/* SPDX-License-Identifier: MIT */
/*
 * The thermometers' scratchpad: what it says, and how a conversion's resolution is set.
 */
#include <errno.h>
#include <stdlib.h>

#include "hal/chips/thermometers/state.h"
#include "hal/chips/thermometers/thermometer.h"

#define WRITE_SCRATCHPAD 0x4e
#define RECALL 0xb8

#define RAW_POWER_ON 0x0550
#define RAW_BROKEN 0x07f8 /* 127.5 and above: no chip measures that */
#define REMAIN_POWER_ON 0x0c
#define PER_DEGREE 0x10       /* in every DS18S20 */
#define PER_DEGREE_MAX 0x7f   /* in a DS1820 of the 1990s, where the chip counts them */
#define WHOLE_POWER_ON 0x00aa /* of those without a resolution: half degrees */
#define FAMILY_3B 0x3b
#define CONFIG_ZERO 0x80 /* a bit that is 0 in every other chip with a resolution */
#define NEAR_RAW (5 * 16)
#define NEAR_NS (60 * 1000 * TXN_MS) /* as for an owserver: hal/owserver/judge.h */
#define LOOKS_ONE 3
#define LOOKS_ZERO 2
#define REFUSALS 3 /* as often as a request is tried */

/* What thermometer_prepare() keeps from call to call. */
struct visit {
	uint8_t scratchpad[9]; /* as it is to be */
};
static struct visit *visit_of(struct txn *txn)
{
	return txn_own(txn, struct visit);
}

void thermometer_forget(struct device *device)
{
	struct thermometer *chip = device->own;

	*chip = (struct thermometer){.make = chip->make,
	                             .ignores = chip->ignores,
	                             .refused = chip->refused,
	                             .only_12 = chip->only_12,
	                             .raw = chip->raw,
	                             .busy_ns = chip->busy_ns,
	                             .least_ns = chip->least_ns,
	                             .since_ns = chip->since_ns};
}

static int saw_config(struct txn *txn, const uint8_t scratchpad[9])
{
	struct thermometer *chip = txn->device->own;

	if (txn->device->family->fixed || chip->only_12)
		return 0;
	uint8_t resolution = (uint8_t)(9 + (scratchpad[SP_CONFIG] >> 5 & 3));
	if (chip->resolution && chip->resolution != resolution) {
		txn->restarted = true;
		thermometer_doubt(txn->device, txn_now(txn));
	}
	if (!chip->stored)
		chip->stored = resolution;
	chip->resolution = resolution;
	return 0;
}

/*
 * Nothing but zeros has a right checksum. The ones of a wire on which no chip answers get one by
 * two bits turned over. Chips of family 3B are told apart by that bit.
 */
bool thermometer_is_blank(const struct family *family, const uint8_t scratchpad[9])
{
	uint8_t per = scratchpad[SP_PER_DEGREE];

	if (scratchpad[SP_CONFIG] == 0 && per == 0)
		return true;
	if (family->fixed)
		return per > PER_DEGREE && (per > PER_DEGREE_MAX || scratchpad[SP_REMAIN] > per);
	return family->code != FAMILY_3B && (scratchpad[SP_CONFIG] & CONFIG_ZERO);
}

int thermometer_saw(struct txn *txn, unsigned at, uint8_t *scratchpad, unsigned n)
{
	/* A driver's, in part. */
	if (at || n < SP_CRC)
		return 0;
	const struct family *family = txn->device->family;
	bool blank = thermometer_is_blank(family, scratchpad);

	/* No chip divides a degree in none. */
	txn->blank |= blank;
	if (blank || (family->fixed && scratchpad[SP_PER_DEGREE] == 0))
		return -EBADMSG;
	thermometer_of(txn->device)->slow = txn->device->rom[0] == 0x28 && scratchpad[SP_5] != 0xff;
	return saw_config(txn, scratchpad);
}

AREA_NAMED(thermometer_area, "scratchpad", .size = 9, .block = 9, .parts = true, .read = 0xbe,
           .check = AREA_CRC8, .saw = thermometer_saw);

int thermometer_scratchpad(struct txn *txn, uint8_t scratchpad[9])
{
	const struct area *area = txn->device->family->areas[SCRATCHPAD];
	int err = area_fetch(txn, area, 0, scratchpad, 9);

	return err ? err : area->saw(txn, 0, scratchpad, 9);
}

int thermometer_settings(struct txn *txn, uint8_t scratchpad[9])
{
	if (!txn_driven(txn))
		return thermometer_scratchpad(txn, scratchpad);
	int err = area_fetch(txn, &thermometer_area, SP_HIGH, scratchpad + SP_HIGH, 3);
	return err ? err : saw_config(txn, scratchpad);
}

int thermometer_start(struct txn *txn)
{
	if (txn_driven(txn))
		return txn_driver_convert(txn, "temperature");
	int err = txn_command(txn, TXN_BYTES(THERMOMETER_CONVERT));
	return err ? err : txn_started(txn);
}

int thermometer_start_fed(struct txn *txn, int64_t ns)
{
	return txn_command_strong(txn, TXN_BYTES(THERMOMETER_CONVERT), ns);
}

/* Sixteenths of a degree at the resolution that the scratchpad states. */
static double sixteenths(const struct device *device, const uint8_t scratchpad[9])
{
	int raw = (int16_t)(scratchpad[SP_LSB] | scratchpad[SP_MSB] << 8);

	if (device->family->fixed) {
		int per_degree = scratchpad[SP_PER_DEGREE];
		int whole = raw >> 1;

		return whole * 16 - 4 + 16.0 * (per_degree - scratchpad[SP_REMAIN]) / per_degree;
	}
	if (thermometer_of(device)->only_12)
		return raw;
	return raw & ~((1 << (3 - (scratchpad[SP_CONFIG] >> 5 & 3))) - 1);
}

/* Of a chip that counts what a degree has, nobody knows the counts of its restart. */
static bool is_power_on(const struct device *device, int raw, const uint8_t scratchpad[9])
{
	return raw == RAW_POWER_ON ||
	       (device->family->fixed && scratchpad[SP_PER_DEGREE] != PER_DEGREE &&
	        (scratchpad[SP_LSB] | scratchpad[SP_MSB] << 8) == WHOLE_POWER_ON);
}

/*
 * The genuine chip's byte 6 is 16 less the last four bits of the temperature after a conversion,
 * and 12 at power-on; many clones keep one value. Where the two agree nothing is learnt.
 */
static void learn_make(struct device *device, const uint8_t scratchpad[9])
{
	int low = scratchpad[SP_LSB] & 0xf;

	if (device->family->fixed || thermometer_of(device)->resolution != 12 || low == 0 ||
	    low == 4)
		return;
	bool genuine = scratchpad[SP_REMAIN] == 16 - low && !clone_hides_restart(device->rom);
	thermometer_of(device)->make = genuine ? MAKE_GENUINE : MAKE_CLONE;
}

/* A result that ends as after a restart is the same in all of them: it takes nothing back. */
static void learn_name(struct device *device, const uint8_t scratchpad[9])
{
	bool exact = thermometer_of(device)->resolution == 12;

	if (!device->family->name ||
	    (device->identity && (!exact || (scratchpad[SP_LSB] & 0xf) == 4)))
		return;
	device->identity = device->family->name(device->rom, scratchpad, exact);
}

/*
 * Is the reading one of a chip that had no power (85 at power-on, 127.94)? -ERANGE, and
 * txn->restarted where the scratchpad proves it; else 0. now: when it was read.
 */
static int thermometer_guard(struct txn *txn, int raw, const uint8_t scratchpad[9], int64_t now)
{
	struct device *device = txn->device;

	if (raw >= RAW_BROKEN)
		return -ERANGE;
	if (!is_power_on(device, raw, scratchpad))
		return 0;
	if (thermometer_of(device)->make == MAKE_GENUINE &&
	    scratchpad[SP_REMAIN] != REMAIN_POWER_ON)
		return 0;
	if (thermometer_of(device)->make != MAKE_GENUINE && thermometer_of(device)->raw_ns &&
	    now - thermometer_of(device)->raw_ns < NEAR_NS &&
	    abs(thermometer_of(device)->raw - RAW_POWER_ON) <= NEAR_RAW)
		return 0;
	txn->restarted = scratchpad[SP_REMAIN] == REMAIN_POWER_ON &&
	                 (thermometer_of(device)->raw_ns || thermometer_of(device)->converted_ns);
	return -ERANGE;
}

int thermometer_write_settings(struct txn *txn, const uint8_t scratchpad[9])
{
	uint8_t out[4] = {WRITE_SCRATCHPAD, scratchpad[SP_HIGH], scratchpad[SP_LOW],
	                  scratchpad[SP_CONFIG]};
	unsigned n = txn->device->family->fixed ? 2 : 3;

	if (txn_driven(txn))
		return txn_driver_write(txn, &thermometer_area, SP_HIGH, out + 1, n);
	return txn_command(txn, out, 1 + n);
}

uint8_t thermometer_config(uint8_t config, unsigned resolution)
{
	return (uint8_t)((config & ~0x60) | (resolution - 9) << 5);
}

unsigned thermometer_bits(const struct device *device, unsigned convert)
{
	return convert == CONVERT_TEMPRES ? thermometer_of(device)->stored : convert;
}

bool thermometer_has_bits(const struct device *device, unsigned bits)
{
	const struct thermometer *chip = thermometer_of(device);

	return device->family->fixed || chip->ignores || !chip->resolution || !bits ||
	       chip->resolution == bits;
}

int thermometer_prepare(struct txn *txn, unsigned resolution)
{
	struct device *device = txn->device;
	struct thermometer *chip = thermometer_of(device);
	uint8_t scratchpad[9];
	int err;

	switch (txn->phase) {
	case 0:
		err = thermometer_settings(txn, visit_of(txn)->scratchpad);
		if (err || chip->resolution == resolution)
			return err;
		visit_of(txn)->scratchpad[SP_CONFIG] = thermometer_config(
			visit_of(txn)->scratchpad[SP_CONFIG], resolution);
		txn->phase = 1;
		return TXN_MORE;
	case 1:
		err = thermometer_rest(txn);
		if (err)
			return err;
		err = thermometer_write_settings(txn, visit_of(txn)->scratchpad);
		txn->phase = 2;
		return err ? err : TXN_MORE;
	default:
		chip->resolution = 0;
		err = thermometer_settings(txn, scratchpad);
		if (err)
			return err;
		if (chip->resolution == resolution) {
			chip->refused = 0;
			return 0;
		}
		/* It took another one before, or may have heard nothing: this write was lost. */
		if (chip->resolution != chip->stored || ++chip->refused < REFUSALS)
			return -EBADMSG;
		chip->ignores = true;
		return 0;
	}
}

int thermometer_read_temperature(struct txn *txn)
{
	struct device *device = txn->device;
	uint8_t scratchpad[9];
	int err = thermometer_scratchpad(txn, scratchpad);

	if (err)
		return err;
	int64_t now = txn_ended(txn);
	err = thermometer_ended(txn, scratchpad, now);
	if (err)
		return err;
	double exact = sixteenths(device, scratchpad);
	int raw = (int)exact;
	err = thermometer_guard(txn, raw, scratchpad, now);
	if (err)
		return err;
	learn_make(device, scratchpad);
	learn_name(device, scratchpad);
	err = thermometer_took(txn, scratchpad, now);
	thermometer_of(device)->raw = (int16_t)raw;
	txn->number[0] = exact / 16;
	return err;
}

/*
 * Nine bits at the first look may be those of a mark that an owsd which was killed has left
 * (thermometer_proof.h): what stands in the EEPROM counts.
 */
bool thermometer_forgot(const struct device *device)
{
	const struct thermometer *chip = thermometer_of(device);

	return chip->stored == THERMOMETER_MARK && !chip->recalled && chip->unseen;
}

int thermometer_recall(struct txn *txn)
{
	struct thermometer *chip = thermometer_of(txn->device);
	int err = thermometer_rest(txn);

	if (err)
		return err;
	chip->recalled = true;
	chip->resolution = chip->stored = 0;
	err = txn_command(txn, TXN_BYTES(RECALL));
	return err ? err : TXN_MORE;
}

/*
 * Of the dies that OWFS tells apart only the last is still around: B6 and B7 left the market before
 * 2001.
 */
int thermometer_read_die(struct txn *txn)
{
	return property_text(txn, "C2");
}

int thermometer_read_tempres(struct txn *txn)
{
	uint8_t scratchpad[9];
	int err = thermometer_settings(txn, scratchpad);

	txn->number[0] = thermometer_of(txn->device)->stored;
	return err;
}

/* Eight slots, which are all alike. */
static int look_at_supply(struct txn *txn, uint8_t *slots)
{
	static AREA_NAMED(supply, "supply", .size = 1);
	int err;

	if (txn_driven(txn)) {
		err = txn_driver_read(txn, &supply, 0, slots, 1);
	} else {
		err = txn_command(txn, TXN_BYTES(THERMOMETER_READ_POWER));
		err = err ? err : txn_read_slots(txn, slots, 1);
	}
	txn->silent = false;
	return err;
}

/* Ones are also what one hears of a chip that did not take the command: they need more looks. */
int thermometer_ask_power(struct txn *txn)
{
	uint8_t slots = 0, first = 0;

	for (int look = 0; look < (first ? LOOKS_ONE : LOOKS_ZERO); look++) {
		int err = look_at_supply(txn, &slots);

		if (err)
			return err;
		first = look ? first : slots;
		if (slots != first || (slots != 0 && slots != 0xff))
			return -EBADMSG;
	}
	txn->device->power = slots ? POWER_EXTERNAL : POWER_PARASITE;
	return slots != 0;
}

/* A one is also what one hears of a chip that is not there: the scratchpad proves that it is. */
int thermometer_read_power(struct txn *txn)
{
	uint8_t scratchpad[9];
	int bit;

	if (txn->phase == 2) {
		txn->number[0] = 1;
		return thermometer_settings(txn, scratchpad);
	}
	bit = thermometer_ask_power(txn);
	txn->number[0] = 0;
	if (bit == 0 && txn->phase)
		return -EBADMSG;
	txn->phase++;
	return bit > 0 ? TXN_MORE : bit;
}
