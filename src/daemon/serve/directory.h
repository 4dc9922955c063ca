/* SPDX-License-Identifier: MIT */
/*
 * A directory on its way to a client: its names are gathered from one target or several, each once,
 * and then made into the answer that the client asked for. The server has a few of these large
 * structs; their untouched pages cost no memory.
 */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "src/daemon/serve/node.h"

/*
 * /bus.N over several targets: each bus of each target has one number for the life of owsd. Numbers
 * are given in the order of the targets that are up when clients first ask. When all numbers are
 * given, the numbers of targets that a reload removed are given again, the lowest first.
 */
#define BUSES_MAX 256
#define BUSES_NO_TARGET 255 /* a reload removed the target; no target has this index */

struct buses {
	unsigned count;
	struct {
		uint8_t target;
		uint16_t number; /* the number that the target itself has for the bus */
	} bus[BUSES_MAX];
};

/* The number of a target's bus; gives it one if it has none. -1: all numbers are in use. */
int buses_number(struct buses *buses, unsigned target, unsigned number);
/*
 * After a reload: target i was target ports[i] before, or is new where that is -1. All numbers
 * stay, also those of removed targets.
 */
void buses_renumber(struct buses *buses, const int *ports, unsigned count);
/* The N of a name "bus.N", -1: the name has another form. */
int buses_parse(const char *name, unsigned len);

#define DIRECTORY_RAW (256 * 1024)
#define DIRECTORY_OUT (768 * 1024)
#define DIRECTORY_SEEN 32768

struct directory {
	bool used;
	uint32_t len; /* bytes of raw: names, each ended by '\n' */
	uint32_t count;
	uint32_t flags; /* of the devices' families, as the protocol defines them */
	uint32_t mark;  /* where the part of the present target begins in raw */
	uint32_t out_len;
	char raw[DIRECTORY_RAW];
	uint8_t out[DIRECTORY_OUT];
	uint32_t seen[DIRECTORY_SEEN]; /* hash set of offsets + 1 */
};

static inline void directory_release(struct directory *directory)
{
	directory->used = false;
}

void directory_begin(struct directory *directory);
/* The place, and its size, where the next target puts its full paths, each ended by '\n'. */
uint8_t *directory_room(struct directory *directory, uint32_t *room);
/*
 * Take the len bytes that this target has put into directory_room(): keep the last component of
 * each path that the directory does not have yet, with buses numbered as clients count them.
 */
void directory_take(struct directory *directory, const struct node *node, struct buses *buses,
                    unsigned target, uint32_t len);
/* Add one name; false: no room. */
bool directory_add(struct directory *directory, const char *name, size_t len);

void directory_add_once(struct directory *directory, const char *name);

/* Add the entries of the root that are no devices. */
void directory_add_rest(struct directory *directory, const struct node *node,
                        const struct buses *buses);

struct directory_form {
	const struct node *node;
	const char *prefix; /* the path as the client wrote it, without a slash at its end */
	size_t prefix_len;
	uint32_t flags; /* of the request */
	bool frames;    /* DIR: a frame for each entry */
	bool slash;     /* directories end with '/' */
};
/* Format the whole answer in directory->out. 0 or -EMSGSIZE. */
int directory_form(struct directory *directory, const struct directory_form *form);
