/* SPDX-License-Identifier: MIT */
/*
 * Detects a chip. Other parts use 0x18 to 0x1F too (thermometers, accelerometers), and would take a
 * second byte for the value of a register. So a chip has to prove itself by single-byte commands
 * first.
 */
#include <errno.h>

#include "hal/base/time.h"
#include "hal/ds2482/codes.h"
#include "hal/ds2482/detect.h"
#include "hal/ds2482/ds2482.h"
#include "hal/ds2482/io.h"
#include "hal/ds2482/run.h"

#define SETTLE_NS NS_PER_MS /* a device reset takes 0.5 us */
#define BUSY_NS (5 * NS_PER_MS)
#define TRIES 3

static bool just_reset(int status)
{
	return status >= 0 && (status & ~DS2482_LL) == DS2482_RST;
}

static int device_reset(struct ds2482_chip *chip)
{
	int err = ds2482_write1(chip, DS2482_DEVICE_RESET);

	if (!err)
		err = ds2482_wait(chip->master, SETTLE_NS);
	if (err)
		return err;
	chip->channel = chip->config = 0;
	chip->free_at = 0;
	return ds2482_read1(chip);
}

/*
 * After a 1-Wire reset a chip may be busy, then it is idle, and it never shows the bits of other
 * commands. Only a status read after the deadline proves that the chip stays busy: the scheduler
 * may have kept this thread from running.
 */
static int prove(struct ds2482_chip *chip)
{
	int status = ds2482_write1(chip, DS2482_RESET);
	int64_t until = ds2482_now(chip->master) + BUSY_NS;
	bool late;

	if (status)
		return status;
	do {
		int err;

		late = ds2482_now(chip->master) >= until;
		status = ds2482_read1(chip);
		if (status < 0)
			return status;
		if ((status & (DS2482_SBR | DS2482_TSB | DS2482_DIR)) || !(status & DS2482_RST))
			return -ENXIO;
		if (!(status & DS2482_1WB))
			return 0;
		err = ds2482_wait(chip->master, SETTLE_NS / 4);
		if (err)
			return err;
	} while (!late);
	return -ETIMEDOUT;
}

/* 0, or that the chip refuses to point there, which noise can look like; else an error. */
static int point_at(struct ds2482_chip *chip, uint8_t pointer)
{
	int err = -ENXIO;

	for (unsigned i = 0; i < TRIES && ds2482_is_refused(err); i++)
		err = ds2482_write2(chip, DS2482_READ_POINTER, pointer);
	return err;
}

static int find_part(struct ds2482_chip *chip)
{
	int err = point_at(chip, DS2482_AT_CHANNEL);

	chip->part = DS2482_800;
	if (ds2482_is_refused(err)) {
		chip->part = DS2482_ADJUSTABLE;
		err = point_at(chip, DS2482_AT_PORT);
	}
	if (ds2482_is_refused(err)) {
		chip->part = DS2482_100;
		err = 0;
	}
	chip->channels = chip->part == DS2482_800 ? 8 : 1;
	return err;
}

int ds2482_detect(struct ds2482_chip *chip)
{
	int status = -ENXIO;

	for (unsigned i = 0; i < TRIES && ds2482_is_refused(status); i++)
		status = device_reset(chip);
	if (status < 0)
		return status;
	if (!just_reset(status) || !just_reset(ds2482_read1(chip)))
		return -ENXIO;
	chip->answered = true;
	status = prove(chip);
	if (status)
		return status;
	status = device_reset(chip);
	if (!just_reset(status))
		return status < 0 ? status : -ENXIO;
	return find_part(chip);
}

int ds2482_configure(struct ds2482_chip *chip, uint8_t config)
{
	uint8_t with_complement = (uint8_t)(config | (~config & 15) << 4);
	int err = ds2482_wait_until(chip->master, chip->free_at);
	int back;

	if (err)
		return err;
	back = ds2482_write_read(chip, DS2482_WRITE_CONFIG, with_complement);
	if (back < 0)
		return ds2482_diagnose(chip, back);
	if (back != config) {
		chip->lost = true;
		return -ENXIO;
	}
	chip->config = config;
	return 0;
}

int ds2482_setup(struct ds2482_chip *chip)
{
	int status = -EIO, err;

	for (unsigned i = 0; i < TRIES && ds2482_is_refused(status); i++)
		status = device_reset(chip);
	if (status < 0)
		return ds2482_is_refused(status) ? -EIO : status;
	if (status & DS2482_1WB)
		return -ETIMEDOUT;
	if (!just_reset(status))
		return -EIO;
	chip->lost = false;
	err = ds2482_learn(chip);
	if (err)
		return err;
	return ds2482_configure(chip, chip->master->active_pullup ? DS2482_APU : 0);
}
