/* SPDX-License-Identifier: MIT */
/* libows' map.c with the heap in the place of files. */
#include "tests/fuzz/heap_instance.h"

#include <errno.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "src/memory/shm/dir.h"

struct heap_file heap_image_file;
enum { IMAGE_FD = 1000 };

static int heap_open(const char *path, int flags)
{
	TEST_ASSERT_EQUAL_MESSAGE(O_RDONLY, flags & O_ACCMODE, path);
	errno = ENOENT;
	return heap_image_file.base ? IMAGE_FD : -1;
}

static int heap_stat(struct stat *st)
{
	*st = (struct stat){
		.st_mode = S_IFREG, .st_uid = getuid(), .st_size = (off_t)heap_image_file.size};
	return 0;
}

#define openat(dir, path, flags) ((void)(dir), heap_open(path, flags))
#define dir_open(path, dir) ((void)(path), (dir)->fd = -1, 0)
#define dir_close(dir) ((void)(dir))
#define fstat(fd, st) ((void)(fd), heap_stat(st))
#define close(fd) ((void)(fd))
#define mmap(at, size, prot, flags, fd, off) ((void *)heap_image_file.base)
#define munmap(at, size) ((void)(at))
#define lstat(path, st) ((void)(path), heap_stat(st))
#include "src/memory/libows/map.c"
