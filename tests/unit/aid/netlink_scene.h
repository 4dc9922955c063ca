/* SPDX-License-Identifier: MIT */
/* Sets up the target w1:netlink on a model of the kernel's 1-Wire core. */
#pragma once

#include "hal/native/native.h"
#include "tests/unit/aid/w1_core.h"

#define NETLINK_ROOM 4096

struct netlink_scene {
	struct host host;
	struct bus *bus;
	uint8_t data[NETLINK_ROOM]; /* of the last answer, with NUL */
	bool whole;                 /* each id of a list is read whole */
};
extern struct netlink_scene nl;

/* In setUp() and tearDown(). */
void nl_begin(void);
void nl_end(void);
/* Give the core so many masters, and write the directory that stands for sysfs. */
void nl_masters(unsigned masters);
void nl_sysfs_master(unsigned number);
void nl_erase(const char *what); /* removes a file of that directory */
/* Create the bus of "w1:netlink/root=...", followed by rest. */
void nl_create(const char *rest);
/* Create the bus, and wait until it is up. */
void nl_start(void);
void nl_close(void);
struct sim_slave *nl_thermometer(unsigned channel, unsigned id, double value);

/* Do one request past every cache; the answer is valid until the next request. */
const struct bus_answer *nl_ask(enum bus_op op, const char *path, const char *value);
/* "/28.../property" */
const char *nl_path(const struct sim_slave *slave, const char *property);
int nl_read(const struct sim_slave *slave, const char *property);
int nl_write(const struct sim_slave *slave, const char *property, const char *value);
void nl_reads(const struct sim_slave *slave, const char *property, const char *expected);
void nl_lists(const char *directory, const char *expected);
bool nl_told(enum bus_news news, const char *part);
