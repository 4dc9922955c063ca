/* SPDX-License-Identifier: MIT */
/* owsd's side of the porter: starts it, again when it was killed, and gives it orders. */
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "hal/base/time.h"
#include "src/memory/shm/porter.h"
#include "src/memory/shm/porter_process.h"

#define END_NS NS_PER_S
/* A porter that is started again has to be ready by then, or it is killed: see porter_tend(). */
#define READY_NS (2 * NS_PER_S)
#define PAUSE_LEAST_NS NS_PER_S
#define PAUSE_MOST_NS (60 * NS_PER_S)

struct porter {
	struct porter_shared *shared;
	int lanes[PORTER_LANES];
	uint32_t sequence[PORTER_LANES];
	uint32_t asked[PORTER_SLOTS];
	pid_t pid;     /* 0: there is none */
	uint32_t gone; /* the lanes lead to no process */
	/* The supervisor's, of the one that is started again. */
	int next[PORTER_LANES]; /* what becomes lanes when it is ready */
	int64_t begun_ns, again_ns, pause_ns;
};

/* --- Started and ended ------------------------------------------------------------------------ */

static void close_lanes(int *lanes)
{
	for (unsigned i = 0; i < PORTER_LANES; i++)
		if (lanes[i] >= 0)
			close(lanes[i]);
}

/* Though other processes may have copies of them, the porter learns that owsd has ended. */
static void end_lanes(int *lanes)
{
	for (unsigned i = 0; i < PORTER_LANES; i++)
		shutdown(lanes[i], SHUT_RDWR);
	close_lanes(lanes);
}

static int open_lanes(int *ours, int *theirs)
{
	for (unsigned i = 0; i < PORTER_LANES; i++)
		ours[i] = theirs[i] = -1;
	for (unsigned i = 0; i < PORTER_LANES; i++) {
		int ends[2];

		if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0, ends) < 0)
			return -errno;
		ours[i] = ends[0];
		theirs[i] = ends[1];
	}
	return 0;
}

/* Fork a porter; ours: the ends for owsd. */
static int fork_porter(struct porter *p, int *ours)
{
	int theirs[PORTER_LANES], err = open_lanes(ours, theirs);

	p->pid = err ? -1 : fork();
	if (p->pid == 0)
		porter_main(theirs, p->shared);
	if (p->pid < 0) {
		err = err ? err : -errno;
		p->pid = 0;
		close_lanes(ours);
	}
	close_lanes(theirs);
	return err;
}

int porter_start(struct porter **porter)
{
	struct porter *p = calloc(1, sizeof(*p));
	int err = -ENOMEM;

	if (!p)
		return err;
	p->pause_ns = PAUSE_LEAST_NS;
	p->shared = mmap(NULL, sizeof(*p->shared), PROT_READ | PROT_WRITE,
	                 MAP_SHARED | MAP_ANONYMOUS, -1, 0);
	if (p->shared != MAP_FAILED)
		err = fork_porter(p, p->lanes);
	if (!err) {
		*porter = p;
		return 0;
	}
	if (p->shared != MAP_FAILED)
		munmap(p->shared, sizeof(*p->shared));
	free(p);
	return err;
}

static bool is_starting(const struct porter *p)
{
	return p->pid && p->gone;
}

void porter_end(struct porter *p)
{
	int64_t left_ns = END_NS;

	if (!p)
		return;
	end_lanes(p->lanes);
	if (is_starting(p))
		end_lanes(p->next);
	while (p->pid && waitpid(p->pid, NULL, WNOHANG) == 0 && left_ns > 0) {
		clock_pause(NS_PER_MS);
		left_ns -= NS_PER_MS;
	}
	munmap(p->shared, sizeof(*p->shared));
	free(p);
}

/* --- It is killed, and started again ---------------------------------------------------------- */

static void wait_longer(struct porter *p, int64_t now_ns)
{
	if (now_ns - p->begun_ns > PAUSE_MOST_NS)
		p->pause_ns = PAUSE_LEAST_NS;
	p->again_ns = now_ns + p->pause_ns;
	p->pause_ns = p->pause_ns < PAUSE_MOST_NS / 2 ? 2 * p->pause_ns : PAUSE_MOST_NS;
}

