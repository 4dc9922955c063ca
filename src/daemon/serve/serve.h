/* SPDX-License-Identifier: MIT */
/*
 * The server of the owserver protocol: a thread between clients, which it does not trust, and the
 * engine. The server answers what it can from the shared memory and from what was read lately, and
 * hands the rest to the engine as requests of guests (src/daemon/engine/guest.h). It allocates
 * nothing after serve_start().
 *
 * Room src/daemon/serve: the served owserver protocol, on a thread of its own.
 */
#pragma once

#include "hal/bus/bus.h"
#include "src/config/read/config.h"
#include "src/daemon/engine/guest.h"
#include "src/ground/text/log.h"
#include "src/memory/shm/image.h"

struct porter;
struct serve;

struct serve_setup {
	const struct config *config;
	const char *instance;
	const char *dir; /* the directory of its files */
	int directory;   /* the same, open, where NAME.sock is made; -1: none is made */
	struct log *log;
	struct porter *porter;   /* stays as long as the server */
	void (*ring)(void *ctx); /* wakes the engine, from any thread */
	void *ring_ctx;
};

/*
 * Listen at the addresses of config and at NAME.sock, which takes no writes, and allocate. 0, or a
 * negative errno (-EADDRINUSE) with the reason in why.
 */
int serve_create(const struct serve_setup *setup, struct serve **serve, char *why, size_t why_size);
const struct engine_guests *serve_guests(struct serve *serve);
/* Start the thread; the image is in place, and outlives the server. 0 or a negative errno. */
int serve_start(struct serve *serve, const struct image *image);
/* Allocate what a reload needs, while it can still be refused. 0 or -ENOMEM. */
int serve_prepare(struct serve *serve, const struct config *config);
/*
 * After serve_prepare(): serve the table and the targets of another config from now on. ports[i] is
 * the index that target i had before, -1: none. The addresses to listen at are the same. Blocks
 * until the thread has taken config over; config and image live until the next reload or
 * serve_destroy().
 */
void serve_reload(struct serve *serve, const struct config *config, const struct image *image,
                  const int *ports);
/* End the thread; clients are closed. */
void serve_stop(struct serve *serve);
/* Free the server, once neither engine nor bus writes to the memory of a guest any more. */
void serve_destroy(struct serve *serve);

/* Any thread may call this. */
const struct bus_counter *serve_counters(const struct serve *serve, size_t *n);

/*
 * How many addresses of Listen cannot be reached now: no interface of this machine has them, or
 * another process has their port; why of the first, else "". Opens those that have become free, and
 * logs what comes and goes. One thread may call this, before serve_stop().
 */
unsigned serve_absent(struct serve *serve, char why[LISTEN_WHY_MAX]);

/* May other machines write through this server? */
bool serve_is_open(const struct config_serve *config);
