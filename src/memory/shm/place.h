/* SPDX-License-Identifier: MIT */
/*
 * The place: the directory of owsd that has the files of its instances. Nobody but its owner can
 * make a name in it. Blocking: file-system calls, and reads /etc/passwd; one thread.
 */
#pragma once

#include <stddef.h>
#include <sys/types.h>

#define PLACE_PATH 192
#define PLACE_SERVICE "/run/owsd"

struct shm_place {
	int fd; /* -1: not open */
	char path[PLACE_PATH];
};

/*
 * The place of this user's owsd: OWS_DIR of the environment; else /run/owsd of root and of the
 * user owsd; else $XDG_RUNTIME_DIR/owsd; else /dev/shm/owsd-UID. Returns 0, or -EINVAL when OWS_DIR
 * is no absolute path or too long.
 */
int place_own(char path[PLACE_PATH]);
/*
 * The places where a program finds instances, in this order: OWS_DIR alone; else its own place and
 * the service's. Returns their number, or -EINVAL as place_own().
 */
#define PLACES 2
int place_list(char path[PLACES][PLACE_PATH]);
/*
 * Open the place and check it. -ENOENT: there is none; -EACCES; -EPERM: it is a link or no
 * directory, or its owner is neither root nor owsd nor the caller, or others may write into it.
 * place->path is set in any case.
 */
int place_open(const char *path, struct shm_place *place);
/* Open this user's own place, made first (mode 0755) if it is missing. 0 or a negative errno. */
int place_make(struct shm_place *place);
void place_close(struct shm_place *place);
/* What is wrong with a place that could not be made or opened, and what to do. */
#define PLACE_FAULT (PLACE_PATH + 200)
const char *place_fault(const struct shm_place *place, int err, char text[PLACE_FAULT]);
