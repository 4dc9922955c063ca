/* SPDX-License-Identifier: MIT */
/*
 * Soft devices of Inferno Embedded, family ED: lights, switches, relays, and the updater of their
 * firmware. A command ends with the CRC8 of the ROM id and of itself; the device answers 0 if it
 * has taken it, then bytes without a checksum.
 */
#pragma once

#include "hal/chips/family.h"

/* device.kind */
enum inferno_kind {
	INFERNO_UNKNOWN,
	INFERNO_LIGHTS,
	INFERNO_UPDATER,
	INFERNO_SWITCHES,
	INFERNO_OTHER,
};
/* family.identify */
int inferno_identify(struct txn *txn);

property_function inferno_read_device, inferno_enter_update;
/* arg: INFERNO_PORT(what, port); a count: INFERNO_PORT(what, 0: ports, 1: channels). */
property_function inferno_read_count, inferno_read_port, inferno_write_port;
property_function inferno_set_type, inferno_refresh, inferno_read_light, inferno_write_light;
property_function inferno_command; /* arg: the command, which has no bytes */
property_function inferno_read_range, inferno_read_size;

enum inferno_port { INFERNO_SWITCH, INFERNO_LED, INFERNO_STATE, INFERNO_MODE, INFERNO_TIMEOUT };
#define INFERNO_PORT(what, port) ((what) << 8 | (port))
