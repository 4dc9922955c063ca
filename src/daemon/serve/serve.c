/* SPDX-License-Identifier: MIT */
/* The server of the owserver protocol: its thread, its start and end, and what a reload changes. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/mman.h>
#include <unistd.h>

#include "hal/base/thread.h"
#include "hal/base/time.h"
#include "hal/owfs/frame.h"
#include "src/config/check/own.h"
#include "src/daemon/serve/client.h"
#include "src/daemon/serve/listener.h"
#include "src/daemon/serve/serve.h"
#include "src/daemon/serve/work.h"
#include "src/daemon/serve/work_directory.h"
#include "src/daemon/serve/work_write.h"
#include "src/ground/service/command_age.h"
#include "src/ground/service/listen.h"
#include "src/memory/shm/futex.h"
#include "src/public/ows.h"

#define STACK_SIZE (128 * 1024)
#define TAKE_NS NS_PER_MS /* the pause between two looks whether the thread has taken the reload */
/* All that is watched: so epoll reports all there is, and what it does not comes later. */
#define EVENTS (SERVER_CLIENTS + SERVER_LISTENERS + 1)
#define WAKE_EVENT SERVER_CLIENTS

static const char *const counter_names[SERVE_COUNTER_COUNT] = {
#define X(name) "served_" #name,
	SERVE_COUNTERS(X)
#undef X
};

/*
 * Reserve address space; only the pages that are touched become memory. Small pages: where the
 * kernel gives huge ones to all, as Debian's does, the first client would make 2 MiB of memory of
 * it. A kernel without huge pages refuses the advice, and needs none.
 */
static void *reserve(size_t size)
{
	void *p = mmap(NULL, size, PROT_READ | PROT_WRITE,
	               MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);

	if (p == MAP_FAILED)
		return NULL;
	madvise(p, size, MADV_NOHUGEPAGE);
	return p;
}

static int allocate(struct serve *s)
{
	s->areas = reserve((size_t)SERVER_CLIENTS * AREA_SIZE);
	s->directories = reserve(SERVER_DIRECTORIES * sizeof(*s->directories));
	s->clients = reserve(SERVER_CLIENTS * sizeof(*s->clients));
	s->free = calloc(SERVER_CLIENTS, sizeof(*s->free));
	s->round = calloc(SERVER_CLIENTS, sizeof(*s->round));
	if (!s->areas || !s->directories || !s->clients || !s->free || !s->round)
		return -ENOMEM;
	while (s->free_count < SERVER_CLIENTS) {
		s->free[s->free_count] = (uint16_t)(SERVER_CLIENTS - 1 - s->free_count);
		s->free_count++;
	}
	for (int i = 0; i < SERVE_COUNTER_COUNT; i++)
		s->counters[i].name = counter_names[i];
	return guests_create(&s->guests, SERVER_CLIENTS, s->guests.ring, s->guests.ring_ctx);
}

bool serve_is_open(const struct config_serve *config)
{
	for (unsigned i = 0; i < config->address_count; i++)
		if (!listen_is_loopback(&config->addresses[i]))
			return !config->read_only;
	return false;
}

int serve_create(const struct serve_setup *setup, struct serve **serve, char *why, size_t why_size)
{
	struct epoll_event event = {.events = EPOLLIN | EPOLLET, .data.u32 = WAKE_EVENT};
	struct serve *s = calloc(1, sizeof(*s));
	int err = -ENOMEM;

	snprintf(why, why_size, "%s", strerror(ENOMEM));
	if (!s)
		return err;
	s->config = setup->config;
	s->instance = setup->instance;
	s->dir = setup->dir;
	s->directory = setup->directory;
	s->log = setup->log;
	s->porter = setup->porter;
	s->guests.ring = setup->ring;
	s->guests.ring_ctx = setup->ring_ctx;
	s->guests.wake_fd = -1;
	s->passes_on = config_has_servers(setup->config);
	s->epoll_fd = epoll_create1(EPOLL_CLOEXEC);
	err = s->epoll_fd < 0 ? -errno : allocate(s);
	tokens_own(s->token);
	s->guests.port.token = s->token;
	if (!err && epoll_ctl(s->epoll_fd, EPOLL_CTL_ADD, s->guests.wake_fd, &event) < 0)
		err = -errno;
	if (err)
		snprintf(why, why_size, "cannot serve the owserver protocol: %s", strerror(-err));
	else
		err = listeners_open(s, why, why_size);
	if (err) {
		serve_destroy(s);
		return err;
	}
	*serve = s;
	return 0;
}

const struct engine_guests *serve_guests(struct serve *s)
{
	return &s->guests.port;
}

