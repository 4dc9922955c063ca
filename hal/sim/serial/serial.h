/* SPDX-License-Identifier: MIT */
/*
 * A simulated serial adapter at the level of its bytes, on channel 0 of the first chip of a
 * simulated network: the DS2480B (DS9097U, LINK) by its data sheet (Maxim 19-5047), or a passive
 * adapter (DS9097) by Maxim's application note 214. Bytes take their time on the line in both
 * directions; what the host sends faster than the DS2480B carries it out is lost, and counted.
 *
 * now is ns of the clock of the network (net.h), and never goes back.
 *
 * Room hal/sim/serial: simulated serial adapters, for tests alone.
 */
#pragma once

#include "hal/sim/net.h"

enum sim_serial_kind { SIM_DS2480B, SIM_PASSIVE };

#define SIM_SERIAL_ANSWERS 8192
struct sim_serial {
	enum sim_serial_kind kind;
	struct sim_net *net;
	bool silent;         /* takes bytes and does nothing, as a chip without supply */
	uint32_t noise_each; /* of each n-th answer a bit is turned; 0: of none */
	uint64_t overruns;   /* bytes that were lost: the buffer was full */
	uint64_t bytes;      /* of the host */
	uint64_t master_resets;

	/* The line: when the last byte of each direction ends, and the answers on their way. */
	int64_t sent_at, answered_at;
	struct sim_serial_answer {
		int64_t at; /* its stop bit */
		uint32_t baud;
		uint8_t byte;
	} answer[SIM_SERIAL_ANSWERS];
	unsigned first, answers;
	uint64_t answered;

	/* The DS2480B. */
	uint32_t baud;
	bool data_mode, escaped; /* the byte before was E3 in data mode */
	bool search, lost;       /* the accelerator is on; its path ended without an answer */
	uint8_t speed; /* of the last reset, bit or search: 0 regular, 1 flexible, 2 overdrive */
	bool armed;    /* a strong pull-up follows each byte of the data mode */
	bool pulse;    /* one without end: only F1 is heard */
	uint8_t pulse_answer;
	uint8_t parameter[8];
	/* It is carried out from its start to its end, another one may wait meanwhile. */
	int64_t start, end;
};
