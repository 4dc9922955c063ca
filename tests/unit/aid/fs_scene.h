/* SPDX-License-Identifier: MIT */
/*
 * The w1 bus on a directory that looks like /sys/bus/w1/devices, on a virtual clock. Masters are
 * w1_bus_master1 and on; a file is given by its directory and its name there.
 */
#pragma once

#include "tests/unit/aid/host.h"

#define FS_REQUESTS 64

#define WARM "28-0000000000a1"
#define WARM_OW "/28.A10000000000"
#define BOARD "29-0000000000b1"
#define BOARD_OW "/29.B10000000000"

extern struct fs {
	struct host host;
	struct bus *bus;
	char root[64];
	struct bus_req req[FS_REQUESTS]; /* of request id, as fs_ask() returns it */
	uint32_t write_offset;
	uint8_t data[FS_REQUESTS][4096];
	char path[FS_REQUESTS][96];
	uint32_t next_id;
} fs;

/* setUp() and tearDown() */
void fs_begin(void);
void fs_end(void);
/* Open the bus with a master, and wait until it is up. */
void fs_start(void);

/* rm -r ROOT/WHAT */
void fs_erase(const char *what);
void fs_put(const char *directory, const char *name, const void *bytes, size_t n);
void fs_text(const char *directory, const char *name, const char *what);
void fs_byte(const char *directory, const char *name, int value);
/* Reads and writes of the attribute fail with EIO. */
void fs_broken(const char *directory, const char *name);
const char *fs_now_in(const char *directory, const char *name);

/* Make the slave's directory in that of its master, and a link to it, as in sysfs. */
void fs_slave_of(const char *master, const char *name);
void fs_slave(const char *name);
void fs_gone(const char *name);
void fs_thermometer(const char *name, int raw);
/* Write the w1_slave of a thermometer; raw in sixteenths of a degree. */
void fs_scratchpad(const char *name, int raw, int high, int low, int config, const char *verdict);
/* Write the files of BOARD, a DS2408. */
void fs_board(int state, int control);

/* Submit a request; a write writes the n bytes of value. Returns its id. */
uint32_t fs_ask(enum bus_op op, const char *what, const void *value, size_t n);
/* Run until the request has its one answer. Returns the error. */
int fs_result(uint32_t id);
void fs_reads(const char *expected, const char *what);
void fs_fails(int err, const char *what);
int fs_writes(const char *what, const char *value);
/* Write at an offset in the value. */
int fs_writes_at(uint32_t offset, const char *what, const char *value);
void fs_lists(const char *expected, const char *what);
/* Was the event reported with these words? */
bool fs_told(enum bus_news news, const char *part);
