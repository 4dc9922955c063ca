/* SPDX-License-Identifier: MIT */
/* The thermometers, and the conversion of all of a master's at once. */
#pragma once

#include "hal/w1/part.h"

extern const struct w1_driver w1_thermometers[];

struct w1_bulk {
	unsigned number;    /* of w1_bus_masterN */
	uint8_t channel;    /* of its slaves */
	bool searched;      /* its first search is over */
	int64_t refused_ns; /* therm_bulk_read was refused: not before */
};

/* Convert all on the master's wire; returns when it is over. */
void w1_convert_all(struct w1_slaves *slaves, struct w1_bulk *bulk);
/* When its alarm is asked for, a thermometer converts: what is known of it is too old. */
bool w1_alarm_converts(const struct w1_slave *slave);
