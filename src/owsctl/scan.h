/* SPDX-License-Identifier: MIT */
/* The devices of a target: found, looked at, and made into a table, JSON or a configuration. */
#ifndef OWSCTL_SCAN_H
#define OWSCTL_SCAN_H

#include "src/owsctl/json.h"
#include "src/owsctl/open.h"

/* What most people want of a device of some families. */
struct scan_property {
	const char *name; /* "temperature12" */
	const char *word; /* for the name of its signal: "temperature" */
	enum ows_type type;
	bool output;         /* what it has now is asked for, and kept */
	unsigned per_factor; /* 0: as owsd does by itself */
};

#define SCAN_PROPERTIES 4
struct scan_kind {
	const char *families;                           /* "22 28" */
	struct scan_property property[SCAN_PROPERTIES]; /* name NULL behind the last */
};

struct scan_value {
	int err;
	char text[64];
};

#define SCAN_TYPE 40
#define SCAN_ALIAS 64
struct scan_device {
	char path[24];     /* "/28.551DDF030000" */
	char location[16]; /* "bus.0" */
	uint8_t family;
	bool simulated;
	char type[SCAN_TYPE];         /* "" not told */
	char alias[SCAN_ALIAS];       /* "" none */
	const struct scan_kind *kind; /* NULL: none of ours */
	struct scan_value value[SCAN_PROPERTIES];
};

struct scan {
	struct scan_device *device; /* sorted by path */
	unsigned count;
};

/* The kind of a family, or NULL. */
const struct scan_kind *scan_kind_of(uint8_t family);

/* Find all devices and read them. CTL_DONE, or CTL_FAILED after having said why. */
int scan_target(struct target *target, struct scan *scan);
void scan_free(struct scan *scan);
/*
 * Nothing was found: say on stderr which board this is and what is missing there. Of a target that
 * is not this machine's hardware, nothing is said.
 */
void scan_board(const char *target);

/*
 * Print a configuration with that TargetName, which may be several; without outputs if inputs_only.
 * CTL_DONE, or CTL_FAILED after having said why; then nothing was printed.
 */
int scan_rio(const struct scan *scan, const char *target, bool several, bool inputs_only);

#endif
