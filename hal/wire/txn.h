/* SPDX-License-Identifier: MIT */
/*
 * What a chip family writes its properties with: transactions with one device.
 *
 * A property function does at most one 1-Wire transaction (a reset and what follows it, about 15
 * ms) per call. It returns 0 when the value is there, a negative errno, or TXN_MORE: it is called
 * again after other work had its turn, with phase, area and own as it left them. txn_wait() says
 * how long the chip needs meanwhile. The device stays locked until the function returns something
 * else.
 * After an error the function is begun again with phase 0, at most a few times.
 */
#pragma once

#include "hal/wire/device.h"
#include "hal/wire/link.h"

#define TXN_MORE 1
#define TXN_NUMBERS 12
#define TXN_MS INT64_C(1000000)

struct area;
struct native;
struct property;

/* Where area.c is with an area, from call to call; zero: at the beginning. */
#define AREA_UNIT 32
struct area_visit {
	uint8_t step, looks, blanks;
	uint8_t ending;   /* the scratchpad's ending offset */
	uint16_t done;    /* bytes that are written */
	int64_t begun_ns; /* when reading began */
	uint8_t have[AREA_UNIT], want[AREA_UNIT];
};
#define TXN_OWN 64
#define TXN_OUT 128

struct txn {
	struct native *native;
	struct link *link;
	struct device *device;
	const struct property *property;
	unsigned channel;

	/* The value: read fills it, write finds it here. */
	int element;                /* of an array whose elements are separate; else 0 */
	double number[TXN_NUMBERS]; /* numbers, yes/no, dates (seconds of 1970); one for each
	                               element of an aggregate */
	uint32_t bits;              /* bit fields, element 0 in bit 0 */
	uint8_t *data;              /* binary and text: room bytes; read sets len */
	size_t at;                  /* binary: data's first byte in the value or element */
	size_t room, len;
	bool one;            /* write: of an aggregate only the element is given */
	int64_t measured_ns; /* read: when the chip took the value; 0: now */
	/* A reading that others left serves if it began at since_ns or was made at oldest_ns. */
	int64_t since_ns, oldest_ns;
	bool once;         /* and then it serves no other request */
	int64_t shared_ns; /* when the oldest of those that served was made; 0: none did */
	int64_t part_ns;   /* when the oldest part that this request has read was made; 0: none */

	/* From call to call. */
	unsigned phase;
	struct area_visit area;
	_Alignas(8) uint8_t own[TXN_OWN]; /* for a struct of the family: txn_own() */
	int64_t wake_ns;                  /* not to be called before */
	bool strong; /* the strong pull-up is on until then: the channel is held */

	/* What is kept until something is read or has to follow it, so that it is one part. */
	uint8_t out[TXN_OUT];
	uint8_t out_n;
	bool resets;
	bool has_read; /* since the last reset */

	const struct link_run *done; /* txn_done() */
	int64_t done_ns;             /* when that ended, while nothing has followed it */

	/* Found out on the way. */
	bool on_wire;   /* something was sent */
	int link_error; /* the error is the link's, not the device's */
	bool silent;    /* nothing but ones was read */
	bool blank;     /* nothing but ones, or nothing but zeros, was read at some time */
	bool misread;   /* a checksum was wrong */
	bool asked;     /* the chip was found by its id before this reading, and will be after it */
	bool heard;     /* the device itself answered */
	bool restarted; /* the chip lost its state: its power was away */
	bool unproven;  /* a reading that may be of an older conversion than the last */
	bool unheard;   /* ... that is of an older one: its resolution was another */
};

int64_t txn_now(const struct txn *txn);
/* Sends what is written so far; then returns TXN_MORE: to be called again ns later. */
int txn_wait(struct txn *txn, int64_t ns);

/* Bytes and their count, for what takes both: txn_command(txn, TXN_BYTES(0x44)). */
#define TXN_BYTES(...) (const uint8_t[]){__VA_ARGS__}, sizeof((const uint8_t[]){__VA_ARGS__})
/* Reset, match ROM, and n bytes. -ENODEV: no chip is there. */
int txn_command(struct txn *txn, const uint8_t *bytes, size_t n);
/* The same, and then txn_wait(). */
int txn_command_wait(struct txn *txn, const uint8_t *bytes, size_t n, int64_t ns);
/*
 * The same with the strong pull-up after the last bit, for ns. Returns TXN_MORE: to be called
 * again when the pull-up has ended. On a link that has none: without it, but -EOPNOTSUPP for a
 * thermometer that is known to be fed by the wire.
 */
