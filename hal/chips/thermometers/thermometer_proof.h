/* SPDX-License-Identifier: MIT */
/*
 * Is what a thermometer holds the result of its last conversion, and when did that end? A chip may
 * not have received Convert T, and an old result has a right checksum, too. All times are ns.
 * Nothing here uses the wire.
 *
 * No data sheet says what a chip that converts does with another Convert T. It may begin anew, or
 * go on and ignore it; its slots show it busy either way. So the result counts as that of the
 * earliest conversion that it can be.
 *
 * Lost commands: behind Convert T eight slots are low, as the chip is busy. A result that is read
 * before the longest time is over has to differ from the one before. With the strong pull-up no
 * slot can show it: docs/native.md, "What a lost command leaves". Write Scratchpad is read back.
 * Read Power Supply, which says "external" if it is lost, is asked in three looks of eight slots,
 * six for `power`.
 */
#pragma once

#include "hal/wire/txn.h"

/* The nine bytes of the scratchpad. */
enum { SP_LSB, SP_MSB, SP_HIGH, SP_LOW, SP_CONFIG, SP_5, SP_REMAIN, SP_PER_DEGREE, SP_CRC };

/* It did not show so many starts in a row: it cannot, as some clones, or has no supply. */
#define THERMOMETER_SILENT 3

/* What is known of its last conversion. */
struct thermometer_last {
	int64_t ends_ns; /* when it ends or ended; 0: none is known */
	int64_t busy_ns; /* until then the chip may convert, whatever it heard */
	unsigned missed; /* starts in a row that it did not show, to THERMOMETER_SILENT */
	bool was_read;   /* a result has been read since then */
	bool unread;     /* its result did not come over the wire whole */
	bool cut;        /* the chip may have gone on with the one before it */
	bool can_prove;  /* an end before the longest time could be proven */
};
struct thermometer_last thermometer_last(const struct device *device);

/* A conversion's longest time at the device's present resolution. */
int64_t thermometer_convert_ns(const struct device *device);
/* Convert T was sent to it, for longest ns; whether it heard is not known. */
void thermometer_told(struct device *device, int64_t now, int64_t longest);
/*
 * Convert T was sent, and the chip, or with unseen perhaps not the chip, but another one of those
 * that were told, has shown that it heard.
 */
void thermometer_converts(struct device *device, int64_t now, int64_t longest, bool unseen);
/* It showed a start: of its own, or (for_all) one for all, and no other can have shown that. */
void thermometer_showed(struct device *device, bool for_all);
/* It did not show a start of its own. */
void thermometer_missed(struct device *device);
/* The last conversion counts no more: its wire was lost, or what it left is of no use. */
void thermometer_void(struct device *device);
/* The result of the last conversion did not come over the wire whole, or (false) it did. */
void thermometer_unread(struct device *device, bool yes);
/* The last conversion seems to have ended now: thermometer_ended() asks for the proof. */
void thermometer_seems_over(struct device *device, int64_t now);
/*
 * Would a conversion at THERMOMETER_MARK bits change what it holds, whatever the temperature is?
 * Then that proves that it hears Convert T, also with the strong pull-up, and the result of the
 * next one at more bits differs from that in turn. Of no chip whose resolution is fixed, and of no
 * temperature that THERMOMETER_MARK bits can show: seven of eight at 12 bits are others.
 */
#define THERMOMETER_MARK 9
bool thermometer_marks(const struct device *device);
/* It restarted, or has another resolution than was thought: it may convert for longer. */
void thermometer_doubt(struct device *device, int64_t now);
/*
 * Before a command that no data sheet allows while the chip converts. 0, or TXN_MORE: txn waits
 * until it does not.
 */
int thermometer_rest(struct txn *txn);
/*
 * After a reading of the scratchpad, which ended at now (txn_ended()): it may be judged later than
 * that. 0: its conversion is over. TXN_MORE: it seemed to be, and
 * nothing proves that; txn waits for the longest time, and is to read the scratchpad again.
 */
int thermometer_ended(struct txn *txn, const uint8_t scratchpad[9], int64_t now);
/*
 * What it holds was read, and is good: notes that, and from when it is (measured_ns, unproven).
 * -EIO: nothing was to be converted for it, and no conversion is known that it can be of.
 */
int thermometer_took(struct txn *txn, const uint8_t scratchpad[9], int64_t now);
/*
 * Nothing proves that the chip made its last conversion: is what was proven before too little? It
 * is for a request that insists on a conversion of its own (fresh).
 */
bool thermometer_doubtful(const struct txn *txn, bool fresh);
