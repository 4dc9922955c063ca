/* SPDX-License-Identifier: MIT */
/*
 * A simulated 1-Wire slave: the ROM layer that all have in common, bit by bit, and the table by
 * which a family adds its functions, byte by byte.
 *
 * t is ns since the start of the simulation; it never goes back for one slave. Each call with a t
 * leaves it in slave->now, where the functions of the family read it.
 */
#pragma once

#include <stdbool.h>

#include "hal/sim/bytes.h"
#include "hal/sim/curve.h"

struct sim_branch;
struct sim_slave;

/* A quantity that the slave measures or a pin that is driven from outside. */
struct sim_input {
	const char *name;
	double start;       /* its value unless the scenario gives another */
	bool pin;           /* is 0 or 1 */
	double least, most; /* both 0: no bounds */
};

#define SIM_PIN(text) .name = (text), .start = 1, .pin = true
#define SIM_CONDITION(text) .name = (text), .pin = true
#define SIM_TEMPERATURE_INPUT .name = "temperature", .start = 20, .least = -55, .most = 125

/* A start value that a scenario gives: a whole number. */
struct sim_option {
	const char *name; /* NULL ends a list */
	double least, most;
	size_t at; /* of the byte of the state that takes the value, unless there is set() */
	void (*set)(struct sim_slave *slave, int64_t value);
};
#define SIM_OPTION(type, text, from, to, member) \
	{ \
		(text), (from), (to), offsetof(struct type, member) \
	}

/*
 * A function command: its code, the bytes that belong to it, and what it does. The slave keeps the
 * bytes in taken, and an address of one or two of them in address; without such bytes the address
 * begins at 0.
 */
struct sim_function {
	uint8_t code, takes; /* zeros end a table */
	uint8_t unchecked;   /* of these bytes, the last ones, which no checksum covers */
	bool any;            /* the last row: takes each code that has no row of its own */
	/* All optional. */
	void (*start)(struct sim_slave *slave);              /* the code and its bytes are there */
	void (*byte)(struct sim_slave *slave, uint8_t byte); /* one more byte came */
	/* The last bit was sent: send more, receive, or do nothing. */
	void (*next)(struct sim_slave *slave);
};

struct sim_family {
	const char *name; /* "DS18B20" */
	uint8_t code;
	bool overdrive, resume;         /* the slave knows these ROM commands */
	size_t state_size;              /* zeroed at creation; sim_state() */
	const struct sim_input *inputs; /* name NULL at the end; NULL: none */

	bool crc8;    /* the checksums of its functions have 8 bits, not 16 */
	bool starves; /* fed by the wire, restarts if it works without strong pull-up */
	const struct sim_function *functions; /* NULL: none */
	const struct sim_option *options;     /* NULL: none */
	const void *kind; /* what tells it from others with the same functions */

	/* All optional. */
	void (*create)(struct sim_slave *slave); /* contents of the memories as from the factory */
	void (*power_on)(struct sim_slave *slave);
	/*
	 * The slave was selected alone, by a Match ROM or at the end of a search: it is in the
	 * function layer.
	 */
	void (*selected)(struct sim_slave *slave, bool match);
	void (*begun)(struct sim_slave *slave);   /* the code of a function came */
	bool (*alarm)(struct sim_slave *slave);   /* answers a conditional search? */
	bool (*bit)(struct sim_slave *slave);     /* the next one in SIM_BITS; NULL: idle? */
	void (*worked)(struct sim_slave *slave);  /* the work of sim_work() has ended */
	void (*advance)(struct sim_slave *slave); /* follow the inputs up to now */
	/* The memory that a scenario may fill, in the state: SIM_MEMORY(). size 0: none. */
	size_t memory_at, memory_size;
};

