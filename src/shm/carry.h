/* SPDX-License-Identifier: MIT */
/* Commands carried from an older segment into a new one. */
#ifndef SHM_CARRY_H
#define SHM_CARRY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct commands;

/*
 * Carry the commands over from an older segment to a new one, by name, type and path. old may be
 * anything: this function checks it before use. The caller retires old before (commands_state() or
 * commands_retire()), so that no set is lost. After a restart _ReadEnable and _WriteEnable are not
 * carried, after a reload they are. The engine decides which commands are in force again. Returns
 * how many slots were carried over, -EPROTO when old is no command segment of this layout.
 */
int commands_carry(struct commands *to, const void *old, size_t old_size, bool restart);
/*
 * The same after a reload, from a segment of this process into a segment that no consumer has seen:
 * slot i + 1 is carried from slot rows[i] + 1, or from none if rows[i] is 0xffffffff.
 */
void commands_carry_rows(struct commands *to, const struct commands *from, const uint32_t *rows);

#endif
