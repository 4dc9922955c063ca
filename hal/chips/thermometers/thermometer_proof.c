/* SPDX-License-Identifier: MIT */
/* When the result that a thermometer holds was taken, and what proves that it is a new one. */
#include <errno.h>
#include <string.h>

#include "hal/chips/family.h"
#include "hal/chips/thermometers/state.h"
#include "hal/chips/thermometers/thermometer_proof.h"

#define LONGEST_NS (750 * TXN_MS)
#define FULL_BITS 12
/* What a chip that cannot show its conversions was proven to hold counts for that long. */
#define PROVEN_NS (5000 * TXN_MS)

struct thermometer_last thermometer_last(const struct device *device)
{
	const struct thermometer *chip = thermometer_of(device);

	return (struct thermometer_last){
		.ends_ns = chip->converted_ns,
		.busy_ns = chip->busy_ns,
		.missed = chip->unheard,
		.was_read = chip->raw_ns >= chip->converted_ns,
		.unread = chip->unread_ns == chip->converted_ns,
		.cut = chip->least_ns < chip->converted_ns,
		.can_prove = chip->shows && chip->proves && !chip->unseen,
	};
}

void thermometer_showed(struct device *device, bool for_all)
{
	struct thermometer *chip = device->own;

	chip->shows = true;
	if (!for_all)
		chip->unheard = 0;
}

void thermometer_missed(struct device *device)
{
	thermometer_of(device)->unheard++;
}

void thermometer_unread(struct device *device, bool yes)
{
	struct thermometer *chip = device->own;

	chip->unread_ns = yes ? chip->converted_ns : 0;
}

void thermometer_seems_over(struct device *device, int64_t now)
{
	thermometer_of(device)->early_ns = now;
}

/* Nothing else says when the last conversion ends or ended. */
static void set_end(struct thermometer *chip, int64_t ns, int64_t longest)
{
	chip->converted_ns = ns;
	chip->longest_ns = (int32_t)longest;
	chip->early_ns = 0;
}

void thermometer_void(struct device *device)
{
	set_end(device->own, 0, 0);
}

/*
 * As the data sheet says, but for clones of the DS18B20 (family_28.c): family D2 takes 523 ms at
 * each resolution, H 101 ms for 9 bits.
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

/*
 * When no conversion ends earlier that it may be at work with, once it has heard: what it may have
 * begun before goes on, if it ignores this; it ends when it is not busy now.
 */
static int64_t least_ns(const struct thermometer *chip, int64_t now, int64_t longest)
{
	if (now >= chip->busy_ns)
		return now + longest;
	return now > chip->least_ns ? now : chip->least_ns;
}

static void thermometer_proof_send(struct thermometer *chip, int64_t now, int64_t longest)
{
	if (!chip->since_ns)
		chip->since_ns = least_ns(chip, now, longest);
	if (chip->busy_ns < now + longest)
		chip->busy_ns = now + longest;
}

/* If it has not heard, what it holds may be of one that it was at work with before. */
void thermometer_told(struct device *device, int64_t now, int64_t longest)
{
	thermometer_proof_send(device->own, now, longest);
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
	chip->least_ns = least_ns(chip, now, longest);
	thermometer_proof_send(chip, now, longest);
	set_end(chip, now + longest, longest);
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

/* The bits below the resolution, which a result at it has not. */
static uint8_t below(unsigned resolution)
{
	return (uint8_t)((1 << (FULL_BITS - resolution)) - 1);
}

static bool is_adjustable(const struct device *device)
{
	const struct thermometer *chip = thermometer_of(device);

	return !device->family->fixed && !chip->ignores && !chip->only_12 && chip->resolution;
}

bool thermometer_marks(const struct device *device)
{
	const struct thermometer *chip = thermometer_of(device);

	return is_adjustable(device) && chip->raw_ns &&
	       (chip->latched[0] & below(THERMOMETER_MARK) & ~below(chip->resolution));
}

/*
 * Nothing shows that it converted, and it holds what was read last. Did it convert at fewer bits
 * than that has, it would hold something else; at more bits it may hold what is too coarse, but for
 * the second time at the most.
 */
static void compare_bits(struct txn *txn)
{
	struct thermometer *chip = thermometer_of(txn->device);
	uint8_t was = chip->latched_bits;

	chip->coarse = false;
	if (!is_adjustable(txn->device))
		return;
	if (txn->unproven && was > chip->resolution)
		txn->unheard = chip->latched[0] & below(chip->resolution) & ~below(was);
	chip->coarse = txn->unproven && was && was < chip->resolution;
	if (!txn->unheard)
		chip->latched_bits = chip->resolution;
}

/*
 * When the chip latched what it holds. While the strong pull-up is on, no chip can show that it
 * converts. If it holds something else than when it was read last, and converted once since, it
 * did; if it converted more often, it made one of these, and may have missed all but the first. If
 * it holds the same, this is what was proven to be its result before. Where nothing can be made to
 * differ (thermometer_marks()), it is taken for the result of the conversion before the last.
 */
static int64_t latched_ns(struct txn *txn, const uint8_t scratchpad[9], int64_t now)
{
	struct device *device = txn->device;
	const uint8_t holds[3] = {scratchpad[SP_LSB], scratchpad[SP_MSB], scratchpad[SP_REMAIN]};
	struct thermometer *chip = thermometer_of(device);
	bool changed = chip->raw_ns && memcmp(chip->latched, holds, sizeof(holds)) != 0;

	memcpy(chip->latched, holds, sizeof(holds));
	txn->unproven = chip->unseen && !(changed && chip->since_ns == chip->least_ns);
	compare_bits(txn);
	int64_t when = ended_ns(device);
	if (txn->unproven && (changed || thermometer_marks(device)))
		when = changed ? chip->since_ns : 0;
	else if (txn->unproven)
		when = chip->earlier_ns;
	/* It never becomes older than it was. */
	if (when > chip->latched_ns && when < now)
		chip->latched_ns = when;
	return chip->latched_ns;
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

int thermometer_ended(struct txn *txn, const uint8_t scratchpad[9], int64_t now)
{
	struct thermometer *chip = thermometer_of(txn->device);

	if (chip->early_ns && chip->converted_ns > now) {
		/* Whoever reads it meanwhile needs the proof, too. */
		if (!is_proven(txn->device, scratchpad))
			return txn_wait(txn, chip->converted_ns - now);
		chip->busy_ns = chip->least_ns = chip->early_ns;
		set_end(chip, chip->early_ns, 0);
	}
	chip->early_ns = 0;
	return 0;
}

int thermometer_took(struct txn *txn, const uint8_t scratchpad[9], int64_t now)
{
	struct thermometer *chip = thermometer_of(txn->device);

	txn->measured_ns = latched_ns(txn, scratchpad, now);
	chip->raw_ns = now;
	/* One that it is still at work with may change what it holds. */
	if (chip->busy_ns <= now)
		chip->since_ns = 0;
	return txn->measured_ns > 0 || txn->property->convert ? 0 : -EIO;
}

bool thermometer_doubtful(const struct txn *txn, bool fresh)
{
	const struct thermometer *chip = thermometer_of(txn->device);

	return txn->unproven && (fresh || !chip->earlier_ns || chip->coarse || !chip->latched_ns ||
	                         chip->latched_ns + PROVEN_NS < txn_now(txn));
}
