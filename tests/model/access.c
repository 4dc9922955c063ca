/* SPDX-License-Identifier: MIT */
/* What threads call: each access to a word that is tracked stops its thread. */
#include <assert.h>
#include <errno.h>
#include <limits.h>
#include <poll.h>
#include <stdarg.h>
#include <stdio.h>
#include <unistd.h>

#include "src/memory/shm/futex.h"
#include "tests/model/search.h"

uint64_t read_plain(const volatile void *at, size_t size)
{
	return size == 8 ? *(const volatile uint64_t *)at : *(const volatile uint32_t *)at;
}

void write_plain(volatile void *at, size_t size, uint64_t value)
{
	if (size == 8)
		*(volatile uint64_t *)at = value;
	else
		*(volatile uint32_t *)at = (uint32_t)value;
}

static struct step *ask(const struct step *step)
{
	struct thread *t = x.running;

	t->step = *step;
	thread_stop(t);
	t->history = mix(t->history, t->step.result);
	t->history = mix(t->history, (uint64_t)t->step.kind);
	t->loads += t->step.kind == LOAD;
	return &t->step;
}

/* Where an address is tracked: -1 not at all. A half of a double word has a shift. */
static int find(const volatile void *address, size_t size, unsigned *shift)
{
	const volatile char *at = address;

	for (unsigned i = 0; i < x.memory.locations; i++) {
		*shift = 0;
		if (at == x.tracked[i].at && size == x.tracked[i].size)
			return (int)i;
		if (size == 4 && x.tracked[i].size == 8 && at >= x.tracked[i].at &&
		    at < x.tracked[i].at + 8) {
			*shift = at == x.tracked[i].at ? 0 : 32;
			return (int)i;
		}
	}
	return -1;
}

uint64_t access_load(const volatile void *at, size_t size, int order, struct site *site)
{
	struct step step = {.kind = LOAD};
	int location = x.running ? find(at, size, &step.shift) : -1;

	if (location >= 0) {
		step.site = site_meet(site, LOAD, order);
		step.order = site_order(step.site, order);
		step.location = (unsigned)location;
		step.result = ask(&step)->result >> step.shift;
		return size == 4 ? (uint32_t)step.result : step.result;
	}
	if (size == 8 && x.running) {
		const volatile char *halves = at;

		/* Two words at once: taken for two loads, which is weaker */
		if (find(halves, 4, &step.shift) >= 0 || find(halves + 4, 4, &step.shift) >= 0) {
			uint64_t low = access_load(halves, 4, order, site);

			return low | access_load(halves + 4, 4, order, site) << 32;
		}
	}
	return read_plain(at, size);
}

void access_store(volatile void *at, size_t size, uint64_t value, int order, struct site *site)
{
	struct step step = {.kind = STORE, .value = value};
	int location = x.running ? find(at, size, &step.shift) : -1;

	if (location < 0) {
		write_plain(at, size, value);
		return;
	}
	assert(x.tracked[location].size == size);
	step.site = site_meet(site, STORE, order);
	step.order = site_order(step.site, order);
	step.location = (unsigned)location;
	if (size == 4)
		step.value = (uint32_t)value;
	ask(&step);
}

uint64_t combine(enum access_rmw how, uint64_t a, uint64_t b)
{
	switch (how) {
	case ACCESS_ADD:
		return (uint32_t)(a + b);
	case ACCESS_SUB:
		return (uint32_t)(a - b);
	case ACCESS_OR:
		return a | b;
	case ACCESS_AND:
		return a & (uint32_t)b;
	case ACCESS_SET:
		return (uint32_t)b;
	}
	return 0;
}

uint64_t access_rmw(volatile void *at, size_t size, enum access_rmw how, uint64_t operand,
                    int order, struct site *site)
{
	struct step step = {.kind = RMW, .how = how, .value = operand};
	int location = x.running ? find(at, size, &step.shift) : -1;
	uint64_t before;

	assert(size == 4);
	if (location < 0) {
		before = read_plain(at, size);
		write_plain(at, size, combine(how, before, operand));
		return before;
	}
	step.site = site_meet(site, RMW, order);
	step.order = site_order(step.site, order);
	step.location = (unsigned)location;
	return ask(&step)->result;
}

bool access_cas(volatile void *at, size_t size, uint64_t *expected, uint64_t value, int order,
                int failed, struct site *site)
{
	struct step step = {.kind = CAS, .value = value, .failed_order = failed};
	int location = x.running ? find(at, size, &step.shift) : -1;
	uint64_t before, wanted = *expected;

	assert(size == 4);
	if (location < 0) {
		before = read_plain(at, size);
		if (before == wanted)
			write_plain(at, size, value);
	} else {
		step.site = site_meet(site, CAS, order);
		step.order = site_order(step.site, order);
		step.location = (unsigned)location;
		step.expected = wanted;
		before = ask(&step)->result;
	}
	*expected = before;
	return before == wanted;
}

