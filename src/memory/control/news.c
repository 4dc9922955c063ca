/* SPDX-License-Identifier: MIT */
/* The thread that rings the news of connected programs and wakes the sleepers of the image. */
#include <limits.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "hal/base/bell.h"
#include "hal/base/thread.h"
#include "hal/base/time.h"
#include "src/memory/control/news.h"
#include "src/memory/shm/futex.h"
#include "src/public/ows.h"

#define STACK_SIZE (64 * 1024)
/*
 * What takes longer is slow, and rests for so many times as long as it took, for each that is slow:
 * all together they get a twentieth of a core.
 */
#define SLOW_NS (NS_PER_MS / 2)
#define REST 20

/* Of the engine's thread: so many sleepers it wakes itself, if that takes no longer than this. */
#define WOKEN_HERE 2
#define LONG_NS (NS_PER_MS / 10)
#define LONG_REST_NS NS_PER_S

enum { NEWS_GONE, NEWS_IDLE, NEWS_BUSY };

int news_open(struct control *c)
{
	c->news.bell = bell_open();
	return c->news.bell < 0 ? c->news.bell : 0;
}

void news_close(struct control *c)
{
	if (c->news.bell >= 0)
		close(c->news.bell);
	c->news.bell = -1;
}

void news_due(struct control *c, unsigned seat)
{
	__atomic_fetch_or(&c->news.due[seat / 32], 1u << seat % 32, __ATOMIC_RELEASE);
}

void news_ring(struct control *c, const uint32_t *word)
{
	if (word) {
		__atomic_store_n(&c->news.word, word, __ATOMIC_RELAXED);
		news_due(c, NEWS_IMAGE);
	}
	bell_ring(c->news.bell);
}

bool news_wake(struct control *c, const uint32_t *word)
{
	int64_t begun_ns = ows_now(), ended_ns;
	int woken;

	if (begun_ns < c->engine.rest_until_ns)
		return true;
	woken = segment_wake(word, WOKEN_HERE);
	ended_ns = ows_now();
	if (ended_ns - begun_ns > LONG_NS)
		c->engine.rest_until_ns = ended_ns + LONG_REST_NS;
	return woken == WOKEN_HERE;
}

void news_begin(struct control_seat *p)
{
	__atomic_store_n(&p->news_state, NEWS_IDLE, __ATOMIC_RELEASE);
}

bool news_end(struct control_seat *p)
{
	uint32_t idle = NEWS_IDLE;

	return __atomic_compare_exchange_n(&p->news_state, &idle, NEWS_GONE, false,
	                                   __ATOMIC_ACQ_REL, __ATOMIC_ACQUIRE) ||
	       idle == NEWS_GONE;
}

/* --- The thread ------------------------------------------------------------------------------- */

/* A socket that is full rings already; without a reader the controller is about to leave. */
static void ring_seat(struct control_seat *p)
{
	uint32_t idle = NEWS_IDLE;

	if (!__atomic_compare_exchange_n(&p->news_state, &idle, NEWS_BUSY, false, __ATOMIC_ACQ_REL,
	                                 __ATOMIC_ACQUIRE))
		return;
	send(p->news, "", 1, MSG_DONTWAIT | MSG_NOSIGNAL);
	__atomic_store_n(&p->news_state, NEWS_IDLE, __ATOMIC_RELEASE);
}

static void take_due(struct control *c)
{
	bell_clear(c->news.bell);
	for (unsigned i = 0; i < NEWS_WORDS; i++)
		c->news.taken[i] |= __atomic_exchange_n(&c->news.due[i], 0, __ATOMIC_ACQUIRE);
}

static bool is_due(const struct control *c, unsigned i)
{
	return c->news.taken[i / 32] >> i % 32 & 1;
}

static void ring_one(struct control *c, unsigned i)
{
	struct news_pace *pace = &c->news.paces[i];
	bool was_slow = pace->rest_until_ns != 0;
	int64_t begun_ns = ows_now(), took_ns;

	c->news.taken[i / 32] &= ~(1u << i % 32);
	/* an image that a reload has unmapped meanwhile is an error to the kernel, and no harm */
	if (i == NEWS_IMAGE)
		segment_wake(__atomic_load_n(&c->news.word, __ATOMIC_RELAXED), INT_MAX);
	else
		ring_seat(&c->seats[i]);
	took_ns = ows_now() - begun_ns;
	if (was_slow)
		c->news.slow--;
	pace->rest_until_ns = 0;
	if (took_ns < SLOW_NS)
		return;
	c->news.slow++;
	pace->rest_until_ns = begun_ns + took_ns * REST * c->news.slow;
}

/*
 * Ring all that are not slow, then at most one that is and has rested; what becomes due meanwhile
 * is served before the next slow one. Returns how long nothing is due.
 */
int64_t news_turn(struct control *c)
{
	int64_t now_ns = ows_now(), next_ns = INT64_MAX;
	unsigned slow = NEWS_PACES;

	take_due(c);
	for (unsigned i = 0; i < NEWS_PACES; i++) {
		const struct news_pace *pace = &c->news.paces[i];

		if (!is_due(c, i))
			continue;
		if (!pace->rest_until_ns) {
			ring_one(c, i);
			continue;
		}
		if (pace->rest_until_ns < next_ns) {
			next_ns = pace->rest_until_ns;
			slow = i;
		}
	}
	if (slow == NEWS_PACES || next_ns > now_ns)
		return next_ns == INT64_MAX ? -1 : next_ns - now_ns;
	ring_one(c, slow);
	return 0;
}

static void *news_run(void *arg)
{
	struct control *c = arg;
	struct pollfd bell = {.fd = c->news.bell, .events = POLLIN};
	int64_t left_ns = -1;

	while (!__atomic_load_n(&c->news.stop, __ATOMIC_ACQUIRE)) {
		poll(&bell, 1, left_ns < 0 ? -1 : (int)((left_ns + NS_PER_MS - 1) / NS_PER_MS));
		left_ns = news_turn(c);
	}
	return NULL;
}

int news_start(struct control *c)
{
	int err = thread_start(&c->news.thread, "owsd-news", STACK_SIZE, news_run, c);

	c->news.running = !err;
	return err;
}

void news_stop(struct control *c)
{
	if (!c->news.running)
		return;
	__atomic_store_n(&c->news.stop, 1, __ATOMIC_RELEASE);
	bell_ring(c->news.bell);
	pthread_join(c->news.thread, NULL);
	c->news.running = false;
}
