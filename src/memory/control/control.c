/* SPDX-License-Identifier: MIT */
/* The thread of the control room, its start and end, a reload, and the engine's side. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include "hal/base/bell.h"
#include "hal/base/thread.h"
#include "hal/base/time.h"
#include "src/config/read/config.h"
#include "src/ground/service/listen.h"
#include "src/memory/control/ask.h"
#include "src/memory/control/control.h"
#include "src/memory/control/door.h"
#include "src/memory/control/grant.h"
#include "src/memory/control/held.h"
#include "src/memory/control/news.h"
#include "src/memory/control/private.h"
#include "src/memory/control/seat.h"
#include "src/memory/control/welcome.h"
#include "src/memory/shm/word.h"
#include "src/public/ows.h"

#define STACK_SIZE (128 * 1024)
#define EVENTS 64
/* Modes of the socket: rights of those who connect are looked at afterwards, */
#define FOR_ALL 0666
#define FOR_OWN 0600 /* or there are none but of owsd's user and root */
/* What stands in epoll's data; below it, a seat * 2 + 1 if its process ended. */
#define LISTENER (2 * OWS_CONTROLLERS)
#define WAKE (LISTENER + 1)

static const char *const counter_names[CONTROL_COUNTER_COUNT] = {
#define X(name) "control_" #name,
	CONTROL_COUNTERS(X)
#undef X
};

/* Any user may connect where rights follow from the credentials that the kernel reports. */
static bool is_for_all(const struct control *c)
{
	return c->rights.has_controllers || c->rights.has_readers || c->rights.has_configurers ||
	       c->config->allow_count;
}

static int control_add(struct control *c, int fd, uint32_t data)
{
	struct epoll_event event = {.events = EPOLLIN | EPOLLET, .data.u32 = data};

	return epoll_ctl(c->epoll, EPOLL_CTL_ADD, fd, &event) < 0 ? -errno : 0;
}

static int open_all(struct control *c)
{
	int err;

	c->epoll = epoll_create1(EPOLL_CLOEXEC);
	c->wake = c->epoll < 0 ? -1 : bell_open();
	c->asked = c->wake < 0 ? -1 : bell_open();
	if (c->asked < 0)
		return -errno;
	/* the lock of the instance is held: what is there an owsd before has left */
	c->listener = listen_at_name(c->directory, c->name, SOCK_SEQPACKET,
	                             is_for_all(c) ? FOR_ALL : FOR_OWN, (gid_t)-1);
	if (c->listener < 0)
		return c->listener;
	c->file = listen_file_at(c->directory, c->name);
	err = news_open(c);
	if (!err)
		err = control_add(c, c->listener, LISTENER);
	return err ? err : control_add(c, c->wake, WAKE);
}

int control_create(const struct control_setup *setup, struct control **control, char *why,
                   size_t why_size)
{
	struct control *c = calloc(1, sizeof(*c));
	int err;

	snprintf(why, why_size, "%s", strerror(ENOMEM));
	if (!c)
		return -ENOMEM;
	c->config = setup->config;
	c->directory = setup->directory;
	c->log = setup->log;
	c->porter = setup->porter;
	c->ring = setup->ring;
	c->ring_ctx = setup->ring_ctx;
	c->epoll = c->wake = c->asked = c->listener = c->news.bell = -1;
	c->engine.at = OWS_CONTROLLERS;
	pthread_mutex_init(&c->lock, NULL);
	for (int i = 0; i < CONTROL_COUNTER_COUNT; i++)
		c->counters[i].name = counter_names[i];
	snprintf(c->name, sizeof(c->name), "%s.control", setup->instance);
	rights_find(&c->rights, c->config);
	held_open(c);
	err = open_all(c);
	if (err) {
		snprintf(why, why_size, "cannot make the socket %s: %s", c->name, strerror(-err));
		control_destroy(c);
		return err;
	}
	*control = c;
	return 0;
}

const struct bus_counter *control_counters(const struct control *c, size_t *n)
{
	*n = CONTROL_COUNTER_COUNT;
	return c->counters;
}

/* --- The thread ------------------------------------------------------------------------------- */

static void take_event(struct control *c, uint32_t data)
{
	if (data == LISTENER)
		c->accepts = true;
	else if (data < LISTENER && data % 2)
		seat_died(c, &c->seats[data / 2]);
	else if (data < LISTENER)
		door_event(c, &c->seats[data / 2]);
}

static int wait_ms(const struct control *c, int64_t next_ns)
{
	int64_t left = next_ns - c->now_ns;

	if (next_ns == INT64_MAX)
		return -1;
	return left <= 0 ? 0 : (int)(left / NS_PER_MS) + 1;
}

