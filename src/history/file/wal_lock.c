/* SPDX-License-Identifier: MIT */
/* A VFS of SQLite, the default one with another xShmLock(). */
#include "src/history/file/wal_lock.h"

#include <sqlite3.h>
#include <stddef.h>
#include <stdint.h>

#define NAME "owsd-history"
/* The first bytes: the writer's, the checkpoint's, that of recovery. Those of readers follow */
#define WRITERS 3

/* Behind the file of the default VFS. */
struct own {
	const sqlite3_io_methods *real;
	sqlite3_io_methods methods;
	uint8_t shared; /* bits: locks that are had for reading, in place of alone */
};

static sqlite3_vfs vfs;
static sqlite3_vfs *real;

static struct own *own_of(sqlite3_file *file)
{
	return (struct own *)(void *)((char *)file + real->szOsFile);
}

static int lock_shared(sqlite3_file *file, int offset, int n)
{
	struct own *own = own_of(file);

	for (int i = offset; i < offset + n; i++) {
		int rc = own->real->xShmLock(file, i, 1, SQLITE_SHM_LOCK | SQLITE_SHM_SHARED);

		if (rc != SQLITE_OK) {
			while (i-- > offset)
				own->real->xShmLock(file, i, 1,
				                    SQLITE_SHM_UNLOCK | SQLITE_SHM_SHARED);
			return rc;
		}
	}
	own->shared |= (uint8_t)(((1u << n) - 1) << offset);
	return SQLITE_OK;
}

static int shm_lock(sqlite3_file *file, int offset, int n, int flags)
{
	struct own *own = own_of(file);
	unsigned mask = ((1u << n) - 1) << offset;
	int rc = SQLITE_OK;

	if (!(flags & SQLITE_SHM_EXCLUSIVE) || offset + n > WRITERS)
		return own->real->xShmLock(file, offset, n, flags);
	if (flags & SQLITE_SHM_LOCK) {
		rc = own->real->xShmLock(file, offset, n, flags);
		return rc == SQLITE_BUSY ? lock_shared(file, offset, n) : rc;
	}
	if ((own->shared & mask) != mask)
		return own->real->xShmLock(file, offset, n, flags);
	own->shared &= (uint8_t)~mask;
	for (int i = offset; i < offset + n; i++)
		rc |= own->real->xShmLock(file, i, 1, SQLITE_SHM_UNLOCK | SQLITE_SHM_SHARED);
	return rc;
}

static int open_own(sqlite3_vfs *self, const char *name, sqlite3_file *file, int flags, int *got)
{
	int rc = real->xOpen(real, name, file, flags, got);
	struct own *own = own_of(file);

	(void)self;
	if (rc != SQLITE_OK || !(flags & SQLITE_OPEN_MAIN_DB) || file->pMethods->iVersion < 2)
		return rc;
	own->real = file->pMethods;
	own->methods = *file->pMethods;
	own->methods.xShmLock = shm_lock;
	own->shared = 0;
	file->pMethods = &own->methods;
	return SQLITE_OK;
}

const char *wal_lock_vfs(void)
{
	if (real != sqlite3_vfs_find(NULL)) {
		sqlite3_vfs_unregister(&vfs);
		real = sqlite3_vfs_find(NULL);
		vfs = *real;
		vfs.pNext = NULL;
		vfs.zName = NAME;
		vfs.szOsFile = (int)((size_t)real->szOsFile + sizeof(struct own));
		vfs.xOpen = open_own;
	}
	return sqlite3_vfs_register(&vfs, 0) == SQLITE_OK ? NAME : NULL;
}
