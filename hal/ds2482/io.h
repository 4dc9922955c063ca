/* SPDX-License-Identifier: MIT */
/*
 * Single I2C calls to a chip, and what the adapter can do and how fast it is, found by trying it.
 */
#pragma once

#include <stdbool.h>
#include <stdint.h>

/* Of one message, and of one transfer if the adapter takes so many (ds2482_room()). */
#define DS2482_MAX_BYTES 180
#define DS2482_MAX_MESSAGES 42

struct ds2482_chip;
struct ds2482_master;

int64_t ds2482_now(const struct ds2482_master *master);
/* 0, -ECANCELED. */
int ds2482_wait_until(const struct ds2482_master *master, int64_t t);
int ds2482_wait(const struct ds2482_master *master, int64_t ns);
int ds2482_write1(struct ds2482_chip *chip, uint8_t command);
int ds2482_write2(struct ds2482_chip *chip, uint8_t command, uint8_t parameter);
/* Read the register at the read pointer. */
int ds2482_read1(struct ds2482_chip *chip);
/* Write command and parameter, and read the register to which the chip then points. */
int ds2482_write_read(struct ds2482_chip *chip, uint8_t command, uint8_t parameter);
/* Can the adapter do more than the SMBus calls? */
bool ds2482_combines(const struct ds2482_chip *chip);
unsigned ds2482_room(const struct ds2482_chip *chip);
/*
 * Try what the adapter takes in one transfer, and measure how long an I2C byte takes at least, for
 * reading on instead of waiting. There has to be a chip, and it has to be idle.
 */
int ds2482_learn(struct ds2482_chip *chip);
/* The time that passes between two messages of a transfer, by the adapter's doing; 0: none. */
int64_t ds2482_between(const struct ds2482_chip *chip);
/* Report that a command came too early, after another one: messages come faster than measured. */
void ds2482_was_refused(struct ds2482_chip *chip);
/*
 * Report that the chip was still busy after reading on: messages or bytes come faster than
 * measured.
 */
void ds2482_was_early(struct ds2482_chip *chip);
