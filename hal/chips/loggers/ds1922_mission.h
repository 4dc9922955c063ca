/* SPDX-License-Identifier: MIT */
/*
 * DS1922, DS1923, DS2422: conversions, settings, clock and missions. While a mission runs its
 * settings cannot be written (-EBUSY).
 */
#pragma once

#include "hal/wire/txn.h"

int ds1922_read_now(struct txn *txn);
int ds1922_write_page(struct txn *txn);
int ds1922_write_field(struct txn *txn);
int ds1922_write_date(struct txn *txn);
int ds1922_write_udate(struct txn *txn);
int ds1922_write_interval(struct txn *txn);
int ds1922_write_running(struct txn *txn);
