/* SPDX-License-Identifier: MIT */
/*
 * Inside the driver: single I2C calls to a chip (io.c), whole 1-Wire operations (run.c), finding
 * and setting up a chip (detect.c), the links (link.c), GPIO lines beside the chips (power.c).
 *
 * Errors as hal/wire/link.h, but io.c gives those of hal/ds2482/i2c.h.
 */
#ifndef HAL_DS2482_CHIP_H
#define HAL_DS2482_CHIP_H

#include "hal/ds2482/ds2482.h"

/* --- io.c --- */
int64_t ds2482_now(const struct ds2482_master *master);
/* 0, -ECANCELED. */
int ds2482_wait_until(const struct ds2482_master *master, int64_t t);
int ds2482_write1(struct ds2482_chip *chip, uint8_t command);
int ds2482_write2(struct ds2482_chip *chip, uint8_t command, uint8_t parameter);
/* The register the read pointer is at. */
int ds2482_read1(struct ds2482_chip *chip);
/* Write command and parameter, read what the chip then points to. */
int ds2482_write_read(struct ds2482_chip *chip, uint8_t command, uint8_t parameter);
/* Can the adapter do more than the SMBus calls? */
bool ds2482_combines(const struct ds2482_chip *chip);
/*
 * What the adapter takes in one transfer, by trying it, and how long an I2C byte takes at least:
 * for reading on instead of waiting. The chip is to be one for certain, and idle.
 */
int ds2482_learn(struct ds2482_chip *chip);
/* The chip was still busy where reading on should have ended: bytes come faster than measured. */
void ds2482_was_early(struct ds2482_chip *chip);

/* --- run.c --- */
#define DS2482_NO_PARAMETER (-1)
/* One operation of max_ns at most, to its end. The status, or negative. */
int ds2482_run(struct ds2482_chip *chip, uint8_t command, int parameter, long max_ns);
int ds2482_write_block(struct ds2482_chip *chip, const uint8_t *data, size_t n, long max_ns);
int ds2482_read_block(struct ds2482_chip *chip, uint8_t *data, size_t n, long max_ns);
/* Why did it fail with err? -ETIMEDOUT busy for ever, -ENXIO it was reset, -ENODEV, -EIO. */
int ds2482_diagnose(struct ds2482_chip *chip, int err);

/* --- detect.c --- */
/* Is a chip at chip->address? Finds its part and resets it. 0, -ENXIO nothing or another part. */
int ds2482_detect(struct ds2482_chip *chip);
/* Device reset and configuration. */
int ds2482_setup(struct ds2482_chip *chip);
/* Written, with its complement, and read back. */
int ds2482_configure(struct ds2482_chip *chip, uint8_t config);
/* Make the link's channel and speed the chip's. */
int ds2482_select(struct ds2482_link *link);

/* --- power.c --- */
/* How long a wire is without supply so that all slaves forget what they knew. */
#define DS2482_POWER_OFF_NS INT64_C(500000000)
#define DS2482_POWER_ON_NS INT64_C(10000000)
/* Supply on and chips awake, as far as there are lines for it. Errors as gpio_output_take(). */
int ds2482_power_on(struct ds2482_master *master, char *why, size_t why_size);
/* The chips go to sleep; the supply stays on. */
void ds2482_rest(struct ds2482_master *master);
void ds2482_power_release(struct ds2482_master *master);
/* The supply off and on, then all chips are set up. -EOPNOTSUPP: no line for it. */
int ds2482_power_cycle(struct ds2482_master *master);

/* --- link.c --- */
void ds2482_link_init(struct ds2482_chip *chip, unsigned number);

#endif
