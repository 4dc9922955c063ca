/* SPDX-License-Identifier: MIT */
/* What the engine's thread sleeps on: a bell of owsd's threads, and one of each controller. */
#include <errno.h>
#include <poll.h>
#include <sys/epoll.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include "hal/base/bell.h"
#include "hal/base/time.h"
#include "src/daemon/host/bells.h"
#include "src/memory/shm/word.h"
#include "src/public/ows.h"

/* Younger than the headers of some machines that build owsd. */
#ifndef SYS_epoll_pwait2
#define SYS_epoll_pwait2 441
#endif
#define OWN OWS_CONTROLLERS
#define EVENTS 32

/* Edge-triggered: each write wakes once, and the thread need not read. */
static int bells_watch(const struct bells *bells, int fd, uint32_t data)
{
	struct epoll_event event = {.events = EPOLLIN | EPOLLET, .data.u32 = data};

	return epoll_ctl(bells->epoll, EPOLL_CTL_ADD, fd, &event) < 0 ? -errno : 0;
}

int bells_open(struct bells *bells)
{
	*bells = (struct bells){.own = -1, .awake = 1};
	for (unsigned i = 0; i < OWS_CONTROLLERS; i++)
		bells->controllers[i].fd = -1;
	bells->epoll = epoll_create1(EPOLL_CLOEXEC);
	if (bells->epoll >= 0)
		bells->own = bell_open();
	return bells->own < 0 ? -errno : bells_watch(bells, bells->own, OWN);
}

void bells_close(struct bells *bells)
{
	if (bells->own >= 0)
		close(bells->own);
	if (bells->epoll >= 0)
		close(bells->epoll);
	bells->own = bells->epoll = -1;
}

void bells_ring(struct bells *bells)
{
	__atomic_store_n(&bells->rung, 1, __ATOMIC_RELEASE);
	word_fence(__ATOMIC_SEQ_CST);
	if (word_get(&bells->awake))
		return;
	bell_ring(bells->own);
}

void bells_add(struct bells *bells, unsigned seat, int fd)
{
	bells->controllers[seat].fd = fd;
	bells->controllers[seat].rings = 0;
	bells->controllers[seat].muted = bells_watch(bells, fd, seat) != 0;
	bells->muted += bells->controllers[seat].muted;
}

static void leave_out(struct bells *bells, unsigned seat)
{
	epoll_ctl(bells->epoll, EPOLL_CTL_DEL, bells->controllers[seat].fd, NULL);
}

void bells_remove(struct bells *bells, unsigned seat)
{
	if (bells->controllers[seat].fd < 0)
		return;
	if (bells->controllers[seat].muted)
		bells->muted--;
	else
		leave_out(bells, seat);
	bells->controllers[seat].fd = -1;
	bells->controllers[seat].muted = false;
}

void bells_look(struct bells *bells)
{
	/* what was done before the rings that this takes away is seen in the look that follows */
	__atomic_exchange_n(&bells->rung, 0, __ATOMIC_ACQUIRE);
}

bool bells_close_eyes(struct bells *bells)
{
	word_set(&bells->awake, 0);
	word_fence(__ATOMIC_SEQ_CST);
	return word_get(&bells->rung) != 0;
}

void bells_open_eyes(struct bells *bells)
{
	word_set(&bells->awake, 1);
}

/* --- Sleep ------------------------------------------------------------------------------------ */

static int wait_for(int epoll, struct epoll_event *events, int64_t ns)
{
	struct {
		int64_t s, ns;
	} t = {ns / NS_PER_S, ns % NS_PER_S};
	struct timespec coarse = {.tv_sec = (time_t)t.s, .tv_nsec = (long)t.ns};
	struct pollfd poll = {.fd = epoll, .events = POLLIN};
	long n = syscall(SYS_epoll_pwait2, epoll, events, EVENTS, &t, NULL, 0);

	if (n >= 0 || errno == EINTR)
		return (int)n;
	/* older kernels, and what stands in for a kernel, have no wait in nanoseconds but this */
	return ppoll(&poll, 1, &coarse, NULL) > 0 ? epoll_wait(epoll, events, EVENTS, 0) : 0;
}

static void count_ring(struct bells *bells, unsigned seat)
{
	unsigned most = bells->all < BELLS_ALL ? BELLS_MAX : BELLS_SHARE;

	bells->all++;
	if (bells->controllers[seat].fd < 0 || ++bells->controllers[seat].rings < most)
		return;
	leave_out(bells, seat);
	bells->controllers[seat].muted = true;
	bells->muted++;
	bells->mutes++;
}

static void count_again(struct bells *bells, int64_t now_ns)
{
	bells->since_ns = now_ns;
	bells->all = 0;
	for (unsigned i = 0; i < OWS_CONTROLLERS; i++) {
		bells->controllers[i].rings = 0;
		if (bells->controllers[i].muted &&
		    bells_watch(bells, bells->controllers[i].fd, i) == 0) {
			bells->controllers[i].muted = false;
			bells->muted--;
		}
	}
}

void bells_sleep(struct bells *bells, int64_t until_ns)
{
	struct epoll_event events[EVENTS];
	int64_t now_ns = ows_now();
	int n;

	if (now_ns - bells->since_ns >= BELLS_NS)
		count_again(bells, now_ns);
	if (bells->muted && bells->since_ns + BELLS_NS < until_ns)
		until_ns = bells->since_ns + BELLS_NS;
	if (until_ns <= now_ns)
		return;
	n = wait_for(bells->epoll, events, until_ns - now_ns);
	for (int i = 0; i < n; i++)
		if (events[i].data.u32 < OWS_CONTROLLERS)
			count_ring(bells, events[i].data.u32);
}
