/* SPDX-License-Identifier: MIT */
/*
 * The writer's locks of SQLite's shared memory, which no reader can keep from it. To lock a part of
 * a file for reading asks for no more than the right to read: a reader that holds that lock on what
 * SQLite's writer locks would stop the writer for as long as it likes.
 */
#pragma once

/*
 * The name of a VFS for sqlite3_open_v2(): the default one, but where a lock of the writer is
 * refused because others have it for reading, it is taken for reading too. That keeps out all who
 * would write, as before. NULL: no memory; the default VFS will do.
 */
const char *wal_lock_vfs(void);
