/* SPDX-License-Identifier: MIT */
/*
 * What was commanded, for the next owsd. NAME.force: which commands are in force, over a kill; the
 * engine writes into a mapping, each entry in two slots, so that a kill leaves one whole. NAME.last
 * is its stored part, the commands of outputs with Start "last", over a power cut; the host writes
 * all of it to the disk. The next owsd reads what was left, once and before it runs. No system
 * calls. One thread puts; any may get.
 */
#pragma once

#include <stdbool.h>

#include "src/public/ows_layout.h"

struct force_signal {
	const char *name;
	const char *path;
	uint8_t type;
};
struct force_plan {
	const struct force_signal *signals;
	uint32_t signal_count;
	uint16_t text_cap; /* of every string signal, a multiple of 4 */
	uint64_t boot;     /* names this boot of the machine; 0: what is stored outlasts it */
	bool stored;       /* without controllers: none of them outlasts a boot */
};
struct force {
	char *base;
	uint32_t row_off, row_count, controller_off, controller_count, text_cap;
};

/* Bytes that the plan needs; 0 if that is more than 2 GiB. */
size_t force_size(const struct force_plan *plan);
/* Lay out zeroed memory, aligned to 8: no command is in force. */
void force_build(const struct force_plan *plan, void *memory, struct force *force);

#define FORCE_CONTROLLERS 256
#define FORCE_NOBODY FORCE_CONTROLLERS

struct force_controller {
	struct ows_who who;
	uint8_t token[16];
	uint32_t period_ms; /* promised; 0: none */
	uint32_t goodbye;
};
struct force_command {
	int64_t value;
	uint32_t len; /* strings: bytes of text */
	uint32_t stamp;
	bool given;          /* false: no program's command is in force */
	bool safe;           /* SafeValue is */
	bool applied;        /* on the bus, and its controller knows */
	uint32_t controller; /* an index; FORCE_NOBODY: none would come back for it */
};
/* who.serial 0: the index is free. */
void force_controller(struct force *force, uint32_t index,
                      const struct force_controller *controller);
/* text: of strings, else NULL. */
void force_put(struct force *force, uint32_t row, const struct force_command *command,
               const char *text);

/* The newest command of a row; text has room for text_cap bytes, NULL for a number. */
void force_get(const struct force *force, uint32_t row, struct force_command *command, char *text);

/* What an owsd before left. */
struct force_left {
	struct force force;     /* only to be read */
	struct force_key *keys; /* sorted; allocated */
};
/*
 * Check what was left: every number, and that all is whole. Returns 0, -EPROTO: it is damaged or of
 * another version; -ESTALE: it is of another boot of the machine; -ENOMEM. memory stays mapped
 * until force_close().
 */
int force_open(const void *memory, size_t size, uint64_t boot, struct force_left *left);
void force_close(struct force_left *left);
/* A signal of the configuration: what is left by its name, path and type is no other signal's. */
void force_keep(const struct force_left *left, const struct force_signal *signal);
/*
 * The command of a signal, and the text of a string (text has room bytes). It is left by the name,
 * path and type, else, for a renamed signal, by path and type alone, if that is one and not kept.
 * False: there is none.
 */
bool force_find(const struct force_left *left, const struct force_signal *signal,
                struct force_command *command, char *text, size_t room);
/* Returns whether the controller of this index was known. */
bool force_find_controller(const struct force_left *left, uint32_t index,
                           struct force_controller *controller);