const struct bus_counter *serve_counters(const struct serve *s, size_t *n)
{
	*n = SERVE_COUNTER_COUNT;
	return s->counters;
}

unsigned serve_absent(struct serve *s, char why[LISTEN_WHY_MAX])
{
	unsigned count = 0;

	*why = '\0';
	for (unsigned i = 0; i < s->listener_count; i++) {
		int before = s->unserved[i], err = listeners_look(s, i);
		char text[LISTEN_WHY_MAX];

		s->unserved[i] = err;
		listen_why(&s->listeners[i].at, err ? err : before, text);
		if (err && err != before)
			log_warning(s->log, "%s%s", text, listen_remedy(err));
		else if (!err && before)
			log_notice(s->log, "no longer: %s", text);
		if (err && !count++)
			memcpy(why, text, sizeof(text));
	}
	__atomic_store_n(&s->counters[COUNT_absent].value, count, __ATOMIC_RELAXED);
	return count;
}

/* --- The thread ------------------------------------------------------------------------------- */

static void take_events(struct serve *s, const struct epoll_event *events, int n)
{
	for (int i = 0; i < n; i++) {
		uint32_t who = events[i].data.u32;

		if (who < SERVER_CLIENTS)
			client_event(s, &s->clients[who], events[i].events);
		if (who <= WAKE_EVENT)
			continue;
		if (!(s->waiting >> (who - WAKE_EVENT - 1) & 1))
			s->listeners[who - WAKE_EVENT - 1].came_ns = s->came_ns;
		s->waiting |= (uint32_t)1 << (who - WAKE_EVENT - 1);
		s->accepting = true;
	}
}

static struct client *client_of(struct engine_guest *guest)
{
	return (struct client *)(void *)((char *)guest - offsetof(struct client, guest));
}

static void take_answers(struct serve *s)
{
	struct guests_message message;

	while (guests_next(&s->guests, &message)) {
		struct client *c = client_of(message.guest);

		if (message.released) {
			client_back(s, c);
			continue;
		}
		c->lent = message.guest->lent;
		if (c->state == CLIENT_WORKING)
			work_answered(s, c);
		else if (!c->lent)
			client_back(s, c);
	}
}

static void serve_round(struct serve *s)
{
	unsigned n = s->round_count;

	while (n--) {
		struct client *c = &s->clients[s->round[s->round_at]];

		s->round_at = (s->round_at + 1) % SERVER_CLIENTS;
		s->round_count--;
		c->queued = false;
		bool has_request = client_turn(s, c);
		/*
		 * The first request of most is answered, and the connection closed, before epoll
		 * has to know of it. But a write would be done, and its client not learn it, where
		 * the kernel refuses to watch the connection.
		 */
		if (has_request && c->request.type == FRAME_WRITE)
			client_watch(s, c);
		if (has_request && c->fd >= 0)
			work_begin(s, c);
		client_watch(s, c);
	}
}

/* How long the server waits for a porter that has too much to do. */
#define PORTER_NS (10 * NS_PER_MS)

static bool may_be_written(const struct config_serve *config)
{
	return !config->read_only && (config->address_count || config->socket);
}

static int wait_ms(struct serve *s)
{
	int64_t left = s->look_ns - s->now_ns;
	int most = may_be_written(&s->config->serve) ? LOOK_MS : 60000;

	if (s->round_count || s->accepting || left <= 0 || work_waits(s))
		return 0;
	if (s->away_count && left > PORTER_NS)
		left = PORTER_NS;
	return left > NS_PER_MS * most ? most : (int)((left + NS_PER_MS - 1) / NS_PER_MS);
}

static void take_next(struct serve *s)
{
	struct serve_next *next = __atomic_load_n(&s->next, __ATOMIC_ACQUIRE);
	struct kept *before = s->kept;

	if (!next)
		return;
	s->config = next->config;
	s->passes_on = config_has_servers(next->config);
	s->image = next->image;
	s->kept = next->kept;
	next->kept = before;
	buses_renumber(&s->buses, next->ports, s->config->target_count);
	__atomic_store_n(&s->next, NULL, __ATOMIC_RELEASE);
}

/* A client that asks without a pause has so many requests answered before epoll is asked again. */
#define AGAIN_MOST 15

/* The client whose turn was last asks again: that saves a sleep, if it ran here meanwhile. */
static bool asks_again(struct serve *s)
{
	unsigned last = s->round[(s->round_at + SERVER_CLIENTS - 1) % SERVER_CLIENTS];
	struct client *c = &s->clients[last];

	return thread_yield(&s->rest_ns) && c->state == CLIENT_READING && client_again(s, c);
}

