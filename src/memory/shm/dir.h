/* SPDX-License-Identifier: MIT */
/*
 * The directory that has the files of owsd's instances. Nobody but its owner can make a name in it.
 * Blocking: file-system calls, and reads /etc/passwd; one thread.
 */
#pragma once

#include <sys/types.h>

#define DIR_PATH 192
#define DIR_SERVICE "/run/owsd"

struct shm_dir {
	int fd; /* -1: not open */
	char path[DIR_PATH];
};

/*
 * The directory of this user's owsd: OWS_DIR of the environment; else /run/owsd of root and of the
 * user owsd; else $XDG_RUNTIME_DIR/owsd; else /dev/shm/owsd-UID. Returns 0, or -EINVAL when OWS_DIR
 * is no absolute path or too long.
 */
int dir_own(char path[DIR_PATH]);
/*
 * The directories where a program finds instances, in this order: OWS_DIR alone; else its own and
 * the service's. Returns their number, or -EINVAL as dir_own().
 */
#define DIRS 2
int dir_list(char path[DIRS][DIR_PATH]);
/*
 * Open the directory and check it. -ENOENT: there is none; -EACCES; -EPERM: it is a link or no
 * directory, or its owner is neither root nor owsd nor the caller, or others may write into it.
 * dir->path is set in any case.
 */
int dir_open(const char *path, struct shm_dir *dir);
/* Open this user's own directory, made first (mode 0755) if missing. 0 or a negative errno. */
int dir_make(struct shm_dir *dir);
void dir_close(struct shm_dir *dir);
/* What is wrong with a directory that could not be made or opened, and what to do. */
#define DIR_FAULT (DIR_PATH + 200)
const char *dir_fault(const struct shm_dir *dir, int err, char text[DIR_FAULT]);
