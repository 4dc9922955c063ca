/* SPDX-License-Identifier: MIT */
/*
 * DS2408 (data sheet 19-5702): its registers, and what displays that stand on one need. What
 * stands first here holds for a DS28E04 too, whose registers are the same.
 */
#pragma once

#include "hal/chips/area.h"

/* The registers from 0x88 on. */
enum {
	DS2408_PIN,
	DS2408_OUTPUT,
	DS2408_ACTIVITY,
	DS2408_MASK,
	DS2408_POLARITY,
	DS2408_CONTROL,
	DS2408_REGISTERS = 8
};

/* Bits of the control register. */
enum { DS2408_SOURCE, DS2408_STROBE = 2 /* ROS */, DS2408_POR, DS2408_VCC = 7 };
#define DS2408_CONTROL_SOURCE 0x03

/* What is known of the chip (device.own); of a DS28E04 too. */
struct ds2408 {
	bool por_clear;  /* the power-on flag has been seen clear */
	uint8_t display; /* enum lcd_board: which one has been set up */
};

#define DS2408_SETTINGS 0x07 /* of the control register */
#define DS2408_CONFIRMED 0xaa

/* Notes what the control register says of the chip: a restart, its supply. */
void ds2408_saw_control(struct txn *txn, uint8_t value);
/* area.is_written of mask, polarity and control. */
bool ds2408_condition_is_written(struct txn *txn, const uint8_t *have, const uint8_t *want,
                                 unsigned n);
/* For properties: whatever is written, the activity latches are cleared. */
int ds2408_write_latch(struct txn *txn);
/*
 * Mask, polarity and control as digits: one for each of n pins, 2 selected + 1 high; before them
 * the source.
 */
double ds2408_digits(const uint8_t condition[3], unsigned n);
void ds2408_condition_of(double number, unsigned n, uint8_t condition[3]);

/* All registers are read; the outputs, and mask, polarity and control, are written. */
extern const struct area ds2408_registers, ds2408_output, ds2408_condition;

/* The way out of the test mode in which a slow supply can leave the chip (data sheet, page 39). */
int ds2408_leave_test_mode(struct txn *txn);
/* The strobe is switched on; several calls if it is not: TXN_MORE says that it was off. */
int ds2408_strobe(struct txn *txn);
/* Bytes for the outputs, in one transaction. */
int ds2408_put(struct txn *txn, const uint8_t *bytes, unsigned n);
