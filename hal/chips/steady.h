/* SPDX-License-Identifier: MIT */
/* Bytes without a checksum that may change by themselves, such as those of a clock. */
#pragma once

#include "hal/wire/txn.h"

/*
 * Of an area's load, which has read these n bytes (STEADY_MOST at most): 0 when AREA_LOOKS reads in
 * a row gave the same, and, of a chip that was asked for, twice as many of nothing but ones;
 * TXN_MORE: read again. -EBADMSG: they never are the same. It keeps what it knows in txn_own().
 */
#define STEADY_MOST 8
int steady(struct txn *txn, const uint8_t *bytes, unsigned n);

/* The load of a clock: byte 0 is a control byte or, where there is an address, a fraction. */
int steady_clock_load(struct txn *txn, const struct area *area, unsigned at, uint8_t *bytes,
                      unsigned n);
/* It is written, if the clock has gone on for no more than two seconds since. */
bool steady_clock_is_written(struct txn *txn, const uint8_t *have, const uint8_t *want, unsigned n);
