/* SPDX-License-Identifier: MIT */
/*
 * A directory on its way to a client: names are gathered from one target or several, each once, and
 * then made into the answer the client asked for. One of a few large rooms; untouched pages of it
 * cost nothing.
 */
#ifndef SERVE_DIRECTORY_H
#define SERVE_DIRECTORY_H

#include "src/serve/buses.h"
#include "src/serve/node.h"

#define DIRECTORY_RAW (256 * 1024)
#define DIRECTORY_OUT (768 * 1024)
#define DIRECTORY_SEEN 32768

struct directory {
	bool used;
	uint32_t len; /* bytes of raw: names, each ended by '\n' */
	uint32_t count;
	uint32_t flags; /* of the devices, as the protocol has them */
	uint32_t mark;  /* where the present target's part begins */
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
/* Where the next target puts its full paths, each ended by '\n', and how much room there is. */
uint8_t *directory_room(struct directory *directory, uint32_t *room);
/*
 * len bytes were put there by this target: keep the last component of each path, numbered as
 * clients count buses, that was not there before.
 */
void directory_take(struct directory *directory, const struct node *node, struct buses *buses,
                    unsigned target, uint32_t len);
/* One name; false: no room. */
bool directory_add(struct directory *directory, const char *name, size_t len);

void directory_add_once(struct directory *directory, const char *name);

/* What stands in the root beside the devices. */
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
/* Make the whole answer in directory->out. 0 or -EMSGSIZE. */
int directory_form(struct directory *directory, const struct directory_form *form);

#endif
