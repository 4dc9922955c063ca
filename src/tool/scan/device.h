/* SPDX-License-Identifier: MIT */
/*
 * The devices that a scan finds, and the properties and values of each.
 *
 * Room src/tool/scan: a target opened without an engine: its devices, and what they have.
 */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "hal/chips/family.h"
#include "src/public/ows.h"

/* What most people want of a device. */
struct scan_property {
	char name[PROPERTY_NAME_ROOM + 4]; /* "temperature12", "EDS0082/volts.3" */
	char word[24];                     /* for the name of its signal: "temperature", "volt_3" */
	enum ows_type type;
	bool output;         /* a scan reads the present value past the cache */
	unsigned per_factor; /* 0: owsd's default */
};

#define SCAN_PROPERTIES FAMILY_SCANS

struct scan_value {
	int err;
	double refused; /* of -EDOM: the number */
	char text[64];
};

#define SCAN_TYPE 40
#define SCAN_ALIAS 64
#define SCAN_IDENTITY 52
struct scan_device {
	char path[128];    /* "/28.551DDF030000", behind a coupler "/1F.x/main/28.y" */
	char location[16]; /* "bus.0" */
	uint8_t family;
	bool simulated;
	char type[SCAN_TYPE];         /* "": the target does not report it */
	char alias[SCAN_ALIAS];       /* "": no alias */
	char identity[SCAN_IDENTITY]; /* "DS18B20 clone, family B1"; "": the target has none */
	int err;                      /* which chip of its family it is cannot be found out: why */
	uint64_t has; /* a bit for each row of family.scan whose directory the chip has */
	struct scan_value value[SCAN_PROPERTIES];
};

struct scan {
	struct scan_device *device; /* sorted by path */
	unsigned count;
	bool disturbed; /* each search had a wrong checksum: the list is what was known before */
};
