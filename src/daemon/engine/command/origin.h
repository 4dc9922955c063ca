/* SPDX-License-Identifier: MIT */
/*
 * Who gave the command in force: the origins in the image, and the journal of commands. Whose
 * command was refused.
 */
#pragma once

#include "src/daemon/engine/state.h"

/* What a new command took the place of. */
struct origin_before {
	bool given;
	bool changes; /* the new command is another one */
	int64_t value;
};
struct origin_before origin_before(const struct signal *s, int64_t value, const char *text,
                                   uint32_t len);
/* The command in force of s is new: of this controller, for this reason. */
void engine_origin(struct engine *e, struct signal *s, enum ows_reason reason,
                   const struct ows_who *who, const struct origin_before *before);
/*
 * Enter the last command, which was not entered as it came: until now the journal had enough of the
 * signal. A reload: wait for that as before.
 */
void engine_origin_rest(struct engine *e, struct signal *s);
void engine_origin_wait(struct engine *e, const struct signal *s);
/* A reload: the origin of what was command record was before. */
void engine_origin_carry(struct engine *e, const struct signal *s, const struct engine *old,
                         uint32_t record);
/* A reload: owsd itself begins s with the command in force, which engine_resume() made. */
void engine_origin_begin(struct engine *e, struct signal *s);
/* Count and log a command that is not taken, or was not written before owsd ended (-ESTALE). */
void engine_refuse(struct engine *e, struct known_controller *g, const struct signal *s, int err);