static void *control_run(void *arg)
{
	struct epoll_event events[EVENTS];
	struct control *c = arg;
	int ms = -1;

	while (!__atomic_load_n(&c->stop, __ATOMIC_ACQUIRE)) {
		int n = epoll_wait(c->epoll, events, EVENTS, ms);

		control_lock(c);
		for (int i = 0; i < n; i++)
			take_event(c, events[i].data.u32);
		if (c->accepts && c->now_ns >= c->accept_ns)
			door_accept(c);
		ms = wait_ms(c, door_look(c));
		pthread_mutex_unlock(&c->lock);
	}
	return NULL;
}

int control_start(struct control *c, const struct controller_layout *layout)
{
	int err;

	c->layout = layout;
	err = thread_start(&c->thread, "owsd-control", STACK_SIZE, control_run, c);
	c->running = !err;
	return err ? err : news_start(c);
}

/*
 * Connections, and the socket where some wait: what the porter has no time for ends with this
 * process, in which the kernel then waits for nothing.
 */
static void part_with(struct control *c, int *fd)
{
	if (*fd >= 0)
		welcome_end(c, fd, 1, 0, false);
	*fd = -1;
}

void control_stop(struct control *c)
{
	if (!c)
		return;
	__atomic_store_n(&c->stop, 1, __ATOMIC_RELEASE);
	if (c->running) {
		bell_ring(c->wake);
		pthread_join(c->thread, NULL);
		c->running = false;
	}
	news_stop(c);
	for (unsigned i = 0; i < OWS_CONTROLLERS; i++) {
		struct control_seat *p = &c->seats[i];

		if (p->now.memory.base)
			controller_state(&p->now.memory, OWS_STATE_STOPPED);
		if (control_state_of(p) != CONTROL_FREE)
			part_with(c, &p->fd);
	}
	/* not that of another owsd which has taken the instance over */
	if (c->listener >= 0)
		listen_remove(c->directory, c->name, &c->file);
	part_with(c, &c->listener);
	while (c->away_count)
		part_with(c, &c->away[--c->away_count]);
}

void control_destroy(struct control *c)
{
	if (!c)
		return;
	control_stop(c);
	for (unsigned i = 0; i < OWS_CONTROLLERS; i++)
		if (control_state_of(&c->seats[i]) != CONTROL_FREE)
			seat_release(c, &c->seats[i]);
	held_forget(c);
	news_close(c);
	if (c->asked >= 0)
		close(c->asked);
	if (c->wake >= 0)
		close(c->wake);
	if (c->epoll >= 0)
		close(c->epoll);
	pthread_mutex_destroy(&c->lock);
	free(c);
}

/* --- The engine's thread ---------------------------------------------------------------------- */

static void make_message(struct control_message *message, const struct control *c, unsigned seat,
                         const struct control_grant *grant)
{
	const struct control_seat *p = &c->seats[seat];

	*message = (struct control_message){
		.seat = seat,
		.joins = true,
		.controller = {.memory = grant->memory, .rights = grant->rights, .who = p->who},
		.bell = p->bell,
	};
	memcpy(message->controller.token, p->token, sizeof(p->token));
}

bool control_next(struct control *c, struct control_message *message)
{
	uint32_t changes = __atomic_load_n(&c->changes, __ATOMIC_ACQUIRE);

	if (changes != c->engine.seen) {
		c->engine.seen = changes;
		c->engine.at = 0;
	}
	while (c->engine.at < OWS_CONTROLLERS) {
		unsigned seat = c->engine.at++;
		struct control_seat *p = &c->seats[seat];
		uint32_t state = CONTROL_JOINING;

		bool joins = __atomic_compare_exchange_n(&p->state, &state, CONTROL_TAKEN, false,
		                                         __ATOMIC_ACQ_REL, __ATOMIC_ACQUIRE);

		if (joins || state == CONTROL_LEAVING) {
			make_message(message, c, seat, &p->now);
			message->joins = joins;
			return true;
		}
	}
	return false;
}

void control_done(struct control *c, const struct control_message *message)
{
	c->engine.memories[message->seat] = message->joins ? message->controller.memory
	                                                   : (struct controller_memory){0};
	if (message->joins && c->engine.end <= message->seat)
		c->engine.end = message->seat + 1;
	while (c->engine.end && !c->engine.memories[c->engine.end - 1].base)
		c->engine.end--;
	__atomic_store_n(&c->seats[message->seat].state, message->joins ? CONTROL_IN : CONTROL_LEFT,
	                 __ATOMIC_RELEASE);
	bell_ring(c->wake);
}

void control_news(struct control *c, const uint32_t *word)
{
	bool left = news_wake(c, word), due = false;

	/* count the news, then look for waiting readers: a reader says that it waits, then looks */
	word_fence(__ATOMIC_SEQ_CST);
	for (unsigned i = 0; i < c->engine.end; i++) {
		const struct controller_memory *memory = &c->engine.memories[i];

		if (!memory->base || !controller_waits(memory))
			continue;
		news_due(c, i);
		due = true;
	}
	if (left || due)
		news_ring(c, left ? word : NULL);
}

