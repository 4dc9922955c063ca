/* SPDX-License-Identifier: MIT */
/* The masters of a target, and each as a link: master.c and link.c work on it. */
#pragma once

#include "hal/native/limits.h"
#include "hal/w1/thermometer.h"
#include "hal/wire/link.h"

#define W1_MASTERS NATIVE_CHANNELS

struct w1_master;

struct w1_link {
	struct link link;
	struct w1_master *master;
	struct w1_bulk bulk;    /* its number */
	struct w1_slave *slave; /* that was selected since the last reset */
};

struct w1_master {
	struct link_master master;
	struct w1_tree tree;
	struct w1_slaves slaves;
	unsigned only; /* w1_bus_masterN; 0: all */
	unsigned count;
	struct w1_link links[W1_MASTERS];
	int uevents;        /* socket; -1: none */
	int64_t uevents_ns; /* when to look at it */
};
