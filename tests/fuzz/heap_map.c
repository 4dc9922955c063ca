/* SPDX-License-Identifier: MIT */
/* libows' map.c with the heap in the place of /dev/shm, where a real owsd may be. */
#include "tests/fuzz/heap_instance.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

struct heap_file heap_image_file, heap_command_file;
enum { IMAGE_FD = 1000, COMMAND_FD };

static struct heap_file *file_of(int fd)
{
	return fd == IMAGE_FD ? &heap_image_file : &heap_command_file;
}

static int heap_open(const char *path, int flags)
{
	/* an instance may be named so, too */
	int fd = strcmp(strrchr(path, '.'), ".command") ? IMAGE_FD : COMMAND_FD;

	TEST_ASSERT_EQUAL_MESSAGE(fd == COMMAND_FD, (flags & O_ACCMODE) == O_RDWR, path);
	errno = ENOENT;
	return file_of(fd)->base ? fd : -1;
}

static int heap_stat(int fd, struct stat *st)
{
	*st = (struct stat){
		.st_mode = S_IFREG, .st_uid = getuid(), .st_size = (off_t)file_of(fd)->size};
	return 0;
}

#define open(path, flags) heap_open(path, flags)
#define fstat(fd, st) heap_stat(fd, st)
#define close(fd) ((void)(fd))
#define mmap(at, size, prot, flags, fd, off) ((void *)file_of(fd)->base)
#define munmap(at, size) ((void)(at))
#define lstat(path, st) ((void)(path), heap_stat(IMAGE_FD, st))
#include "src/libows/map.c"
