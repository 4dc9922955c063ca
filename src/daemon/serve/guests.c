/* SPDX-License-Identifier: MIT */
/* The two queues between the server's thread and the engine's. */
#include <errno.h>
#include <stdlib.h>
#include <unistd.h>

#include "hal/base/bell.h"
#include "src/daemon/serve/guests.h"

static struct engine_guest *take_message(void *ctx)
{
	struct guests *g = ctx;
	struct engine_guest *guest;

	if (!ring_used(&g->asked))
		return NULL;
	guest = g->requests[ring_take_at(&g->asked)];
	ring_did_take(&g->asked);
	return guest;
}

void guests_wake(struct guests *g)
{
	bell_ring(g->wake_fd);
}

/* The queue has room for two messages of each request that can be in work. */
static void put_message(struct guests *g, struct engine_guest *guest, bool released)
{
	g->answers[ring_put_at(&g->answered)] = (struct guests_message){guest, released};
	ring_did_put(&g->answered);
	if (__atomic_exchange_n(&g->sleeping, 0, __ATOMIC_SEQ_CST))
		guests_wake(g);
}

static void put_answer(void *ctx, struct engine_guest *guest)
{
	put_message(ctx, guest, false);
}

static void put_release(void *ctx, struct engine_guest *guest)
{
	put_message(ctx, guest, true);
}

int guests_create(struct guests *g, unsigned most, void (*ring)(void *ctx), void *ring_ctx)
{
	*g = (struct guests){.ring = ring, .ring_ctx = ring_ctx};
	g->port = (struct engine_guests){take_message, put_answer, put_release, g};
	g->asked.size = ring_size(most);
	g->answered.size = ring_size(2 * most);
	g->requests = calloc(g->asked.size, sizeof(*g->requests));
	g->answers = calloc(g->answered.size, sizeof(*g->answers));
	g->wake_fd = bell_open();
	if (g->wake_fd < 0)
		return -errno;
	return g->requests && g->answers ? 0 : -ENOMEM;
}

void guests_destroy(struct guests *g)
{
	free(g->requests);
	free(g->answers);
	if (g->wake_fd >= 0)
		close(g->wake_fd);
}

void guests_ask(struct guests *g, struct engine_guest *guest)
{
	g->requests[ring_put_at(&g->asked)] = guest;
	ring_did_put(&g->asked);
	g->ring(g->ring_ctx);
}

bool guests_next(struct guests *g, struct guests_message *message)
{
	if (!ring_used(&g->answered))
		return false;
	*message = g->answers[ring_take_at(&g->answered)];
	ring_did_take(&g->answered);
	return true;
}

bool guests_sleep(struct guests *g)
{
	__atomic_store_n(&g->sleeping, 1, __ATOMIC_SEQ_CST);
	if (!ring_used(&g->answered))
		return true;
	__atomic_store_n(&g->sleeping, 0, __ATOMIC_SEQ_CST);
	return false;
}

void guests_awake(struct guests *g)
{
	__atomic_store_n(&g->sleeping, 0, __ATOMIC_SEQ_CST);
}
