/* SPDX-License-Identifier: MIT */
/*
 * Before and at the beginning of a chip's operations: is the chip still ours, and is its channel
 * that of the link? By the data sheets of the DS2482. Each call takes at most a few I2C
 * transfers, and waits until the chip's last operation has ended.
 */
#include <errno.h>

#include "hal/ds2482/detect.h"
#include "hal/ds2482/ds2482.h"
#include "hal/ds2482/io.h"
#include "hal/ds2482/run.h"
#include "hal/ds2482/select.h"

#define CLAIM_NS (250 * NS_PER_MS)

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

	if (!chip->master->adapter)
		return -ENODEV;
	if (chip->lost)
		return -ENXIO;
	if (chip->channel == link->number)
		return 0;
	int err = select_channel(chip, link->number);
	/* a strong pull-up belongs to the channel it was armed for; the chip ends it by itself */
	if (!err)
		err = ds2482_end_strong(chip);
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

int ds2482_end_strong(struct ds2482_chip *chip)
{
	return chip->config & DS2482_SPU
	               ? ds2482_configure(chip, (uint8_t)(chip->config & ~DS2482_SPU))
	               : 0;
}

void ds2482_began(struct ds2482_chip *chip)
{
	chip->config &= (uint8_t)~DS2482_SPU;
}

int ds2482_presence(struct ds2482_link *link, int status)
{
	link->cost.resets++;
	link->cost.wire_ns += (uint64_t)ds2482_reset_ns;
	if (status & DS2482_SD)
		return -ECOMM;
	if (status & DS2482_PPD)
		return 0;
	return status & DS2482_LL ? -EHOSTDOWN : -ECOMM;
}
