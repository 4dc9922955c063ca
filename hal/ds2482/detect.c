/* SPDX-License-Identifier: MIT */
/*
 * Detects a chip. Other parts use 0x18 to 0x1F too (thermometers, accelerometers), and would take a
 * second byte for the value of a register. So a chip has to prove itself by single-byte commands
 * first.
 */
#include <errno.h>

#include "hal/bus/time.h"
#include "hal/ds2482/codes.h"
#include "hal/ds2482/detect.h"
#include "hal/ds2482/ds2482.h"
#include "hal/ds2482/io.h"
#include "hal/ds2482/run.h"
#include "hal/wire/link.h"

#define SETTLE_NS NS_PER_MS /* a device reset takes 0.5 us */
#define BUSY_NS (5 * NS_PER_MS)
#define TRIES 2
#define CLAIM_NS (250 * NS_PER_MS)

static bool just_reset(int status)
{
	return status >= 0 && (status & ~DS2482_LL) == DS2482_RST;
}

static int device_reset(struct ds2482_chip *chip)
{
	int err = ds2482_write1(chip, DS2482_DEVICE_RESET);

	if (!err)
		err = ds2482_wait_until(chip->master, ds2482_now(chip->master) + SETTLE_NS);
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
		err = ds2482_wait_until(chip->master, ds2482_now(chip->master) + SETTLE_NS / 4);
		if (err)
			return err;
	} while (!late);
	return -ETIMEDOUT;
}

static int find_part(struct ds2482_chip *chip)
{
	if (ds2482_write2(chip, DS2482_READ_POINTER, DS2482_AT_CHANNEL) == 0)
		chip->part = DS2482_800;
	else if (ds2482_write2(chip, DS2482_READ_POINTER, DS2482_AT_PORT) == 0)
		chip->part = DS2482_ADJUSTABLE;
	else
		chip->part = DS2482_100;
	chip->channels = chip->part == DS2482_800 ? 8 : 1;
	return 0;
}

static bool passing(int err)
{
	return err == -EIO || err == -ENXIO;
}

int ds2482_detect(struct ds2482_chip *chip)
{
	int status = -ENXIO;

	for (unsigned i = 0; i < TRIES && passing(status); i++)
		status = device_reset(chip);
	if (status < 0)
		return status;
	if (!just_reset(status) || !just_reset(ds2482_read1(chip)))
		return -ENXIO;
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

	for (unsigned i = 0; i < TRIES && passing(status); i++)
		status = device_reset(chip);
	if (status < 0)
		return passing(status) ? -EIO : status;
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

/* The codes that select a channel, and those that the chip returns, by the data sheet's table. */
static int select_channel(struct ds2482_chip *chip, uint8_t channel)
{
	static const uint8_t readback[8] = {0xB8, 0xB1, 0xAA, 0xA3, 0x9C, 0x95, 0x8E, 0x87};
	int err = ds2482_wait_until(chip->master, chip->free_at);
	int back;

	if (err)
		return err;
	back = ds2482_write_read(chip, DS2482_CHANNEL, (uint8_t)((15 - channel) << 4 | channel));
	if (back < 0)
		return ds2482_diagnose(chip, back);
	if (back != readback[channel]) {
		chip->lost = true;
		return -ENXIO;
	}
	chip->channel = channel;
	return 0;
}

int ds2482_select(struct ds2482_link *link)
{
	struct ds2482_chip *chip = link->chip;
	uint8_t config = chip->config;
	int err = 0;

	if (!chip->master->adapter)
		return -ENODEV;
	if (chip->lost)
		return -ENXIO;
	config &= (uint8_t) ~(DS2482_1WS | DS2482_SPU);
	if (link->speed == LINK_OVERDRIVE)
		config |= DS2482_1WS;
	/* a strong pull-up belongs to the channel it was armed for; the chip ends it by itself */
	if (chip->channel != link->number) {
		err = select_channel(chip, link->number);
		if (!err && (chip->config & DS2482_SPU))
			err = ds2482_configure(chip, config);
	}
	if (!err && ((chip->config ^ config) & DS2482_1WS))
		err = ds2482_configure(chip, config);
	return err;
}

/*
 * A kernel driver may be bound to the chip while owsd uses it. The chip does not show that, because
 * the driver's reset and configuration leave it as owsd's do. So owsd asks the kernel.
 */
bool ds2482_claimed(struct ds2482_chip *chip)
{
	struct i2c_adapter *adapter = chip->master->adapter;
	int64_t now = ds2482_now(chip->master);

	if (!adapter || now < chip->claim_ns)
		return true;
	chip->claim_ns = now + CLAIM_NS;
	if (adapter->ops->claim(adapter, chip->address) == -EBUSY)
		chip->lost = true;
	return !chip->lost;
}

void ds2482_began(struct ds2482_chip *chip)
{
	chip->config &= (uint8_t)~DS2482_SPU;
}
