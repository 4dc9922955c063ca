/* SPDX-License-Identifier: MIT */
/*
 * A chip as its data sheet draws it: areas of memory with the commands that reach them, and fields
 * of these areas that mean a property. A family with nothing else needs no function of its own:
 *
 *	static const struct area memory = {
 *		.name = "memory", .size = 128, .address_bytes = 2, .read = 0xf0, .row = 8,
 *		.write = 0x0f, .verify = 0xaa, .copy = 0x55, .write_crc16 = true, .strong = true,
 *		.copy_ns = 10 * TXN_MS,
 *	};
 *	enum { MEMORY = 1 };
 *	static const struct area *const areas[] = {[MEMORY] = &memory};
 *	static const struct property properties[] = {
 *		AREA_MEMORY(MEMORY, 128),
 *		PROPERTY_DIR("pages"),
 *		AREA_PAGES(MEMORY, 4, 32),
 *	};
 *
 * Reading: the command, the address, the bytes, and their check. What was read is kept with the
 * device: a request for another field of the same bytes within its life needs no wire.
 *
 * Writing, unit by unit: look what is there, put the new bits in, and write if that differs.
 *	with .verify	a scratchpad takes a row, is read back, and copied
 *	without		registers: each row that differs is written, and all are read back. A write
 *			that failed is made again from what stood there before it (unfinished.h).
 * Without .row, the area cannot be written by this master: -EOPNOTSUPP.
 */
#pragma once

#include "hal/wire/txn.h"

/* What proves that the bytes are right, and that this chip has sent them. */
enum area_check {
	/*
	 * Nothing in them: they are read AREA_LOOKS times, and have to be the same. Nothing but
	 * ones, or zeros, is read again between two searches that find the chip by its id
	 * (PROOF_PRESENCE).
	 */
	AREA_UNCHECKED,
	AREA_CRC8,  /* the last of them is the CRC8 of those before */
	AREA_CRC16, /* CRC16 after each block; the first one's covers command and address too */
	AREA_CRC8_PAGES, /* CRC8 of command and address before, and one after each block */
};

/*
 * Noise that turns over one bit in a thousand would get past two looks at a page once in 4,000.
 */
#define AREA_LOOKS 3
#define AREA_PASSWORD 8

struct area {
	const char *name; /* as the data sheet calls it; a driver of the kernel knows it by that */
	uint16_t at;      /* address of its first byte */
	uint16_t size;    /* bytes */
	/*
	 * Bytes that are read as a whole, AREA_UNIT at most; 0: 1. Of checked ones several come in
	 * one transaction, of unchecked ones one.
	 */
	uint8_t block;
	uint8_t row; /* bytes that one command writes; 0: none does */
	bool parts;  /* a driver reads these bytes one by one: no more than are asked for */
	bool hidden; /* a driver need not show what it was told: it is written even so */
	/*
	 * So many at its beginning are read-only, and may be written as they are. A write of the
	 * others reads from behind these on: so the command has to take an address.
	 */
	uint8_t fixed;
	uint8_t address_bytes;             /* behind a command, low byte first: 0, 1, 2 */
	bool high_first;                   /* ... the high byte first */
	uint8_t check;                     /* enum area_check */
	uint8_t read, write, verify, copy; /* commands; 0: there is none */
	uint8_t recall;   /* command that makes read give what is stored, not written; 0: none */
	uint8_t key;      /* behind copy; 0: address and ending offset as verify gives them */
	uint8_t password; /* bytes of zeros behind these, AREA_PASSWORD at most */
	uint8_t counts;   /* of each byte that is read the bits that count; 0: all */
	bool ones_lie;    /* nothing but ones is no answer of the chip: -EIO */
	bool write_crc16; /* the chip answers what is written, and verify, with CRC16 */
	bool echo;        /* ... and then with the byte that it has taken */
	bool strong;      /* the copy needs the strong pull-up */
	int64_t copy_ns;

	/*
	 * All optional. begin: before anything is sent, or taken from what is kept; 0, TXN_MORE or
	 * an error. load and store: in place of .read and .write, whole transactions; load may take
	 * several calls, and has to prove its bytes, for they are not looked at AREA_LOOKS times.
	 * saw: of what was read, from byte `at` of the area on, it notes what that says of the
	 * device, and blanks bits that do not count; 0 or an error. is_written: does what is read
	 * back show that all was written? adjust: of the whole unit that is to be written, it
	 * changes what goes with the change that was asked for.
	 */
	int (*begin)(struct txn *txn);
	int (*load)(struct txn *txn, const struct area *area, unsigned at, uint8_t *bytes,
	            unsigned n);
	int (*store)(struct txn *txn, const struct area *area, unsigned at, const uint8_t *bytes,
	             unsigned n);
	int (*saw)(struct txn *txn, unsigned at, uint8_t *bytes, unsigned n);
	bool (*is_written)(struct txn *txn, const uint8_t *have, const uint8_t *want, unsigned n);
	void (*adjust)(struct txn *txn, uint8_t *want);
};

/* An area that functions name too: static AREA_NAMED(status, "status", .size = 1, ...); */
#define AREA_NAMED(area_, text, ...) const struct area area_ = {.name = (text), __VA_ARGS__}

/* An area that only the list of its family names: [STATUS] = AREA(.name = "status", ...). */
#define AREA(...) \
	&(const struct area) \
	{ \
		__VA_ARGS__ \
	}

struct field {
	uint8_t area; /* which of the family's areas; 0: none */
	uint8_t shift;
	uint8_t bits;            /* 0: all from shift on; of PROPERTY_BITS as many as elements */
	unsigned char bytes : 4; /* 1 to 4; 0: 1 */
	bool is_signed : 1, big_endian : 1, inverted : 1;
	uint16_t at;     /* its first byte in the area */
	uint16_t stride; /* bytes from an element to the next; of binary 0: those of an element */
	double unit, offset; /* value = bits * unit + offset; unit 0: 1 */
};

/* Four bytes of an area as a number, the low one first. */
static inline uint32_t area_le32(const uint8_t *bytes)
{
	return bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 |
	       (uint32_t)bytes[3] << 24;
}

/* A command after which the chip measures or computes. */
struct conversion {
	const char *name; /* the property that says it: a driver of the kernel knows it by that */
	uint8_t command[3], n;
	bool crc16; /* the chip answers with the CRC16 of the command */
	int64_t ns;
};

/*
 * n bytes (AREA_UNIT at most) from byte `at` of the area on; several calls. What another request
 * has read serves as far as the request allows it.
 */
int area_read(struct txn *txn, const struct area *area, unsigned at, uint8_t *bytes, unsigned n);
/* The same of any length to txn->data and txn->len. */
int area_read_data(struct txn *txn, const struct area *area, unsigned at, unsigned n);
/* One transaction: the command and what it gives, its checksum checked. */
int area_fetch(struct txn *txn, const struct area *area, unsigned at, uint8_t *bytes, unsigned n);
/*
 * Of a device that a driver of the kernel speaks to, which owsd cannot search for: does it send
 * anything but ones and zeros in one of its areas? areas[0] is none. 1, 0 or an error.
 */
int area_ask_driver(struct txn *txn, const struct area *const *areas, unsigned count);
/* Of the n bytes from `at` on those bits that are set in mask; mask NULL: all. Several calls. */
int area_write(struct txn *txn, const struct area *area, unsigned at, const uint8_t *bytes,
               const uint8_t *mask, unsigned n);

/* Returns TXN_MORE: to be called again when it is over; strong: with the strong pull-up. */
int conversion_start(struct txn *txn, const struct conversion *conversion, bool strong);
