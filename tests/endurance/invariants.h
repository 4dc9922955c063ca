/* SPDX-License-Identifier: MIT */
/*
 * What must be true of an engine at any moment, and of one that had time to get well. Each is a
 * function of its own in invariants.c (signals) and accounts.c (requests, counters, memory), which
 * says seed, time and signal through world_fails().
 */
#pragma once

#include "tests/endurance/station.h"

#define ITEMS 12

enum item_kind { ITEM_TEMPERATURE, ITEM_PINS, ITEM_RELAYS, ITEM_TEXT };

struct item {
	const char *name;
	enum item_kind kind;
	int device;       /* of the field */
	int64_t due_ns;   /* it is read so often */
	const char *text; /* of ITEM_TEXT */
};

extern struct item items[ITEMS];
extern unsigned item_count;
/* What the outputs have to be when all is well; -1: not known. */
extern int commanded;

void invariants_begin(void);
/* After each step of the engine. */
void invariants_step(void);
/* Time was jumped over, or signals were new: nothing is late on account of that. */
void invariants_excuse(void);
/* Nothing is wrong any more for long enough: all is as it should be, and stays so. */
void invariants_well(void);
uint64_t invariants_checked(void);
uint64_t invariants_good(void);

/* The record of an item in the present generation; 0: it is not configured. */
uint32_t record_of(const char *name);
struct ows_sample sample_of(uint32_t record);

/* accounts.c */
void accounts_begin(void);
void accounts_step(void);
/* After a reload. */
void accounts_reloaded(void);
/* All is well, the base configuration is served: memory and descriptors as at the first time. */
void accounts_well(void);
/* Does the lane that serves the record do its work? */
bool lane_works(uint32_t record);
bool record_reads(uint32_t record);