void control_end(struct control *c)
{
	for (unsigned i = 0; i < OWS_CONTROLLERS; i++)
		if (c->engine.memories[i].base)
			controller_state(&c->engine.memories[i], OWS_STATE_STOPPED);
}

/* --- A reload --------------------------------------------------------------------------------- */

int control_asked_bell(const struct control *c)
{
	return c->asked;
}

bool control_asked(struct control *c)
{
	bool asked = false;

	bell_clear(c->asked);
	for (unsigned i = 0; i < OWS_CONTROLLERS; i++)
		asked |= control_state_of(&c->seats[i]) == CONTROL_ASKING;
	return asked;
}

void control_take_askers(struct control *c)
{
	control_lock(c);
	for (unsigned i = 0; i < OWS_CONTROLLERS; i++) {
		struct control_seat *p = &c->seats[i];

		if (control_state_of(p) != CONTROL_ASKING)
			continue;
		__atomic_store_n(&p->state, CONTROL_ASKED, __ATOMIC_RELEASE);
		log_notice(c->log, "reload: asked for by " LOG_PROGRAM, p->who.name,
		           (int)p->who.pid, (unsigned)p->who.uid);
	}
	pthread_mutex_unlock(&c->lock);
}

void control_answer(struct control *c, int err, const char *why)
{
	control_lock(c);
	for (unsigned i = 0; i < OWS_CONTROLLERS; i++) {
		struct control_seat *p = &c->seats[i];

		if (control_state_of(p) != CONTROL_ASKED)
			continue;
		ask_answer(c, p, err, why);
		seat_drop(c, p, CONTROL_asked);
	}
	pthread_mutex_unlock(&c->lock);
}

/*
 * The limits of a user hold for the new memory too, and the old one counts until it is empty. A
 * controller for which there is no room goes on without a memory, and leaves.
 */
static void prepare_grant(struct control *c, struct control_seat *p)
{
	size_t has = 0, bytes;
	int err = -ENOSPC;

	for (unsigned i = 0; i < OWS_CONTROLLERS; i++)
		if (c->seats[i].peer.uid == p->peer.uid)
			has += c->seats[i].next.size;
	if (!p->peer.uid || ((!has || has + c->layout->header.size <= CONTROL_MEMORY) &&
	                     held_of(c, p->peer.uid, &bytes) < CONTROL_HELD && !held_full(c)))
		err = grant_make(&p->next, c->layout, &c->rights, p);
	if (err)
		log_warning(c->log, "no memory for controller " LOG_PROGRAM " after the reload: %s",
		            p->who.name, (int)p->who.pid, (unsigned)p->who.uid, strerror(-err));
}

void control_prepare(struct control *c, const struct config *config,
                     const struct controller_layout *layout)
{
	control_lock(c);
	rights_find(&c->rights, config);
	c->config = config;
	c->layout = layout;
	for (unsigned i = 0; i < OWS_CONTROLLERS; i++) {
		struct control_seat *p = &c->seats[i];

		if (control_belongs(p))
			prepare_grant(c, p);
	}
}

bool control_prepared(struct control *c, unsigned *seat, struct control_message *message)
{
	while (*seat < OWS_CONTROLLERS) {
		unsigned i = (*seat)++;
		const struct control_grant *next = &c->seats[i].next;

		if (!c->engine.memories[i].base)
			continue;
		c->engine.memories[i] = next->memory;
		if (!next->memory.base)
			continue;
		make_message(message, c, i, next);
		return true;
	}
	return false;
}

/* The engine has the new memory by now; until then the seat needed both. */
static void take_next_memory(struct control *c, struct control_seat *p)
{
	if (control_state_of(p) != CONTROL_IN) {
		held_free(c, p->peer.uid, &p->next, false);
		return;
	}
	held_free(c, p->peer.uid, &p->now, true);
	p->now = p->next;
	p->next = (struct control_grant){.memfd = -1, .own = -1};
	p->welcomed = false;
	if (!p->now.memory.base)
		seat_drop(c, p, CONTROL_refused_errors);
}

void control_reloaded(struct control *c)
{
	for (unsigned i = 0; i < OWS_CONTROLLERS; i++)
		take_next_memory(c, &c->seats[i]);
	if (fchmodat(c->directory, c->name, is_for_all(c) ? FOR_ALL : FOR_OWN, 0) < 0)
		log_warning(c->log, "who may connect to %s stays as it was: %s", c->name,
		            strerror(errno));
	pthread_mutex_unlock(&c->lock);
	bell_ring(c->wake);
}

void control_replaced(struct control *c)
{
	control_lock(c);
	for (unsigned i = 0; i < OWS_CONTROLLERS; i++)
		if (control_state_of(&c->seats[i]) == CONTROL_IN)
			news_due(c, i);
	news_ring(c, NULL);
	pthread_mutex_unlock(&c->lock);
}
