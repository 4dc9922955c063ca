/* SPDX-License-Identifier: MIT */
/* A place of the test's own, instead of that of an owsd which may run on this machine. */
#pragma once

#include "src/memory/shm/dir.h"

/*
 * The directory, made at the first call and named in OWS_DIR, for libows and for programs that the
 * test starts; removed with all that is in it when the test ends.
 */
const struct shm_dir *folder_dir(void);
/* The path of an instance's file there; overwritten by the next call. */
const char *folder_file(const char *instance, const char *what);
