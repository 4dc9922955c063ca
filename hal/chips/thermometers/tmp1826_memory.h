/* SPDX-License-Identifier: MIT */
/* TMP1826 and TMP1827: the EEPROM. */
#pragma once

#include "hal/chips/area.h"

/* 256 bytes. -EOPNOTSUPP: the link makes no pause within a transaction (txn_write_paused). */
extern const struct area tmp1826_memory;
