/* SPDX-License-Identifier: MIT */
/*
 * The room of target "w1": what the kernel's 1-Wire drivers show under /sys/bus/w1/devices, as a
 * native bus. It may use hal/native and what is below that; of a chip it knows the names of its
 * areas and properties. Target "w1:netlink" is in hal/netlink, which stands on this room.
 *
 *   master.c   the masters, and the bus over them
 *   link.c     a master as a link; the lists of slaves, the alarms
 *   state.h    what these two work on
 *   driver.c   which driver has a slave, and what it offers; the drivers of memories, the DS2438
 *   thermometer.c switches.c   more drivers: areas made of attributes
 *   slave.c    what is remembered of a slave; its attributes
 *   tree.c     one attribute read or written, and what its errors mean
 *   uevent.c   the kernel tells that slaves and masters come and go
 *   name.c     28.551DDF030000 is 28-000003df1d55
 *
 * Room hal/w1: the masters of the kernel, by sysfs: areas that its drivers give.
 */
#pragma once

#include "hal/bus/bus.h"
#include "hal/wire/link.h"

/* Without "netlink" in its target: hal/netlink has the bus of both. */
extern const struct bus_ops w1_sysfs_bus;

extern const struct link_master_ops w1_master;

/* For hal/netlink. N of the w1_bus_masterN that the target names; 0: all. */
unsigned w1_master_only(const struct link_master *master);
/* Has the kernel w1_bus_masterN now? */
bool w1_master_has(const struct link_master *master, unsigned number);
/* Does not hear from the kernel of slaves and masters any more, until it is opened again. */
void w1_master_deafen(struct link_master *master);
