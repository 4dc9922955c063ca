/* SPDX-License-Identifier: MIT */
/*
 * A simulated network: an I2C adapter with bridge chips, their wires and slaves, and the events
 * that happen to them. hal/sim/scenario.h makes one from a file.
 *
 * now is ns on any clock that never goes back; the simulation starts with the first call. What
 * lies between two calls is jumped over.
 *
 * Room hal/sim: a simulated I2C adapter, DS2482 and wires, in owsd-sim alone.
 */
#pragma once

#include "hal/sim/chip.h"

enum sim_what {
	SIM_SET,         /* a new curve for an input */
	SIM_PLUG,        /* a slave comes, or goes (on = false) */
	SIM_BROWNOUT,    /* a slave restarts */
	SIM_CORRUPT,     /* a slave's answers: corrupt_every, corrupt_probability, seed */
	SIM_SHORT,       /* a wire is short, or free again */
	SIM_STICK,       /* a chip's 1WB stays set until a device reset */
	SIM_JAM,         /* the same whatever the host does, until it is over */
	SIM_CHIP_RESET,  /* a chip restarts */
	SIM_CHIP_SLEEP,  /* a chip is deaf, as with its SLPZ pin low */
	SIM_REFUSE,      /* a chip's address is refused: each time, or each n-th */
	SIM_REFUSE_DATA, /* the same for bytes to the chip */
	SIM_ADAPTER,     /* the adapter is plugged in, or gone */
};

struct sim_event {
	int64_t at_ns, every_ns; /* again after every_ns; 0: once */
	bool done;
	enum sim_what what;
	bool on;
	unsigned chip, channel;
	struct sim_slave *slave;
	unsigned input;
	struct sim_curve curve; /* start_ns counts from the event */
	uint32_t each;
	double probability;
	uint64_t seed;
};

/* An event on demand (button.h). */
#define SIM_BUTTON_NAME 32
#define SIM_MAX_BUTTONS 16
struct sim_button {
	char name[SIM_BUTTON_NAME];
	struct sim_event event;
};

/* As enum i2c_combine. */
enum sim_combine { SIM_SMBUS_ONLY, SIM_ONE_READ_LAST, SIM_ANY_MESSAGES };

#define SIM_MAX_CHIPS 8
struct sim_net {
	uint32_t hz;
	enum sim_combine combine;
	unsigned max_messages;
	bool plugged; /* the adapter is plugged in */
	unsigned chips;
	struct sim_chip chip[SIM_MAX_CHIPS];
	struct sim_event *event;
	size_t events;
	struct sim_button button[SIM_MAX_BUTTONS];
	unsigned buttons;

	bool started;
	int64_t epoch, time; /* the start on the host's clock; the latest time, ns since then */
	struct sim_chip *selected;
	struct refusal {
		uint32_t each, count; /* each n-th is refused; 0: none */
	} refuse_address[SIM_MAX_CHIPS], refuse_data[SIM_MAX_CHIPS];
};

void sim_net_init(struct sim_net *net);
void sim_net_clear(struct sim_net *net);
/* Add a chip. 0, -ENOSPC, -EEXIST: the address is taken. */
int sim_net_add_chip(struct sim_net *net, enum sim_part part, uint8_t address);
/* 0 or -ENOMEM; the net owns the slave from then on. */
int sim_net_add_slave(struct sim_net *net, unsigned chip, unsigned channel,
                      struct sim_slave *slave);
int sim_net_add_event(struct sim_net *net, const struct sim_event *event);
struct sim_slave *sim_net_slave(const struct sim_net *net, const char *name);

/* Power everything on; without this call the first call below does it. */
void sim_net_start(struct sim_net *net, int64_t now);
/*
 * Carry out all events that are due. Of repeating events that were due more than SIM_CATCH_UP times
 * in all since the last call, only the last times are carried out.
 */
#define SIM_CATCH_UP 100000
void sim_net_run(struct sim_net *net, int64_t now);
/* Carry out an event at once, whatever its own time is. Allocates nothing. */
void sim_net_apply(struct sim_net *net, const struct sim_event *event);
/*
 * Is there now what an event that a button may hold (event.h) begins, by that event or by another?
 */
bool sim_net_lasts(const struct sim_net *net, const struct sim_event *event);
/* When the next event is due on the host's clock; INT64_MAX: never. */
int64_t sim_net_next(const struct sim_net *net);

/* I2C, byte by byte; now: the time of the acknowledge bit. */
bool sim_i2c_start(struct sim_net *net, uint8_t address, bool read, int64_t now);
bool sim_i2c_write(struct sim_net *net, uint8_t byte, int64_t now);
/* now: the time when the byte begins. */
uint8_t sim_i2c_read(struct sim_net *net, int64_t now);
