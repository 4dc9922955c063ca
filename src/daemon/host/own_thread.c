/* SPDX-License-Identifier: MIT */
/* A thread beside the engine's that may hang: started, asked to end, waited for with a limit. */
#include "src/daemon/host/own_thread.h"
#include "hal/base/thread.h"
#include "src/memory/shm/futex.h"
#include "src/public/ows.h"

int own_thread_start(struct own_thread *t, const char *name, size_t stack, void *(*run)(void *ctx),
                     void *ctx)
{
	int err = thread_start(&t->thread, name, stack, run, ctx);

	t->running = !err;
	return err;
}

bool own_thread_stops(const struct own_thread *t)
{
	return __atomic_load_n(&t->stop, __ATOMIC_ACQUIRE);
}

void own_thread_ends(struct own_thread *t)
{
	__atomic_store_n(&t->ended, 1, __ATOMIC_RELEASE);
	segment_wake(&t->ended, 1);
}

bool own_thread_stop(struct own_thread *t, uint32_t *word, int64_t timeout_ns)
{
	int64_t until_ns = ows_now() + timeout_ns, left_ns = timeout_ns;

	if (!t->running)
		return true;
	__atomic_store_n(&t->stop, 1, __ATOMIC_RELEASE);
	segment_wake(&t->stop, 1);
	if (word)
		segment_wake(word, 1);
	/* pthread_timedjoin_np() uses the wall clock, which may be set meanwhile */
	while (!__atomic_load_n(&t->ended, __ATOMIC_ACQUIRE)) {
		if (left_ns <= 0)
			return false;
		segment_wait(&t->ended, 0, left_ns);
		left_ns = until_ns - ows_now();
	}
	pthread_join(t->thread, NULL);
	t->running = false;
	return true;
}
