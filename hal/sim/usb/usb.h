/* SPDX-License-Identifier: MIT */
/*
 * A simulated DS2490 (DS9490R, DS9490B) at the level of its USB transfers, on channel 0 of the
 * first chip of a simulated network, by its data sheet (Maxim 19-4993); with a DS1420 in its
 * scenario it is a DS9490R with its own chip. Commands take their time on the wire: what is due at
 * now has happened, what is not has not.
 *
 * now is ns of the clock of the network (net.h), and never goes back. Transfers take no time here:
 * the caller adds what the frames of USB take.
 *
 * Not modelled, and refused by a stall: the macros for couplers, SRAM, EPROM and crypto iButtons;
 * the 12 V pulse answers that there is no supply for it.
 *
 * Room hal/sim/usb: a simulated USB adapter, for tests alone.
 */
#pragma once

#include "hal/sim/net.h"

/* setup[1] of vendor requests (setup[0] 40h; C0h to read commands back), and their wValue. */
enum { DS2490_CONTROL = 0, DS2490_COMM = 1, DS2490_MODE = 2 };
enum {
	DS2490_RESET_DEVICE = 0,
	DS2490_START_EXE = 1,
	DS2490_RESUME_EXE = 2,
	DS2490_HALT_EXE_IDLE = 3,
	DS2490_HALT_EXE_DONE = 4,
	DS2490_FLUSH_COMM = 7,
	DS2490_FLUSH_RCV = 8, /* EP3 */
	DS2490_FLUSH_XMT = 9, /* EP2 */
	DS2490_GET_COMM = 10,
};
enum {
	DS2490_PULSE_EN = 0, /* 01 12 V, 02 strong pull-up */
	DS2490_SPEED_CHANGE_EN = 1,
	DS2490_SPEED = 2, /* 0 regular, 1 flexible, 2 overdrive */
	DS2490_PULLUP_DURATION = 3,
	DS2490_SLEW_RATE = 4,
	DS2490_PULSE_DURATION = 5,
	DS2490_WRITE1_LOW = 6,
	DS2490_SAMPLE_OFFSET = 7,
};
enum {
	DS2490_SET_DURATION = 0x12,
	DS2490_BIT = 0x20,
	DS2490_PULSE = 0x30,
	DS2490_WIRE_RESET = 0x42,
	DS2490_BYTE = 0x52,
	DS2490_MATCH = 0x64,
	DS2490_BLOCK = 0x74,
	DS2490_STRAIGHT = 0x80,
	DS2490_SEARCH = 0xF4,
};
/* Bits of a communication command. */
enum {
	DS2490_IM = 0x0001,
	DS2490_TYPE = 0x0008, /* of a pulse or duration: 12 V */
	DS2490_SE = 0x0008,   /* of a reset or match: the parameter has a new speed */
	DS2490_D = 0x0008,    /* of a bit */
	DS2490_SM = 0x0008,   /* of a search: report ids, or else make for one */
	DS2490_RST = 0x0100,
	DS2490_ICP = 0x0200,
	DS2490_NTF = 0x0400,
	DS2490_F = 0x0800,
	DS2490_SPU = 0x1000,
	DS2490_CIB = 0x4000, /* of a bit: the pull-up only after a 0 */
	DS2490_PST = 0x4000, /* of a reset: until a presence pulse */
	DS2490_RTS = 0x4000, /* of a search: discrepancies follow the ids if there are more */
};
/* The same bits where READ STRAIGHT has its preamble's length in the high byte. */
enum { DS2490_STRAIGHT_RST = 0x02, DS2490_STRAIGHT_ICP = 0x04, DS2490_STRAIGHT_NTF = 0x08 };

