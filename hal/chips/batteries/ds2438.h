/* SPDX-License-Identifier: MIT */
/* A DS2438: its pages and its configuration. */
#pragma once

#include "hal/chips/property.h"

/* Bits of the status/configuration register, page 0 byte 0. */
#define DS2438_IAD 0x01
#define DS2438_CA 0x02
#define DS2438_EE 0x04
#define DS2438_AD 0x08 /* the supply, not the input, is measured */

/* What it measures, in this order; sets of them are bits. */
enum ds2438_quantity { DS2438_TEMPERATURE, DS2438_VAD, DS2438_VDD, DS2438_VIS, DS2438_QUANTITIES };

/* What is known of the chip (device.own). */
struct ds2438 {
	/*
	 * Of each page its first byte as it was; of page 0 the configuration and 80h. 0: not known.
	 */
	uint8_t first[8];
	bool genuine; /* it has shown a conversion, or a recall */
	uint8_t kept; /* pairs of marks that outlived their recalls, before that */
};
static inline struct ds2438 *ds2438_of(const struct txn *txn)
{
	return txn->device->own;
}

/* Where a visit is; the functions here and in ds2438_measure.h take several calls. */
struct ds2438_visit {
	uint8_t step, mark; /* of ds2438_read() */
	bool again;         /* ... and the memory held the mark */
	bool probing;       /* a conversion was not shown: is it a copy? */
	uint8_t converts;   /* commands to a copy to convert */
	bool configuring, patching, marking;
	uint8_t writing;       /* the step of writing a page */
	uint8_t configuration; /* as it is to be */
	uint8_t page[8];       /* as it is to be */
	uint8_t proof_mark;    /* of ds2438_mark() */
	uint8_t proof;         /* of the quantity that is measured */
	uint8_t before;        /* the configuration before the visit */
	uint8_t stage;         /* quantities that are done, or a step of the caller */
	int64_t begun_ns;      /* of the quantity; 0: it is to be begun */
	double value[4];       /* of the quantities */
};
static inline struct ds2438_visit *ds2438_visit(struct txn *txn)
{
	return txn_own(txn, struct ds2438_visit);
}

/* Two bytes as they stand in the memory. */
static inline int16_t ds2438_word(const uint8_t *bytes)
{
	return (int16_t)(bytes[0] | bytes[1] << 8);
}

/* For fields; they are written by ds2438_write_field() (of four bytes) and ds2438_patch(). */
extern const struct area ds2438_pages;
/* For properties: of four bytes, of a flag of the configuration, of a page. */
property_function ds2438_write_field, ds2438_write_flag, ds2438_write_page;

/* A page of the memory as it is now. */
int ds2438_read(struct txn *txn, unsigned page, uint8_t bytes[8]);
/* Put n bytes into a page; phase 0 first. */
int ds2438_patch(struct txn *txn, unsigned page, unsigned at, const uint8_t *bytes, unsigned n);
/* Set the configuration's bits of mask. *before (if not NULL): the configuration as it was. */
int ds2438_configure(struct txn *txn, uint8_t mask, uint8_t bits, uint8_t *before);
/*
 * A program that plays a DS2438 (OneWireHub): it shows no conversion, and has no memory behind the
 * scratchpads, so that Recall changes nothing. Known by both, again and again.
 */
bool ds2438_is_copy(const struct txn *txn);
/* It has shown what only a chip does. */
void ds2438_is_genuine(struct txn *txn);
/* What Convert V measures, DS2438_AD or 0, until the next ds2438_read(). */
int ds2438_select(struct txn *txn, uint8_t select);
/* Page 0 after that; -EBADMSG if something else was selected. */
int ds2438_read_selected(struct txn *txn, uint8_t select, uint8_t bytes[8]);
/*
 * Leave a mark in a scratchpad, other than what a restart leaves there. ds2438_is_marked():
 * -EBADMSG if the chip has restarted since, or it cannot be known.
 */
int ds2438_mark(struct txn *txn);
int ds2438_is_marked(struct txn *txn);
