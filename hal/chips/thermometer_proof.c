/* SPDX-License-Identifier: MIT */
/* When the result that a thermometer holds was taken, and what proves that it is a new one. */
#include <string.h>

#include "hal/chips/clone_id.h"
#include "hal/chips/family.h"
#include "hal/chips/thermometer_proof.h"
#include "hal/chips/thermometer_state.h"

#define LONGEST_NS (750 * TXN_MS)

/*
 * As the data sheet says, but for clones of the DS18B20 (clone.c): family D2 takes 523 ms at each
 * resolution, H 101 ms for 9 bits.
 */
int64_t thermometer_convert_ns(const struct device *device)
{
	const struct thermometer *chip = device->own;

	if (device->family->fixed || chip->resolution < 9 || chip->slow)
		return 750 * TXN_MS;
	if (chip->resolution == 9 && clone_has_id(device->rom))
		return 110 * TXN_MS;
	return 750 * TXN_MS >> (12 - chip->resolution);
}

/* What it may have begun before goes on, if it ignores this; it ends when it is not busy now. */
static void send(struct thermometer *chip, int64_t now, int64_t longest)
{
	if (now >= chip->busy_ns)
		chip->least_ns = now + longest;
	else if (now >= chip->least_ns)
		chip->least_ns = now;
	if (chip->busy_ns < now + longest)
		chip->busy_ns = now + longest;
}

void thermometer_told(struct device *device, int64_t now, int64_t longest)
{
	send(device->own, now, longest);
	thermometer_of(device)->tried = true;
}

/* When its resolution was not known at the start, the reading has told it. */
static int64_t ended_ns(const struct device *device)
{
	const struct thermometer *chip = device->own;
	int64_t takes = thermometer_convert_ns(device);
	int64_t end = chip->converted_ns -
	              (chip->longest_ns > takes ? chip->longest_ns - takes : 0);

	return chip->least_ns < end ? chip->least_ns : end;
}

/* One that has never shown that it converts does not show it to all either. */
void thermometer_converts(struct device *device, int64_t now, int64_t longest, bool unseen)
{
	struct thermometer *chip = device->own;

	chip->proves = chip->converted_ns && chip->raw_ns >= chip->converted_ns && !chip->tried;
	if (chip->converted_ns)
		chip->earlier_ns = ended_ns(device);
	send(chip, now, longest);
	chip->converted_ns = now + longest;
	chip->longest_ns = longest;
	chip->early_ns = 0;
	chip->tried = false;
	chip->unseen = unseen || chip->unheard >= THERMOMETER_SILENT;
}

void thermometer_doubt(struct device *device, int64_t now)
{
	struct thermometer *chip = device->own;

	if (chip->busy_ns && chip->busy_ns < now + LONGEST_NS)
		chip->busy_ns = now + LONGEST_NS;
}

int thermometer_rest(struct txn *txn)
{
	int64_t busy = thermometer_of(txn->device)->busy_ns, now = txn_now(txn);

	return busy > now ? txn_wait(txn, busy - now) : 0;
}

/* A reading of the scratchpad takes less, at the speed of standard slots. */
#define READING_NS (20 * TXN_MS)

/* It converts, and what was read until now is the result of the conversion before. */
static bool is_held(const struct thermometer *chip, int64_t now)
{
	return chip->held_until_ns && now <= chip->held_until_ns + READING_NS &&
	       chip->converted_ns > now;
}

/*
 * The same where the chip converts with all others of a double buffer's channel, which does not
 * show whether it heard. It did if it showed the start of its own, or if it holds something else
 * than when it was read last and converted once since. Else what it holds is as old as it was.
 */
static int64_t strict_ns(struct txn *txn, const uint8_t holds[3], int64_t now)
{
	struct thermometer *chip = thermometer_of(txn->device);
	bool held = is_held(chip, now);
	uint8_t conversion = (uint8_t)(chip->conversion - held);
	bool next = (uint8_t)(conversion - chip->read_of) <= 1;
	bool differs = memcmp(chip->latched, holds, sizeof(chip->latched)) != 0;
	bool own = held ? chip->held_own : chip->own;
	int64_t when = held ? chip->held_ns : chip->ended_ns;

	memcpy(chip->latched, holds, sizeof(chip->latched));
	chip->read_of = conversion;
	chip->changes = differs;
	txn->held = held;
	if ((own || (differs && next)) && when > chip->latched_ns && when < now)
		chip->latched_ns = when;
	return chip->latched_ns;
}

