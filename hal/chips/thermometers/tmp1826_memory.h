/* SPDX-License-Identifier: MIT */
/* TMP1826 and TMP1827: the EEPROM. */
#ifndef HAL_CHIPS_TMP1826_MEMORY_H
#define HAL_CHIPS_TMP1826_MEMORY_H

#include "hal/chips/area.h"

/* 256 bytes. -EOPNOTSUPP: the link makes no pause within a transaction (txn_write_paused). */
extern const struct area tmp1826_memory;

#endif