void access_fence(int order, struct site *site)
{
	struct step step = {.kind = FENCE};

	if (!x.running)
		return;
	step.site = site_meet(site, FENCE, order);
	step.order = site_order(step.site, order);
	if (step.order < 0)
		return;
	/* Only one that is sequentially consistent has to do with other threads */
	if (step.order == __ATOMIC_SEQ_CST)
		ask(&step);
	else
		weak_fence(&x.memory, thread_number(x.running), step.order);
}

/* In the place of src/memory/shm/futex.c; time does not pass here. */
int segment_wait(const uint32_t *word, uint32_t seen, int64_t timeout_ns)
{
	struct step step = {.kind = WAIT, .order = __ATOMIC_RELAXED, .expected = seen};
	int location = find(word, 4, &step.shift);

	(void)timeout_ns;
	assert(x.running);
	/* A word of one's own: it is a pause that is wanted */
	if (location < 0)
		return -ETIMEDOUT;
	step.location = (unsigned)location;
	ask(&step);
	return 0;
}

int segment_wake(const uint32_t *word, int how_many)
{
	struct step step = {.kind = WAKE, .value = (uint64_t)how_many};
	int location = find(word, 4, &step.shift);

	if (!x.running || location < 0)
		return 0;
	step.location = (unsigned)location;
	return (int)ask(&step)->result;
}

/* --- Bells ------------------------------------------------------------------------------------ */

static struct {
	uint32_t *rings, *heard;
} bells[3];

void access_bell(enum access_bells bell, uint32_t *rings, uint32_t *heard)
{
	bells[bell - ACCESS_BELL].rings = rings;
	bells[bell - ACCESS_BELL].heard = heard;
}

static bool is_bell(int fd)
{
	return fd >= ACCESS_BELL && fd <= ACCESS_ORDERING;
}

static uint32_t rings_of(int fd)
{
	return (uint32_t)access_load(bells[fd - ACCESS_BELL].rings, 4,
	                             fd == ACCESS_ORDERING ? __ATOMIC_ACQUIRE : __ATOMIC_RELAXED,
	                             ACCESS_SITE);
}

ssize_t __real_write(int fd, const void *from, size_t size);
ssize_t __wrap_write(int fd, const void *from, size_t size);
ssize_t __wrap_send(int fd, const void *from, size_t size, int flags);
ssize_t __wrap_read(int fd, void *to, size_t size);
int __wrap_ppoll(struct pollfd *polled, nfds_t n, const struct timespec *limit,
                 const sigset_t *mask);
long __wrap_syscall(long number, ...);

/* It counts, and wakes who sleeps on it. */
ssize_t __wrap_write(int fd, const void *from, size_t size)
{
	uint32_t *rings;

	if (!is_bell(fd))
		return __real_write(fd, from, size);
	rings = bells[fd - ACCESS_BELL].rings;
	access_rmw(rings, 4, ACCESS_ADD, 1,
	           fd == ACCESS_ORDERING ? __ATOMIC_RELEASE : __ATOMIC_RELAXED, ACCESS_SITE);
	segment_wake(rings, INT_MAX);
	return (ssize_t)size;
}

ssize_t __wrap_send(int fd, const void *from, size_t size, int flags)
{
	(void)flags;
	return __wrap_write(fd, from, size);
}

ssize_t __wrap_read(int fd, void *to, size_t size)
{
	(void)to;
	*bells[fd - ACCESS_BELL].heard = rings_of(fd);
	return (ssize_t)size;
}

int __wrap_ppoll(struct pollfd *polled, nfds_t n, const struct timespec *limit,
                 const sigset_t *mask)
{
	uint32_t heard = *bells[polled->fd - ACCESS_BELL].heard;

	(void)n;
	(void)mask;
	polled->revents = POLLIN;
	if (limit->tv_sec == 0 && limit->tv_nsec == 0)
		return rings_of(polled->fd) != heard;
	segment_wait(bells[polled->fd - ACCESS_BELL].rings, heard, INT64_MAX);
	return 1;
}

/* The one system call that is made so is epoll's wait: it ends when a bell has rung since. */
long __wrap_syscall(long number, ...)
{
	(void)number;
	segment_wait(bells[0].rings, *bells[0].heard, INT64_MAX);
	*bells[0].heard = rings_of(ACCESS_BELL);
	return 0;
}

void explore_fail(const char *format, ...)
{
	va_list args;

	va_start(args, format);
	vsnprintf(x.result->why, sizeof(x.result->why), format, args);
	va_end(args);
	x.result->failed = true;
	if (x.running)
		thread_stop(x.running);
}

void explore_forget(uint64_t all_that_matters)
{
	x.running->history = mix(1, all_that_matters);
	x.running->loads = 0;
}

unsigned explore_loads(void)
{
	return x.running->loads;
}
