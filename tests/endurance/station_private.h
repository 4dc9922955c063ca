/* SPDX-License-Identifier: MIT */
/* Between the files of the station. */
#pragma once

#include "tests/endurance/station.h"

/*
 * station.c: when station_run() ends; when anything but this bus (NULL: at all) has to do
 * something.
 */
extern int64_t station_until;
int64_t station_next(const struct station_bus *own);

/* station_bus.c: in a free place, with a fiber of its own. */
struct station_bus *station_bus_open(const struct config_target *target, bool suspended);
void station_bus_free(struct station_bus *b);
/* Something that it said is still on its way. */
bool station_bus_speaks(const struct station_bus *b);
void station_bus_wake(struct station_bus *b);

/* station_engine.c: of an engine's port, ctx is the bus; true: it was told something. */
int station_submit(void *ctx, struct bus_req *req);
void station_suspend(void *ctx, bool yes);
bool station_tell_engine(void);
void station_log_begin(void);

/* generation.c: of the generations that were replaced, those whose buses have ended. */
void station_leave(void);
