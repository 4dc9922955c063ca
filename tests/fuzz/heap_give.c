/* SPDX-License-Identifier: MIT */
/*
 * libows' give.c and meet.c with the heap in the place of a sealed memory: a connection is always
 * there, and each welcome brings the memory that stands in heap_controller_file.
 */
#include "tests/fuzz/heap_instance.h"

#include <errno.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "src/memory/libows/join.h"
#include "src/memory/shm/dir.h"

struct heap_file heap_controller_file;
enum { CONTROLLER_FD = 1002 };

void join_none(struct join *join)
{
	*join = (struct join){.connection = -1, .bell = -1, .news = -1, .epoll = -1, .timer = -1};
}

void join_end(struct join *join)
{
	join->connection = join->bell = join->news = -1;
}

void join_leave(struct join *join)
{
	join_end(join);
}

int join_begin(struct join *join, int directory, const char *file, const char *program,
               uint32_t flags)
{
	(void)directory;
	(void)file;
	(void)program;
	(void)flags;
	if (!heap_controller_file.base)
		return -ENOENT;
	join->connection = CONTROLLER_FD;
	join->new = true;
	return 0;
}

/* The welcome says what owsd has made, whatever became of that since. */
int join_receive(struct join *join, int64_t until_ns, struct ows_welcome *welcome, int *memory)
{
	(void)until_ns;
	if (!join->new)
		return -EAGAIN;
	join->new = false;
	*welcome = (struct ows_welcome){
		.magic = OWS_WELCOME_MAGIC,
		.major = OWS_LAYOUT_MAJOR,
		.generation = heap.layout.header.generation,
		.start_id = heap.layout.header.start_id,
		.serial = 1,
		.size = (uint32_t)heap_controller_file.size,
	};
	*memory = CONTROLLER_FD;
	return 0;
}

/* Whoever waits for another welcome has waited. */
bool join_await(int connection, int64_t until_ns)
{
	(void)connection;
	(void)until_ns;
	return false;
}

static int heap_stat(struct stat *st)
{
	*st = (struct stat){.st_size = (off_t)heap_controller_file.size};
	return 0;
}

#define fcntl(fd, what) ((void)(fd), F_SEAL_SEAL | F_SEAL_SHRINK | F_SEAL_GROW)
#define fstat(fd, st) ((void)(fd), heap_stat(st))
#define close(fd) ((void)(fd))
#define mmap(at, size, prot, flags, fd, off) ((void *)heap_controller_file.base)
#define munmap(at, size) ((void)(at))
#include "src/memory/libows/give.c"
#undef mmap
#undef munmap
#define dir_open(path, dir) ((void)(path), (dir)->fd = -1, 0)
#define dir_close(dir) ((void)(dir))
#include "src/memory/libows/meet.c"

int join_watch(struct join *join)
{
	(void)join;
	return 0;
}

void join_hush(struct join *join)
{
	(void)join;
}
