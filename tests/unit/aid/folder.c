/* SPDX-License-Identifier: MIT */
/* A place of the test's own: a directory of its own in $TMPDIR. */
#include <ftw.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include "unity.h"

#include "src/memory/shm/segment.h"
#include "tests/unit/aid/folder.h"

static struct shm_dir dir = {.fd = -1};
static pid_t maker;

static int remove_one(const char *path, const struct stat *st, int kind, struct FTW *at)
{
	(void)st;
	(void)kind;
	(void)at;
	return remove(path);
}

/* A child of the test leaves the folder alone. */
static void remove_folder(void)
{
	if (getpid() == maker)
		nftw(dir.path, remove_one, 4, FTW_DEPTH | FTW_PHYS);
}

const struct shm_dir *folder_dir(void)
{
	char path[DIR_PATH];
	const char *tmp = getenv("TMPDIR");

	if (dir.fd >= 0)
		return &dir;
	snprintf(path, sizeof(path), "%s/owsd-unit-XXXXXX", tmp ? tmp : "/tmp");
	TEST_ASSERT_NOT_NULL(mkdtemp(path));
	TEST_ASSERT_EQUAL(0, setenv("OWS_DIR", path, 1));
	TEST_ASSERT_EQUAL(0, dir_make(&dir));
	maker = getpid();
	atexit(remove_folder);
	return &dir;
}

const char *folder_file(const char *instance, const char *what)
{
	static char path[DIR_PATH + SEGMENT_FILE + 8];

	snprintf(path, sizeof(path), "%s/%s.%s", folder_dir()->path, instance, what);
	return path;
}
