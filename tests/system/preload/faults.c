/* SPDX-License-Identifier: MIT */
/*
 * Faults of the machine for a program that is started with this in LD_PRELOAD:
 *
 *   FAULT_MEMORY=N    the N-th allocation fails (malloc, calloc, realloc, mmap); N+: all from there
 *   FAULT_THREAD=N    the N-th thread cannot be made; a path: none, while that file is there
 *   FAULT_CLOCK=FILE  three 64-bit numbers: what CLOCK_REALTIME and CLOCK_BOOTTIME are ahead, in
 *                     ns; 0, or 1: the clock is not synchronised, 2: it is
 *   FAULT_BOOT=FILE   has the id of the boot
 *   FAULT_SOCKET=FILE a unix socket is a link to that file as soon as it is bound, as somebody
 *                     makes it who may write its folder
 *   FAULT_WATCH=FILE  epoll takes no descriptor, while that file is there
 *   FAULT_MARK=FILE   is made when one has happened
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/timex.h>
#include <sys/un.h>
#include <time.h>
#include <unistd.h>

extern void *__libc_malloc(size_t size);
extern void *__libc_calloc(size_t count, size_t size);
extern void *__libc_realloc(void *old, size_t size);

static unsigned long memory_at, memory_count, thread_at, thread_count;
static int memory_on;
static const char *thread_file, *mark, *socket_file, *watch_file, *boot_file;
static const volatile int64_t *ahead;
static int (*next_thread)(pthread_t *, const pthread_attr_t *, void *(*)(void *), void *);
static int (*next_clock)(clockid_t, struct timespec *);
static int (*next_adjtimex)(struct timex *);
static int (*next_open)(const char *, int, ...);
static int (*next_epoll_ctl)(int, int, int, struct epoll_event *);
static int (*next_bind)(int, const struct sockaddr *, socklen_t);
static void *(*next_mmap)(void *, size_t, int, int, int, off_t);

__attribute__((constructor)) static void prepare(void)
{
	const char *text = getenv("FAULT_MEMORY"), *clock = getenv("FAULT_CLOCK");
	char *end = NULL;
	int fd;

	*(void **)&next_thread = dlsym(RTLD_NEXT, "pthread_create");
	*(void **)&next_clock = dlsym(RTLD_NEXT, "clock_gettime");
	*(void **)&next_adjtimex = dlsym(RTLD_NEXT, "adjtimex");
	*(void **)&next_open = dlsym(RTLD_NEXT, "open64"); /* which open is, by _FILE_OFFSET_BITS */
	*(void **)&next_mmap = dlsym(RTLD_NEXT, "mmap");
	*(void **)&next_epoll_ctl = dlsym(RTLD_NEXT, "epoll_ctl");
	*(void **)&next_bind = dlsym(RTLD_NEXT, "bind");
	mark = getenv("FAULT_MARK");
	socket_file = getenv("FAULT_SOCKET");
	watch_file = getenv("FAULT_WATCH");
	boot_file = getenv("FAULT_BOOT");
	thread_file = getenv("FAULT_THREAD");
	if (thread_file && *thread_file != '/')
		thread_at = strtoul(thread_file, NULL, 10);
	fd = clock ? open(clock, O_RDONLY | O_CLOEXEC) : -1;
	if (fd >= 0) {
		void *map = next_mmap(NULL, 3 * sizeof(int64_t), PROT_READ, MAP_SHARED, fd, 0);

		ahead = map == MAP_FAILED ? NULL : map;
		close(fd);
	}
	if (text) {
		memory_count = 0;
		memory_at = strtoul(text, &end, 10);
		memory_on = *end == '+';
	}
}

static int happens(void)
{
	int saved = errno, fd = mark ? open(mark, O_WRONLY | O_CREAT | O_CLOEXEC, 0600) : -1;

	if (fd >= 0)
		close(fd);
	errno = saved;
	return 1;
}

static int memory_fails(void)
{
	unsigned long n;

	if (!memory_at)
		return 0;
	n = __atomic_add_fetch(&memory_count, 1, __ATOMIC_RELAXED);
	return (n == memory_at || (memory_on && n > memory_at)) && happens();
}

void *malloc(size_t size)
{
	if (!memory_fails())
		return __libc_malloc(size);
	errno = ENOMEM;
	return NULL;
}

void *calloc(size_t count, size_t size)
{
	if (!memory_fails())
		return __libc_calloc(count, size);
	errno = ENOMEM;
	return NULL;
}

void *realloc(void *old, size_t size)
{
	if (!memory_fails())
		return __libc_realloc(old, size);
	errno = ENOMEM;
	return NULL;
}

void *mmap(void *at, size_t size, int protection, int flags, int fd, off_t offset)
{
	if (!memory_fails())
		return next_mmap(at, size, protection, flags, fd, offset);
	errno = ENOMEM;
	return MAP_FAILED;
}

int pthread_create(pthread_t *thread, const pthread_attr_t *attributes, void *(*run)(void *),
                   void *arg)
{
	int fails = 0;

	if (thread_at)
		fails = __atomic_add_fetch(&thread_count, 1, __ATOMIC_RELAXED) == thread_at;
	else if (thread_file)
		fails = access(thread_file, F_OK) == 0;
	if (!fails)
		return next_thread(thread, attributes, run, arg);
	happens();
	return EAGAIN;
}

int bind(int fd, __CONST_SOCKADDR_ARG address, socklen_t size)
{
	const struct sockaddr_un *local = address.__sockaddr_un__;
	int err = next_bind(fd, address.__sockaddr__, size);

	if (!err && socket_file && local->sun_family == AF_UNIX && unlink(local->sun_path) == 0 &&
	    symlink(socket_file, local->sun_path) == 0)
		happens();
	return err;
}

int epoll_ctl(int epoll, int op, int fd, struct epoll_event *event)
{
	if (op != EPOLL_CTL_ADD || !watch_file || access(watch_file, F_OK) != 0 || !happens())
		return next_epoll_ctl(epoll, op, fd, event);
	errno = ENOSPC;
	return -1;
}

/* Libraries of TLS look at it. */
time_t time(time_t *at)
{
	struct timespec now;

	clock_gettime(CLOCK_REALTIME, &now);
	if (at)
		*at = now.tv_sec;
	return now.tv_sec;
}

int clock_gettime(clockid_t clock, struct timespec *now)
{
	int err = next_clock(clock, now);
	int64_t ns = 0;

	if (!err && ahead)
		ns = clock == CLOCK_REALTIME ? ahead[0] : clock == CLOCK_BOOTTIME ? ahead[1] : 0;
	ns += now->tv_nsec;
	now->tv_sec += ns / 1000000000;
	now->tv_nsec = ns % 1000000000;
	if (now->tv_nsec < 0) {
		now->tv_nsec += 1000000000;
		now->tv_sec--;
	}
	return err;
}

int adjtimex(struct timex *state)
{
	int err = next_adjtimex(state);

	if (!ahead || !ahead[2])
		return err;
	state->status = ahead[2] == 1 ? STA_UNSYNC : 0;
	return 0;
}

int open64(const char *path, int flags, ...)
{
	va_list more;
	mode_t mode = 0;

	va_start(more, flags);
	if (flags & (O_CREAT | __O_TMPFILE))
		mode = va_arg(more, mode_t);
	va_end(more);
	if (boot_file && !strcmp(path, "/proc/sys/kernel/random/boot_id"))
		path = boot_file;
	return next_open(path, flags, mode);
}
