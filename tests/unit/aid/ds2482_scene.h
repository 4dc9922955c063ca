/* SPDX-License-Identifier: MIT */
/* The driver of the DS2482 over the simulated chip, in virtual time. */
#pragma once

#include "hal/ds2482/ds2482.h"
#include "hal/sim/adapter.h"
#include "tests/unit/aid/host.h"

extern struct ds {
	struct host host;
	struct sim_net net;
	struct sim_adapter adapter;
	struct link_master *master;
	struct link *wire; /* the first link */
	unsigned closes;
	char why[200];
} ds;

/* setUp() and tearDown() */
void ds_begin(void);
void ds_end(void);

/* Open the master at that place of the scenario. Returns the error, with the reason in ds.why. */
int ds_try_open(const char *scenario, const char *where);
/* Open the master for all chips of the scenario. */
void ds_start(const char *scenario);
/* The functions for a test that makes its own master. */
extern const struct link_master_ops ds_ops;
int ds_open_adapter(void *ctx, const struct bus_env *env, struct i2c_adapter **out, char *text,
                    size_t size);
void ds_forget(void *ctx);

/* Scenarios with one thermometer "t" behind each kind of adapter. */
#define DS_KINDS 8
extern const char *const ds_kinds[DS_KINDS];

/* Let an event of the scenario language happen now. */
void ds_event(const char *text);
/* Send reset, Match ROM and Read Scratchpad to the named device, and read its nine bytes. */
int ds_read_scratchpad(const char *name, uint8_t scratchpad[9]);
/* Check the scratchpad of the thermometer "t" against that after power-on. */
void ds_check_scratchpad(void);