/*
 * When the chip latched what it holds. While the strong pull-up is on, no chip can show that it
 * converts. If it holds something else than when it was read last, and converted once since, it
 * did. If not, a conversion may have been missed: then this is at least the result of the one
 * before.
 */
static int64_t latched_ns(struct txn *txn, const uint8_t scratchpad[9], int64_t now)
{
	struct device *device = txn->device;
	const uint8_t holds[3] = {scratchpad[SP_LSB], scratchpad[SP_MSB], scratchpad[SP_REMAIN]};
	bool changed = thermometer_of(device)->raw_ns &&
	               thermometer_of(device)->raw_ns >= thermometer_of(device)->earlier_ns &&
	               memcmp(thermometer_of(device)->latched, holds, sizeof(holds)) != 0;

	if (thermometer_of(device)->strict && thermometer_of(device)->latched_ns &&
	    thermometer_of(device)->converted_ns)
		return strict_ns(txn, holds, now);
	thermometer_of(device)->read_of = thermometer_of(device)->conversion;
	memcpy(thermometer_of(device)->latched, holds, sizeof(holds));
	txn->unproven = thermometer_of(device)->unseen && !changed;
	int64_t when = txn->unproven ? thermometer_of(device)->earlier_ns : ended_ns(device);
	/* It never becomes older than it was. */
	if (when > thermometer_of(device)->latched_ns && when < now)
		thermometer_of(device)->latched_ns = when;
	return thermometer_of(device)->latched_ns;
}

/*
 * The conversion seemed to end before its longest time. It did if the chip holds another
 * temperature than when it was read last, and that was the result of the conversion before. Byte 6
 * is no proof in a chip that lets it be written.
 */
static bool is_proven(const struct device *device, const uint8_t scratchpad[9])
{
	const struct thermometer *chip = thermometer_of(device);
	const uint8_t *was = chip->latched;

	return chip->proves && (was[0] != scratchpad[SP_LSB] || was[1] != scratchpad[SP_MSB] ||
	                        (device->family->fixed && was[2] != scratchpad[SP_REMAIN]));
}

/* Byte 6 follows the temperature in each chip of which results are read while it converts. */
static bool is_whole(const uint8_t scratchpad[9])
{
	unsigned low = scratchpad[SP_LSB] & 0xf;

	return scratchpad[SP_REMAIN] == 16 - low;
}

/* Since its last reading but one conversion may have ended. */
static bool has_changed(const struct thermometer *chip, const uint8_t scratchpad[9])
{
	return chip->read_of == (uint8_t)(chip->conversion - 1) &&
	       (chip->latched[0] != scratchpad[SP_LSB] || chip->latched[1] != scratchpad[SP_MSB]);
}

int thermometer_ended(struct txn *txn, const uint8_t scratchpad[9], int64_t now)
{
	struct thermometer *chip = thermometer_of(txn->device);

	if (chip->strict && !chip->early_ns && chip->converted_ns > now) {
		/* Near the end nobody knows which result it was, or whether it was a whole one. */
		bool likely = now >= thermometer_likely_ns(chip) && has_changed(chip, scratchpad);

		if (!is_whole(scratchpad) || !(is_held(chip, now) || likely))
			return txn_wait(txn, chip->converted_ns - now);
		if (likely) {
			chip->converted_ns = chip->busy_ns = now;
			chip->least_ns = chip->ended_ns;
			chip->longest_ns = 0;
		}
		return 0;
	}
	if (chip->early_ns && chip->converted_ns > now) {
		/* Whoever reads it meanwhile needs the proof, too. */
		if (!is_proven(txn->device, scratchpad))
			return txn_wait(txn, chip->converted_ns - now);
		chip->converted_ns = chip->busy_ns = chip->least_ns = chip->early_ns;
		chip->longest_ns = 0;
	}
	chip->early_ns = 0;
	return 0;
}

void thermometer_took(struct txn *txn, const uint8_t scratchpad[9], int64_t now)
{
	txn->measured_ns = latched_ns(txn, scratchpad, now);
	thermometer_of(txn->device)->raw_ns = now;
}
