/* SPDX-License-Identifier: MIT */
/*
 * DS1921: conversions, settings, clock and missions. A write to the registers ends a mission, so it
 * is refused (-EBUSY) while one runs.
 */
#pragma once

#include "hal/wire/txn.h"

int ds1921_read_temperature(struct txn *txn);
int ds1921_write_field(struct txn *txn);
int ds1921_write_limit(struct txn *txn);
int ds1921_write_trigger(struct txn *txn);
int ds1921_write_status(struct txn *txn);
int ds1921_write_flag(struct txn *txn);
int ds1921_write_date(struct txn *txn);
int ds1921_write_udate(struct txn *txn);
int ds1921_clear_memory(struct txn *txn);
int ds1921_write_frequency(struct txn *txn);
int ds1921_write_running(struct txn *txn);
int ds1921_write_easystart(struct txn *txn);
