/* SPDX-License-Identifier: MIT */
/*
 * A serial port as the drivers of adapters use it, 8 bits and no parity; and where it comes from.
 * All waits go through the environment. Errors are returned: -ENODEV the port is gone, -ECANCELED
 * the host shuts down.
 */
#pragma once

#include "hal/wire/link.h"

struct serial_port;
struct serial_port_ops {
	/* -ENOTTY: the port cannot have this speed. The caller has waited for what it sent. */
	int (*speed)(struct serial_port *port, unsigned baud);
	/* All of them, or an error: -ETIMEDOUT, the port takes no more. */
	int (*write)(struct serial_port *port, const uint8_t *bytes, size_t n);
	/* Up to n of those that have come; 0: none came in time. */
	int (*read)(struct serial_port *port, uint8_t *bytes, size_t n, int64_t until_ns);
	/* Hold the line low, longer than any byte. A port that cannot do it does nothing. */
	void (*send_break)(struct serial_port *port);
	void (*close)(struct serial_port *port);
};

struct serial_port {
	const struct serial_port_ops *ops;
	const struct bus_env *env;
	struct link_master_cost *cost; /* bytes and syscalls are counted there */
};

/* Where a port comes from, and who is told of it. */
struct serial_source {
	/* 0 and the port; or an error, and what to do about it. name gets what it is called. */
	int (*open)(void *ctx, const struct bus_env *env, struct serial_port **port, char *name,
	            size_t name_size, char *why, size_t why_size);
	/* As link_master_ops.visible. */
	int (*visible)(void *ctx, uint64_t *mark);
	void (*destroy)(void *ctx);
	void *ctx;
	const char *proc; /* RIVALS_PROC: look who else has it open; NULL: nobody can */
};
