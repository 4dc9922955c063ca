/* SPDX-License-Identifier: MIT */
/* What the simulated battery gauges and protectors with 256 addresses have in common. */
#pragma once

#include "hal/sim/slave.h"

enum { GAUGE_BLOCKS = 3, GAUGE_BLOCK = 32, GAUGE_RULES = 6 };
enum { STATUS = 0x01, VOLTAGE = 0x0C, CURRENT = 0x0E, ACCUMULATED = 0x10 };
enum { LOCK = 0x40, EEC = 0x80 }; /* EEPROM register; from bit 0 on a flag for each locked block */
enum { TEMPERATURE, VOLT, VIS, PIN, FLAGS }; /* inputs; from FLAGS on those of the kind */
enum { CHARGER = FLAGS - 1, FULL };          /* inputs of the DS2770, which has no pin */
enum { OT = 0x01, PSF = 0x80 };              /* special features of DS2720 and DS2760 (PSF alone) */
enum { DE = 0x01, CE = 0x02, DC = 0x04, CC = 0x08, DOC = 0x10, COC = 0x20, UV = 0x40, OV = 0x80 };
enum { CSTAT = 0xC0, CINI = 0x02 };            /* status of the DS2770 */
enum { PORF = 0x02, UVF = 0x04, UVTH = 0x08 }; /* status and control of DS2780, DS2781 */

/* Bits that the host writes, that it can only clear, that it can only set. */
struct gauge_rule {
	bool used;
	uint8_t first, last, write, clear, set;
};

struct gauge_kind {
	struct {
		uint8_t at, size;
	} block[GAUGE_BLOCKS]; /* size 0: none */
	struct gauge_rule rules[GAUGE_RULES];
	uint8_t eeprom;         /* the EEPROM register; 0: none */
	uint8_t defaults, from; /* bits of the status that come from the EEPROM at from */
	uint8_t special, pio;   /* register and bit of the pin; 0: none */
	uint8_t por;            /* a bit that a power-on sets in the register at por_at */
	uint8_t por_at;
	uint8_t celsius;    /* the temperature register; 0: none */
	uint8_t average;    /* the average current; 0: none */
	uint8_t bias;       /* of each current that is measured; 0: none */
	uint8_t accumbias;  /* of the accumulation alone; 0: none */
	bool wide_bias;     /* bias has two bytes */
	bool add_bias;      /* else it is subtracted */
	bool fine;          /* current in 16 bits of 1.5625 uV, else 13 bits of 15.625 uV */
	bool keeps;         /* the accumulated current survives */
	bool protects;      /* has a protection register at 0 */
	bool no_gauge;      /* it measures nothing: DS2720; its EEPROM is in one piece */
	uint8_t conditions; /* the first input of those that the protection follows */
	double volt;        /* unit of the voltage; 0: not measured */
};

struct gauge {
	const struct gauge_kind *kind;
	uint8_t memory[256], latched[256], eeprom[GAUGE_BLOCKS][GAUGE_BLOCK];
	uint8_t copied; /* the block that is being copied */
	bool low;       /* the pin's output conducts */
	bool charging, full;
	double accumulated;    /* mV * ns */
	int64_t last, started; /* since when accumulated; when the elapsed time was 0 */
};

void sim_gauge_power_on(struct sim_slave *slave);
void sim_gauge_begun(struct sim_slave *slave);
void sim_gauge_advance(struct sim_slave *slave);
void sim_gauge_worked(struct sim_slave *slave);
extern const struct sim_function sim_gauge_functions[], sim_ds2740_functions[],
	sim_ds2770_functions[];