/* EP1: state registers, and the flags of one of them; results follow. */
enum {
	DS2490_AT_ENABLE = 0, /* 01 strong pull-up, 02 12 V, 04 speed change */
	DS2490_AT_SPEED = 1,
	DS2490_AT_PULLUP = 2,
	DS2490_AT_PULSE = 3,
	DS2490_AT_SLEW = 4,
	DS2490_AT_WRITE1 = 5,
	DS2490_AT_SAMPLE = 6,
	DS2490_AT_FLAGS = 8,
	DS2490_AT_COMMAND = 9, /* two bytes, the low one first; 0 when idle */
	DS2490_AT_COMMANDS = 11,
	DS2490_AT_OUT = 12, /* bytes in EP2's FIFO */
	DS2490_AT_IN = 13,  /* bytes in EP3's FIFO */
	DS2490_STATE = 16,
};
enum { DS2490_SPUA = 0x01, DS2490_HALTED = 0x10, DS2490_IDLE = 0x20, DS2490_EP0F = 0x80 };
enum {
	DS2490_NRS = 0x01,
	DS2490_SH = 0x02,
	DS2490_APP = 0x04,
	DS2490_VPP = 0x08,
	DS2490_CMP = 0x10,
	DS2490_CRC = 0x20,
	DS2490_RDP = 0x40,
	DS2490_EOS = 0x80,
	DS2490_DETECT = 0xA5, /* a device has come */
};

struct sim_fifo {
	unsigned first, count;
	uint8_t byte[128];
};

/* The command under way: what it has still to do, in this order. */
struct sim_ds2490_work {
	uint16_t code; /* 0: none */
	uint16_t bits; /* DS2490_RST, _ICP, _NTF, _F, _SPU, ... wherever the command has them */
	uint8_t result;
	bool reset;
	bool first; /* a byte of the command itself: first_byte */
	uint8_t first_byte;
	bool first_back; /* what is read of it goes to the host */
	bool speed;      /* then the speed changes */
	uint8_t new_speed;
	bool slot, slot_out;
	unsigned search;   /* bits of an id to go, 64 at its begin; 0: no search */
	bool search_begun; /* the id to begin at has been taken */
	unsigned out;      /* bytes of EP2 */
	bool out_back;     /* what is read of them goes to the host */
	unsigned in;       /* bytes to read after them */
	bool pull, pulling;
	/* of a search */
	unsigned found, wanted;
	int last; /* up to this bit the search follows the id before; there it turns */
	uint8_t id[8], conflict[8];
};

struct sim_ds2490 {
	struct sim_net *net;
	/* Faults to switch on; bit n is endpoint n. */
	uint8_t stalled; /* until the host clears the halt of the endpoint */
	uint8_t silent;  /* answers nothing: NAK */

	/* What the data sheet forbids, counted. */
	struct sim_ds2490_faults {
		uint64_t setups_lost;  /* came while the FIFO of EP0 was full */
		uint64_t data_lost;    /* bytes for EP3 while its FIFO was full */
		uint64_t results_lost; /* while 16 were waiting for the host */
		uint64_t unhalted;     /* flushed or asked for commands while not halted */
		uint64_t reserved;     /* values that are reserved */
		uint64_t unknown;      /* requests that the chip stalls */
		uint64_t babble;       /* the host had less room than the packet needs */
	} faults;
	uint64_t requests, transfers; /* control requests of the vendor's; all else */
	uint64_t commands;            /* communication commands carried out */
	int64_t wire_ns;              /* time of the wire */

	uint8_t alternate;
	uint8_t state[8];                         /* the mode registers, DS2490_AT_ENABLE and on */
	struct sim_fifo command, out, in, result; /* room for 16, 128, 128 and 16 */
	uint8_t held[4];                          /* a command that waits in the FIFO of EP0 */
	unsigned held_count;
	bool ep0_full; /* EP0F */
	bool running;  /* commands in the FIFO are carried out */
	bool halted;
	uint8_t halt;   /* DS2490_HALT_EXE_… asked for; 0: none */
	size_t present; /* devices at the last look */
	int64_t t;      /* the work is done up to here */
	struct sim_ds2490_work work;
};
