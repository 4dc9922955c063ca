/* SPDX-License-Identifier: MIT */
/*
 * Which command is in force: section 3 of docs/semantics.md, "A command is in force". What is here
 * remembers each change for the owsd after this one.
 */
#pragma once

#include "src/daemon/engine/state.h"

struct force_left;

/* At a start: what becomes of the commands that the owsd before left (NULL: of none). */
void engine_resume(struct engine *e, const struct force_left *left);

/*
 * A controller's command, checked, becomes the one in force. The text of a string stands in text,
 * else NULL.
 */
void engine_command(struct engine *e, struct signal *s, uint32_t controller,
                    const struct controller_command *command, const char *text, uint32_t len);
/* The controller as it commands for that person, an index of its memory; 0: for itself. */
struct ows_who engine_who(const struct known_controller *g, uint32_t person);
/*
 * Take the beat of a connected controller, and what it promised: before its commands, so that the
 * next owsd knows it with them. A promise begins with a beat.
 */
void engine_hear(struct engine *e, uint32_t seat);
/* If the bus has the command in force, and the disk if it has to: its controller gets to know. */
void engine_settle(struct engine *e, struct signal *s);
/* A write has ended well, and its command is no longer the one in force. */
void engine_settle_earlier(struct engine *e, struct signal *s, const struct slot *slot);
/* Look whether more was stored on the disk. */
void engine_look_stored(struct engine *e);

/*
 * The controller of this index is lost: outputs of it go to SafeValue when their time is over.
 * Returns how many went; *next gets when the next one's time is over, INT64_MAX: all are done. Both
 * are awake time.
 */
unsigned engine_lose(struct engine *e, uint32_t controller, int64_t awake_ns, int64_t *next);
/*
 * All rows of a controller go to another index. CONTROLLER_NOBODY: their commands stay in force,
 * and no controller answers for them.
 */
void engine_hand_over(struct engine *e, uint32_t from, uint32_t to);
/* The controller came back, and got its rows at to: their commands are in force again. */
void engine_come_back(struct engine *e, uint32_t to);

/*
 * After a reload has adopted rows and controllers: link each row to its controller again, and store
 * the commands.
 */
void engine_in_force_adopted(struct engine *e);

/* Remember the controller of this index for the owsd after this one. */
void engine_remember_controller(struct engine *e, uint32_t controller);
