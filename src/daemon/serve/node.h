/* SPDX-License-Identifier: MIT */
/*
 * The meaning of a client's path: a part of the targets' namespace, a signal, a return code. Pure
 * functions.
 *
 *     [/uncached|/alarm|/bus.N]... device/property      what the targets have
 *     /signals/room1_Age                                the table
 *     /settings/return_codes/text.5
 */
#pragma once

#include "hal/chips/family.h"
#include "hal/owfs/path.h"

#define NODE_PATH_MAX (PATH_LEN_MAX + 32)

enum node_kind {
	NODE_NONE,    /* the path cannot exist */
	NODE_TARGET,  /* what the targets have */
	NODE_SIGNALS, /* the directory of the signals */
	NODE_SIGNAL,
	NODE_CODES, /* the directory of the return codes */
	NODE_CODE,
};

struct node {
	uint8_t kind;
	bool fresh;
	bool uncached; /* the path begins with /uncached */
	bool devices;  /* a directory with devices: the root, /alarm, or that of a bus */
	bool root;     /* the root directory: / or /uncached */
	bool every;    /* each target has a part of the directory */
	bool slash;    /* the path ends with a slash, as only the path of a directory may */
	int bus;       /* N of bus.N as clients count them, -1: none */
	bool has_device, has_rom;
	uint8_t rom[ROM_LEN];
	char type;           /* of the property: a letter of /structure, 0: not known */
	char life;           /* of the property: a letter of /structure, 0: not known */
	uint32_t bytes;      /* of the property's value if it is binary, 0: not known */
	int code;            /* NODE_CODE: the code, -1: all codes */
	const char *name;    /* NODE_SIGNAL: the signal or attribute, up to the end of the path */
	uint16_t device_len; /* bytes of path up to and with the device */
	/* for a target: without /uncached and /bus.N, ids as 28.551DDF030000 */
	char path[NODE_PATH_MAX];
};

void node_parse(const char *path, size_t len, struct node *node);
/* Is the name in the list, which NULL ends? */
bool node_is_in(const char *const *names, const char *name, size_t len);
/* Is this name, an entry of the directory, a directory itself? */
bool node_is_directory(const struct node *directory, const char *name, size_t len);
