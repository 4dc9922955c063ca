/* SPDX-License-Identifier: MIT */
/*
 * A simulated 1-Wire slave: the ROM layer that all have in common, bit by bit, and the table by
 * which a family adds its functions, byte by byte.
 *
 * t is ns since the start of the simulation; it never goes back for one slave.
 */
#ifndef HAL_SIM_SLAVE_H
#define HAL_SIM_SLAVE_H

#include <stdbool.h>

#include "hal/sim/curve.h"

struct sim_slave;

/* A quantity that the slave measures or a pin that is driven from outside. */
struct sim_input {
	const char *name;
	double start;       /* its value unless the scenario gives another */
	bool pin;           /* is 0 or 1 */
	double least, most; /* both 0: no bounds */
};

#define SIM_PIN(text) \
	{ \
		.name = (text), .start = 1, .pin = true \
	}
#define SIM_TEMPERATURE_INPUT \
	{ \
		.name = "temperature", .start = 20, .least = -55, .most = 125 \
	}

struct sim_family {
	const char *name; /* "DS18B20" */
	uint8_t code;
	bool overdrive, resume;         /* knows these ROM commands */
	size_t state_size;              /* zeroed at creation; sim_state() */
	const struct sim_input *inputs; /* name NULL at the end; NULL: none */

	/* All optional. */
	void (*create)(struct sim_slave *slave); /* contents of the memories as from the factory */
	void (*power_on)(struct sim_slave *slave, int64_t t);
	void (*reset)(struct sim_slave *slave, int64_t t); /* 1-Wire reset */
	/* Selected alone, by a Match ROM or at the end of a search: in the function layer. */
	void (*selected)(struct sim_slave *slave, bool match, int64_t t);
	bool (*alarm)(struct sim_slave *slave, int64_t t); /* answers a conditional search? */
	/* A whole byte from the master. The answer is set up with the calls below. */
	void (*received)(struct sim_slave *slave, uint8_t byte, int64_t t);
	/* The last bit of what was to be sent is gone: send more, receive, or nothing. */
	void (*drained)(struct sim_slave *slave, int64_t t);
	bool (*bit)(struct sim_slave *slave, int64_t t); /* the next bit in SIM_BITS */
	/* Work up to t: end conversions, follow the inputs. Called before everything else. */
	void (*advance)(struct sim_slave *slave, int64_t t);
	/* The wire's strong pull-up comes or goes. */
	void (*strong)(struct sim_slave *slave, bool on, int64_t t);
	/* A start value of the scenario. 0, -ENOENT no such option, -ERANGE. */
	int (*option)(struct sim_slave *slave, const char *name, double value);
	/* The memory that a scenario may fill. */
	uint8_t *(*memory)(struct sim_slave *slave, size_t *size);
};

enum sim_layer {
	SIM_ROM_IDLE, /* deaf until the next reset */
	SIM_ROM_COMMAND,
	SIM_ROM_READ,
	SIM_ROM_MATCH,
	SIM_ROM_SEARCH,
	SIM_FUNCTION,
};
enum sim_mode { SIM_RECEIVE, SIM_SEND, SIM_BITS };

#define SIM_MAX_INPUTS 9
#define SIM_MAX_SEND 80
struct sim_slave {
	const struct sim_family *family;
	uint8_t rom[8];
	char name[32];
	bool plugged;  /* is on the wire */
	bool parasite; /* fed by the wire */
	bool strong;   /* the wire's strong pull-up is on */
	struct sim_curve input[SIM_MAX_INPUTS];

	/* One bit of what is sent is turned over in these function calls; 0: never. */
	uint32_t corrupt_every;
	double corrupt_probability;
	uint64_t corrupt_random; /* state, the seed at first */
	uint32_t calls;
	int corrupt_bit; /* of this call, counted down; -1 none */

	enum sim_layer layer;
	enum sim_mode mode;
	bool overdrive, resumable;
	uint8_t rom_bit, search_phase; /* of 64; id, complement, direction */
	uint8_t shift, bits;           /* the byte on its way, and how much of it */
	uint16_t send_at, send_count;
	uint8_t send[SIM_MAX_SEND];

	uint64_t power_ons, conversions; /* for the tests */
	void *state;
};

/* id: the six bytes after the family; the checksum is computed. NULL: no memory. */
struct sim_slave *sim_slave_create(const struct sim_family *family, const uint8_t id[6]);
void sim_slave_destroy(struct sim_slave *slave);
const struct sim_family *sim_family_find(const char *name, uint8_t code);
/* All families, NULL at the end. */
extern const struct sim_family *const sim_families[];

void sim_slave_power_on(struct sim_slave *slave, int64_t t);
/* The supply breaks down and comes back: what was done by t stays done. */
void sim_slave_brownout(struct sim_slave *slave, int64_t t);
void sim_slave_reset(struct sim_slave *slave, bool overdrive, int64_t t);
/* The slot's begin: does the slave leave the line alone (true), or pull it low? */
bool sim_slave_output(struct sim_slave *slave, int64_t t);
/* The slot's end: line is what it was with all slaves' outputs. */
void sim_slave_slot(struct sim_slave *slave, bool line, int64_t t);
void sim_slave_strong(struct sim_slave *slave, bool on, int64_t t);
void sim_slave_advance(struct sim_slave *slave, int64_t t);
int sim_slave_input(const struct sim_slave *slave, const char *name);
double sim_input_at(const struct sim_slave *slave, unsigned input, int64_t t);

/* For the families. */
#define sim_state(slave, type) ((struct type *)(slave)->state)
void sim_receive(struct sim_slave *slave);
void sim_send(struct sim_slave *slave, const uint8_t *data, size_t n);
void sim_send_byte(struct sim_slave *slave, uint8_t byte);
void sim_send_bits(struct sim_slave *slave); /* each slot asks family->bit() */
void sim_end(struct sim_slave *slave);       /* deaf until the next reset */

#endif
