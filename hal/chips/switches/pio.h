/* SPDX-License-Identifier: MIT */
/*
 * The two open-drain switches of DS2413 (data sheet 19-5703) and DS28EA00 (19-5615).
 *
 * A byte that is read is good if its halves are complements, and if two bytes are the same. A write
 * is confirmed, and read back.
 */
#pragma once

#include "hal/chips/property.h"

/* The status: levels of the pins, output latches (1 does not conduct), and the nibble of both. */
enum { PIO_PINS, PIO_OUTPUTS, PIO_STATE };
extern const struct area pio_status;

/* What is known of a DS2413 (device.own): readings in a row that only a copy of it gives. */
struct pio_copy {
	uint8_t readings;
	bool asked; /* it did not confirm a write: it is looked at before the next */
};

/* The hooks of the latches' area. */
int pio_load(struct txn *txn, const struct area *area, unsigned at, uint8_t *bytes, unsigned n);
int pio_store(struct txn *txn, const struct area *area, unsigned at, const uint8_t *bytes,
              unsigned n);
bool pio_is_written(struct txn *txn, const uint8_t *have, const uint8_t *want, unsigned n);

#define PIO_LATCHES(command) \
	.name = "latches", .size = 1, .row = 1, .hidden = true, .write = (command), \
	.load = pio_load, .store = pio_store, .is_written = pio_is_written
#define PIO_BITS(text, access_, ...) \
	PROPERTY(text, BITS, VOLATILE, access_, AGGREGATE(2, LETTERS), __VA_ARGS__)
/* area_: which of the family's areas pio_status is. */
#define PIO_READ(area_, part, inverted_) FIELD(area_, .at = (part), .inverted = (inverted_))
/* A write of both gives the whole byte: what is there does not matter. */
#define PIO_SET(area_) SET(area_, .bits = 8, .inverted = true)
