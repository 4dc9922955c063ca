/* SPDX-License-Identifier: MIT */
/* The nine bytes of a thermometer's scratchpad. */
#pragma once

enum { SP_LSB, SP_MSB, SP_HIGH, SP_LOW, SP_CONFIG, SP_5, SP_REMAIN, SP_PER_DEGREE, SP_CRC };
