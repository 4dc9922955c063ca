/* SPDX-License-Identifier: MIT */
/* Sleep on a word of the shared memory, and wake the threads that sleep there. */
#include <errno.h>
#include <linux/futex.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include "hal/base/time.h"
#include "src/memory/shm/futex.h"

/*
 * The plain call takes the kernel's old timespec of two longs. Where time_t is wider than long, the
 * C library's timespec differs from that one, and the kernel would read half of it.
 */
#ifdef SYS_futex_time64
#define FUTEX_CALL (sizeof(time_t) > sizeof(long) ? SYS_futex_time64 : SYS_futex)
#else
#define FUTEX_CALL SYS_futex
_Static_assert(sizeof(time_t) == sizeof(long), "the futex call needs its 64-bit form");
#endif

/* About ten years: no limit in practice, and no overflow in the kernel. */
#define LONGEST_NS (INT64_C(315360000) * NS_PER_S)

int segment_wait(const uint32_t *word, uint32_t seen, int64_t timeout_ns)
{
	int64_t ns = timeout_ns < LONGEST_NS ? timeout_ns : LONGEST_NS;
	struct timespec ts = timespec_of(ns);
	int saved = errno, err = 0;

	if (syscall(FUTEX_CALL, word, FUTEX_WAIT, seen, timeout_ns < 0 ? NULL : &ts, NULL, 0) < 0)
		err = errno == EAGAIN ? 0 : -errno;
	errno = saved;
	return err;
}

int segment_wake(const uint32_t *word, int how_many)
{
	int saved = errno;
	long woken = syscall(SYS_futex, word, FUTEX_WAKE, how_many, NULL, NULL, 0);

	if (woken < 0)
		woken = -errno;
	errno = saved;
	return (int)woken;
}