int txn_command_strong(struct txn *txn, const uint8_t *bytes, size_t n, int64_t ns);
/* Reset and n bytes, without selecting the device; the second: and what follows them. */
int txn_raw(struct txn *txn, const uint8_t *bytes, size_t n);
int txn_raw_then(struct txn *txn, const uint8_t *bytes, size_t n, enum link_after after);
int txn_write(struct txn *txn, const uint8_t *bytes, size_t n);
/*
 * The same where the chip answers after it in the same transaction: it returns after ns, which are
 * a few milliseconds at the most. -EOPNOTSUPP where others may use the wire meanwhile
 * (link_facts.splits). Without a strong pull-up only for a device that is
 * known to have a supply of its own.
 */
int txn_write_paused(struct txn *txn, const uint8_t *bytes, size_t n, int64_t ns);
int txn_read(struct txn *txn, uint8_t *bytes, size_t n);
/* The same of slots that are alike, and mean no value: whether a chip is at work, or done. */
int txn_read_slots(struct txn *txn, uint8_t *bytes, size_t n);
/* One read slot: 0 or 1. */
int txn_bit(struct txn *txn);
/* One read slot with the strong pull-up after it; as txn_command_strong(). */
int txn_bit_strong(struct txn *txn, int64_t ns);
/*
 * After a command that takes time: the chip holds read slots low while it is at work.
 * -EBADMSG: it has not taken the command, and what it gives later is older than that.
 */
int txn_started(struct txn *txn);
/* After a comparison with a checksum: 0, or -EBADMSG, and notes that. */
int txn_checked(struct txn *txn, bool fits);
/* n bytes, the last of which is the CRC8 of those before. -EBADMSG. */
int txn_read_crc8(struct txn *txn, uint8_t *bytes, size_t n);
/*
 * n bytes and two of CRC16 (not kept), which covers head (what was sent) and them. -EBADMSG.
 */
int txn_read_crc16(struct txn *txn, const uint8_t *head, size_t head_n, uint8_t *bytes, size_t n);
/* The same for pages of n bytes, each with its CRC16; only the first one's covers head. */
int txn_read_pages(struct txn *txn, const uint8_t *head, size_t head_n, uint8_t *bytes, size_t n,
                   unsigned pages);
/* txn_command(), and the n bytes that the chip answers; the second: with the CRC16 of both. */
int txn_ask(struct txn *txn, const uint8_t *command, size_t command_n, uint8_t *bytes, size_t n);
int txn_ask_crc16(struct txn *txn, const uint8_t *command, size_t command_n, uint8_t *bytes,
                  size_t n);
/*
 * What was read of a chip is kept with the device for other requests: txn_share, of what
 * (an area, or anything else that has an address) n bytes from `at` on; begun_ns: when reading
 * began. txn_shared: bytes that are kept and serve this request; false: they have to be read.
 * txn_void: the chip's registers are written: nothing that is kept is true any more.
 */
void txn_share(struct txn *txn, const void *what, unsigned at, const void *bytes, size_t n,
               int64_t begun_ns);
bool txn_shared(struct txn *txn, const void *what, unsigned at, void *bytes, size_t n);
void txn_void(struct txn *txn);
/* When the chip took the value that the request is answered with. */
int64_t txn_measured(const struct txn *txn);
/*
 * The family's object of this type, zero at the beginning. One of more than TXN_OWN bytes does not
 * compile.
 */
#define txn_own(txn, type) \
	((type *)(void *)((txn)->own + 0 * sizeof(char[sizeof(type) <= TXN_OWN ? 1 : -1])))

/* Match ROM, the device's id and n bytes. Returns how many bytes of out that are. */
#define TXN_SELECT 9
size_t txn_select(const struct device *device, const uint8_t *bytes, size_t n, uint8_t *out);
/*
 * The next transaction has been made already, with others (link_ops.run_many); NULL: it has not.
 * It is taken up if it is what was sent and read, else it is dropped. Call it again with NULL after
 * that.
 */
void txn_done(struct txn *txn, const struct link_run *done);
/* When the last transaction ended: this moment, if it was not made already. */
int64_t txn_ended(const struct txn *txn);

/*
 * After each call of a property function: what is kept is sent. err is what the function returned,
 * and so is this, unless sending failed.
 */
int txn_end(struct txn *txn, int err);
/*
 * Of a device that a driver of the kernel speaks to (driver_ops.has), in place of all above: its
 * areas (hal/chips/area.h), and what it is told to measure. As those of driver_ops.
 */
bool txn_driven(const struct txn *txn);
int txn_driver_read(struct txn *txn, const struct area *area, unsigned at, uint8_t *bytes,
                    size_t n);
int txn_driver_write(struct txn *txn, const struct area *area, unsigned at, const uint8_t *bytes,
                     size_t n);
int txn_driver_convert(struct txn *txn, const char *what);
/*
 * Is the device there (found by search, alarm search)? Leaves it selected. 1, 0 or an error:
 * -EBADMSG the search was disturbed. 0 is also what a disturbed search may say, 1 is certain.
 */
int txn_verify(struct txn *txn, bool alarm);