static enum porter_event start_again(struct porter *p, int64_t now_ns)
{
	p->begun_ns = now_ns;
	if (fork_porter(p, p->next) == 0)
		return PORTER_GOES_ON;
	wait_longer(p, now_ns);
	return PORTER_FAILED;
}

/* Each lane keeps its number here, so no thread that uses it notices. */
static void take_lanes(struct porter *p)
{
	/* what the last one had it let go of when it ended */
	for (unsigned i = 0; i < PORTER_SLOTS; i++)
		__atomic_store_n(&p->shared->carried[i],
		                 __atomic_load_n(&p->asked[i], __ATOMIC_RELAXED), __ATOMIC_RELEASE);
	for (unsigned i = 0; i < PORTER_LANES; i++)
		dup3(p->next[i], p->lanes[i], O_CLOEXEC);
	close_lanes(p->next);
	__atomic_store_n(&p->gone, 0, __ATOMIC_RELEASE);
}

enum porter_event porter_tend(struct porter *p, int64_t now_ns)
{
	bool starting = is_starting(p);

	if (p->pid && waitpid(p->pid, NULL, WNOHANG) != 0) {
		if (starting)
			close_lanes(p->next);
		p->pid = 0;
		__atomic_store_n(&p->gone, 1, __ATOMIC_RELAXED);
		wait_longer(p, now_ns);
		return starting ? PORTER_FAILED : PORTER_ENDED;
	}
	if (!p->pid)
		return now_ns < p->again_ns ? PORTER_GOES_ON : start_again(p, now_ns);
	if (!starting)
		return PORTER_GOES_ON;
	if (__atomic_load_n(&p->shared->ready, __ATOMIC_ACQUIRE) == (uint32_t)p->pid) {
		take_lanes(p);
		return PORTER_IS_BACK;
	}
	if (now_ns - p->begun_ns > READY_NS)
		kill(p->pid, SIGKILL);
	return PORTER_GOES_ON;
}

int porter_process(const struct porter *p)
{
	return (int)p->pid;
}

/* --- Orders ----------------------------------------------------------------------------------- */

static void close_given(const struct porter_order *order)
{
	for (unsigned i = 0; i < order->count; i++)
		if (!(order->keep >> i & 1))
			close(order->fds[i]);
}

static int carry_here(const struct porter_order *order)
{
	porter_carry_out(order->what, order->fds, order->count, order->bytes);
	close_given(order);
	return 0;
}

/* Returns what it was asked before. */
static uint32_t porter_ask(struct porter *p, uint32_t slot, uint32_t sequence)
{
	return slot < PORTER_SLOTS
	               ? __atomic_exchange_n(&p->asked[slot], sequence, __ATOMIC_RELAXED)
	               : 0;
}

int porter_give(struct porter *p, enum porter_lane lane, const struct porter_order *order)
{
	union porter_attached control = {0};
	struct porter_message m;
	uint32_t sequence, asked;

	if (!p)
		return carry_here(order);
	sequence = ++p->sequence[lane];
	/* at once: when the porter is killed, what it was asked counts as carried out */
	asked = porter_ask(p, order->slot, sequence);

	m.head = (struct porter_head){sequence, order->what, order->slot};
	porter_lay_out(&m, order->bytes);
	porter_attach(&m.header, &control, order->fds, order->count);
	if (sendmsg(p->lanes[lane], &m.header, MSG_DONTWAIT | MSG_NOSIGNAL) < 0) {
		/* descriptors that are on their way are limited, as the room in the socket is */
		if (errno != EPIPE && errno != ECONNRESET && errno != ENOTCONN) {
			porter_ask(p, order->slot, asked);
			return -EAGAIN;
		}
		if (order->slot < PORTER_SLOTS)
			__atomic_store_n(&p->shared->carried[order->slot], sequence,
			                 __ATOMIC_RELEASE);
		return carry_here(order);
	}
	close_given(order);
	__atomic_store_n(&p->shared->given[lane], sequence, __ATOMIC_RELEASE);
	return 0;
}

bool porter_carried(const struct porter *p, uint32_t slot)
{
	return !p || __atomic_load_n(&p->gone, __ATOMIC_RELAXED) ||
	       (int32_t)(__atomic_load_n(&p->shared->carried[slot], __ATOMIC_ACQUIRE) -
	                 __atomic_load_n(&p->asked[slot], __ATOMIC_RELAXED)) >= 0;
}
