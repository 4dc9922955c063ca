/* SPDX-License-Identifier: MIT */
/* What `errata` of a thermometer with a nine-byte scratchpad has. */
#pragma once

#include "hal/chips/family.h"

int thermometer_read_die(struct txn *txn);
int thermometer_read_trim(struct txn *txn);
int thermometer_refuse_trim(struct txn *txn);
int thermometer_read_trim_valid(struct txn *txn);
int thermometer_read_trim_blanket(struct txn *txn);
