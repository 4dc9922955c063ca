/* SPDX-License-Identifier: MIT */
/* Ranges of memory whose SIGBUS is caught, and the handler that catches it. */
#include <errno.h>
#include <pthread.h>
#include <signal.h>
#include <stdint.h>
#include <string.h>
#include <sys/mman.h>

#include "src/shm/guard.h"

/* base is 0 while the range is free or is being set: the handler reads base first. */
static struct guard_range {
	uintptr_t base;
	size_t size;
	int lost;
} ranges[GUARD_MAX];
static struct sigaction previous;
static int installed;
static pthread_mutex_t setting = PTHREAD_MUTEX_INITIALIZER;

static struct guard_range *find_range(uintptr_t address)
{
	for (int i = 0; i < GUARD_MAX; i++) {
		uintptr_t base = __atomic_load_n(&ranges[i].base, __ATOMIC_ACQUIRE);

		if (base != 0 && address >= base && address - base < ranges[i].size)
			return &ranges[i];
	}
	return NULL;
}

/*
 * Restore the handler before ours; the instruction then faults again, or the signal is sent again.
 */
static void pass_on(int number, siginfo_t *info, void *context)
{
	if (previous.sa_flags & SA_SIGINFO) {
		previous.sa_sigaction(number, info, context);
	} else if (previous.sa_handler != SIG_DFL && previous.sa_handler != SIG_IGN) {
		previous.sa_handler(number);
	} else {
		struct sigaction by_default = {.sa_handler = SIG_DFL};

		if (info->si_code <= 0 && previous.sa_handler == SIG_IGN)
			return;
		sigaction(number, &by_default, NULL);
		if (info->si_code <= 0)
			raise(number);
	}
}

static void on_bus_error(int number, siginfo_t *info, void *context)
{
	struct guard_range *range = NULL;
	int saved = errno;

	if (info->si_code > 0)
		range = find_range((uintptr_t)info->si_addr);
	if (range != NULL && mmap((void *)range->base, range->size, PROT_READ | PROT_WRITE,
	                          MAP_PRIVATE | MAP_FIXED | MAP_ANONYMOUS, -1, 0) != MAP_FAILED)
		__atomic_store_n(&range->lost, 1, __ATOMIC_RELEASE);
	else
		pass_on(number, info, context);
	errno = saved;
}

static int install(bool only_default)
{
	struct sigaction ours = {.sa_flags = SA_SIGINFO | SA_ONSTACK, .sa_sigaction = on_bus_error};

	if (installed > 0)
		return 0;
	if (sigaction(SIGBUS, NULL, &previous) < 0)
		return -errno;
	if (only_default && ((previous.sa_flags & SA_SIGINFO) || previous.sa_handler != SIG_DFL))
		return -EBUSY;
	sigemptyset(&ours.sa_mask);
	return sigaction(SIGBUS, &ours, NULL) < 0 ? -errno : 0;
}

/* Restore the handler before ours, unless the program has replaced ours meanwhile. */
static void uninstall(void)
{
	struct sigaction now;

	if (sigaction(SIGBUS, NULL, &now) == 0 && (now.sa_flags & SA_SIGINFO) &&
	    now.sa_sigaction == on_bus_error)
		sigaction(SIGBUS, &previous, NULL);
}

static struct guard_range *guarded(uintptr_t base)
{
	for (int i = 0; i < GUARD_MAX; i++)
		if (__atomic_load_n(&ranges[i].base, __ATOMIC_ACQUIRE) == base)
			return &ranges[i];
	return NULL;
}

int guard_add(void *base, size_t size, bool only_default)
{
	struct guard_range *range;
	int err;

	pthread_mutex_lock(&setting);
	range = guarded(0);
	err = range != NULL ? install(only_default) : -ENOSPC;
	if (!err) {
		installed++;
		range->size = size;
		range->lost = 0;
		__atomic_store_n(&range->base, (uintptr_t)base, __ATOMIC_RELEASE);
	}
	pthread_mutex_unlock(&setting);
	return err;
}

void guard_remove(const void *base)
{
	struct guard_range *range;

	pthread_mutex_lock(&setting);
	range = base != NULL ? guarded((uintptr_t)base) : NULL;
	if (range != NULL) {
		__atomic_store_n(&range->base, 0, __ATOMIC_RELEASE);
		if (--installed == 0)
			uninstall();
	}
	pthread_mutex_unlock(&setting);
}

bool guard_lost(const void *base)
{
	struct guard_range *range = base != NULL ? guarded((uintptr_t)base) : NULL;

	return range != NULL && __atomic_load_n(&range->lost, __ATOMIC_ACQUIRE) != 0;
}
