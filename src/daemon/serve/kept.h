/* SPDX-License-Identifier: MIT */
/*
 * Reads that need no bus: properties that are inputs of the table and were read lately, and answers
 * that clients got lately. The life of an answer is as in owserver's cache, but shorter where the
 * control program may have changed the property: 2 s; and 300 s for a property that never changes.
 */
#pragma once

#include "src/config/read/config.h"
#include "src/daemon/serve/node.h"
#include "src/memory/shm/image.h"

#define KEPT_TEXT_MAX 104

struct kept;

/* Allocates. NULL: no memory. */
struct kept *kept_create(const struct config *config);
void kept_destroy(struct kept *kept);

/* The text, as a bus would give it, or -ENOENT. image is of the same config. Returns the length. */
int kept_find(struct kept *kept, const struct image *image, const struct node *node, int64_t now_ns,
              char *text, size_t room);
/* Keep the answer of a bus, if the property may be kept at all. */
void kept_add(struct kept *kept, const struct node *node, int64_t measured_ns, const uint8_t *text,
              size_t len);
/*
 * Forget the answers of a device after a write, or a try to write, to one of its properties. Inputs
 * of the table that were measured before do not answer for it any more.
 */
void kept_forget(struct kept *kept, const struct node *node, int64_t now_ns);

/* The record of the signal that has this path as output or input; -1: there is none. */
int kept_signal(const struct kept *kept, const char *path, bool output);
bool kept_has_outputs(const struct kept *kept);
/* The record of the first output that a write of this path would change, too; -1: there is none. */
int kept_changes(const struct kept *kept, const char *path);
/*
 * The first record from that one on of an output that has its device by an alias, and that a write
 * of the property ("/PIO.0") of a device would change if the alias is that of the device; its path
 * in *output. -1: there is none.
 */
int kept_by_alias(const struct kept *kept, int from, const uint8_t rom[ROM_LEN],
                  const char *property, struct node *output);