/* Wait for something to do. Returns the number of events. */
static int serve_wait(struct serve *s, struct epoll_event *events)
{
	int wait = wait_ms(s), n;
	int64_t asked_ns, told_ns;

	if (wait && s->again++ < AGAIN_MOST && asks_again(s))
		return 0;
	s->again = 0;
	wait = wait_ms(s);
	if (wait && !guests_sleep(&s->guests))
		wait = 0;
	asked_ns = ows_now();
	n = epoll_wait(s->epoll_fd, events, EVENTS, wait);
	s->came_ns = s->asked_ns;
	/* what was not reported comes from now on, if it did not stop between that and the clock */
	told_ns = ows_now();
	if (n >= 0)
		s->asked_ns = told_ns - asked_ns > COMMAND_OLD_NS ? asked_ns : told_ns;
	if (wait)
		guests_awake(&s->guests);
	return n;
}

static void *serve_run(void *arg)
{
	struct epoll_event events[EVENTS];
	struct serve *s = arg;

	while (!__atomic_load_n(&s->stop, __ATOMIC_ACQUIRE)) {
		int n = serve_wait(s, events);

		s->now_ns = ows_now();
		take_next(s);
		take_events(s, events, n);
		take_answers(s);
		if (s->accepting)
			s->accepting = listeners_accept(s);
		serve_round(s);
		work_queue(s);
		if (s->away_count)
			clients_away(s);
		if (s->now_ns >= s->look_ns) {
			work_look(s);
			clients_look(s);
		}
	}
	return NULL;
}

/* mlockall() serves the engine; it would turn all that the server reserves into memory. */
static void unlock(void *p, size_t size)
{
	if (munlock(p, size) == 0)
		madvise(p, size, MADV_DONTNEED);
}

int serve_start(struct serve *s, const struct image *image)
{
	int err;

	s->image = image;
	s->now_ns = s->asked_ns = s->came_ns = ows_now();
	s->look_ns = INT64_MAX;
	s->kept = kept_create(s->config);
	err = s->kept ? signals_open(s->dir, s->instance, &s->signals) : -ENOMEM;
	if (err)
		return err;
	unlock(s->areas, (size_t)SERVER_CLIENTS * AREA_SIZE);
	unlock(s->directories, SERVER_DIRECTORIES * sizeof(*s->directories));
	unlock(s->clients, SERVER_CLIENTS * sizeof(*s->clients));
	err = thread_start(&s->thread, "owsd-serve", STACK_SIZE, serve_run, s);
	s->running = !err;
	return err;
}

int serve_prepare(struct serve *s, const struct config *config)
{
	kept_destroy(s->prepared);
	s->prepared = kept_create(config);
	return s->prepared ? 0 : -ENOMEM;
}

void serve_reload(struct serve *s, const struct config *config, const struct image *image,
                  const int *ports)
{
	struct serve_next next = {config, image, s->prepared, ports};
	static const uint32_t nobody = 0;

	s->prepared = NULL;
	__atomic_store_n(&s->next, &next, __ATOMIC_RELEASE);
	while (__atomic_load_n(&s->next, __ATOMIC_ACQUIRE)) {
		guests_wake(&s->guests);
		segment_wait(&nobody, 0, TAKE_NS);
	}
	kept_destroy(next.kept);
}

void serve_stop(struct serve *s)
{
	if (!s)
		return;
	__atomic_store_n(&s->stop, 1, __ATOMIC_RELEASE);
	if (s->running) {
		guests_wake(&s->guests);
		pthread_join(s->thread, NULL);
		s->running = false;
	}
	listeners_close(s);
	for (unsigned i = 0; i < s->used; i++)
		if (s->clients[i].state != CLIENT_FREE && s->clients[i].fd >= 0)
			client_part(s, s->clients[i].fd, s->clients[i].network);
	s->used = 0;
	/* what the porter has no time for ends with this process */
	clients_away(s);
	s->away_count = 0;
}

void serve_destroy(struct serve *s)
{
	if (!s)
		return;
	serve_stop(s);
	if (s->epoll_fd >= 0)
		close(s->epoll_fd);
	guests_destroy(&s->guests);
	kept_destroy(s->kept);
	kept_destroy(s->prepared);
	signals_close(s->signals);
	if (s->areas)
		munmap(s->areas, (size_t)SERVER_CLIENTS * AREA_SIZE);
	if (s->directories)
		munmap(s->directories, SERVER_DIRECTORIES * sizeof(*s->directories));
	if (s->clients)
		munmap(s->clients, SERVER_CLIENTS * sizeof(*s->clients));
	free(s->free);
	free(s->round);
	free(s);
}