#define SIM_MEMORY(type, member, size) \
	.memory_at = offsetof(struct type, member), .memory_size = (size)

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
	unsigned chip, channel; /* of the net (net.h), on which it is */
	bool plugged;           /* the slave is on the wire */
	bool parasite;          /* fed by the wire */
	bool strong;            /* the wire's strong pull-up is on */
	struct sim_curve input[SIM_MAX_INPUTS];
	struct sim_branch *branches; /* of a coupler (branch.h); NULL: it is none */
	struct sim_branch *behind;   /* the branch it is on; NULL: on the wire itself */
	struct sim_slave *next_behind;

	/* One bit of what is sent is turned over in these function calls; 0: never. */
	uint32_t corrupt_every;
	double corrupt_probability;
	uint64_t corrupt_random; /* state, the seed at first */
	uint32_t calls;
	int corrupt_bit; /* the bit to turn over in this call, counted down; -1: none */

	int64_t now; /* t of the call under way */
	enum sim_layer layer;
	enum sim_mode mode;
	bool overdrive, resumable;
	uint8_t rom_bit, search_phase; /* of 64; id, complement, direction */
	uint8_t shift, bits;           /* the byte under way, and how many of its bits */
	uint16_t send_at, send_count;
	uint8_t send[SIM_MAX_SEND];

	const struct sim_function *function; /* NULL: the function's code has yet to come */
	uint8_t code;                        /* of the function */
	uint8_t taken[18], got;
	uint16_t address;
	uint16_t crc; /* checksum of all bytes since the code, or since the last checksum */
	bool busy;    /* the operation runs from since to until */
	int64_t since, until;

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
/* The supply breaks down and comes back; what the slave did up to t stays done. */
void sim_slave_brownout(struct sim_slave *slave, int64_t t);
void sim_slave_reset(struct sim_slave *slave, bool overdrive, int64_t t);
/* The slot begins: does the slave leave the line alone (true), or pull it low? */
bool sim_slave_output(struct sim_slave *slave, int64_t t);
/* The slot ends; line: its level with the outputs of all slaves. */
void sim_slave_slot(struct sim_slave *slave, bool line, int64_t t);
void sim_slave_strong(struct sim_slave *slave, bool on, int64_t t);
void sim_slave_advance(struct sim_slave *slave, int64_t t);
/* Give an option its value. 0, -ENOENT: no such option, -ERANGE. */
int sim_slave_option(struct sim_slave *slave, const char *name, double value);
int sim_slave_input(const struct sim_slave *slave, const char *name);
double sim_input_now(const struct sim_slave *slave, unsigned input);
double sim_input_at(const struct sim_slave *slave, unsigned input, int64_t t);

/* The memory that a scenario may fill; NULL: there is none. */
uint8_t *sim_slave_memory(const struct sim_slave *slave, size_t *size);

/* For the families. */
#define sim_state(slave, type) ((struct type *)(slave)->state)
void sim_receive(struct sim_slave *slave);
void sim_send(struct sim_slave *slave, const uint8_t *data, size_t n);
void sim_send_byte(struct sim_slave *slave, uint8_t byte);
void sim_send_bits(struct sim_slave *slave); /* each slot asks family->bit() */
void sim_end(struct sim_slave *slave);       /* deaf until the next reset */
/* Send n bytes and the checksum of all bytes in both directions since the code or last checksum. */
void sim_send_checked(struct sim_slave *slave, const uint8_t *data, size_t n);
/* Send n bytes and their own CRC8. */
void sim_send_crc8(struct sim_slave *slave, const uint8_t *data, size_t n);
/* Send the byte, and move the address on; after each page the checksum. page 0: none. */
void sim_send_next(struct sim_slave *slave, uint8_t byte, unsigned page);
/* In the same way send the byte at the address; after the last byte be deaf. */
void sim_send_memory(struct sim_slave *slave, const uint8_t *memory, unsigned size, unsigned page);
/* Send the checksum, then the byte now stored at the address. The next checksum starts after it. */
void sim_send_stored(struct sim_slave *slave, uint8_t stored);
/* Send the checksum of what came since the code. */
void sim_send_checksum(struct sim_slave *slave);
/* Be busy for a while: read slots are 0, worked() ends it. */
void sim_work(struct sim_slave *slave, int64_t takes);
/* For a family whose read slots do not show that it works. */
bool sim_ones(struct sim_slave *slave);
