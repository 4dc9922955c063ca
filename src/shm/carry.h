/* SPDX-License-Identifier: MIT */
/* Commands carried from an older segment into a new one. */
#ifndef SHM_CARRY_H
#define SHM_CARRY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct commands;

/*
 * Carry what was commanded from an older segment over to a new one, by name, type and path. old
 * may be anything: it is checked before use. It must be retired before (commands_state() or
 * commands_retire()), then no set is lost. After a restart _ReadEnable and _WriteEnable are not
 * carried, after a reload they are. What stands in force again is the engine's matter. Returns how
 * many slots were carried over, -EPROTO when old is no command segment of this layout.
 */
int commands_carry(struct commands *to, const void *old, size_t old_size, bool restart);
/*
 * The same from a segment of this process into one that no consumer has seen, after a reload: rows[i]
 * is the slot - 1 from which slot i + 1 is carried, 0xffffffff: from none.
 */
void commands_carry_rows(struct commands *to, const struct commands *from, const uint32_t *rows);

#endif
