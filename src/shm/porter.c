/* SPDX-License-Identifier: MIT */
/* The porter: the process that sends over, and lets go of, what peers can make slow. */
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "hal/bus/time.h"
#include "src/shm/futex.h"
#include "src/shm/layout.h"
#include "src/shm/porter.h"

/* Younger than the headers of some machines that build owsd. */
#ifndef SO_PASSRIGHTS
#define SO_PASSRIGHTS 83
#endif
/* Orders that one child carries out, where they have nothing to do with each other. */
#define BATCH 64
/* The porter waits so long for a child, then it goes on. */
#define CHILD_NS (20 * NS_PER_MS)
/* Children of a lane that hang; with more of them the lane has to wait. */
#define CHILDREN 12
/* How often a hanging child is looked for. */
#define LOOK_MS 20
#define GIVEN_NS NS_PER_S
#define END_NS NS_PER_S
/* At the end of owsd the porter leaves that time to its children; those that hang are killed. */
#define LAST_CHILDREN_NS (NS_PER_S / 4)
/* A porter that is started again has to be ready by then, or it is killed: see porter_tend(). */
#define READY_NS (2 * NS_PER_S)
#define PAUSE_LEAST_NS NS_PER_S
#define PAUSE_MOST_NS (60 * NS_PER_S)
#define DRAINS 512 /* a socket holds fewer messages */

struct order_head {
	uint32_t sequence, what, slot;
};

/* Both sides have it. */
struct shared {
	uint32_t given[PORTER_LANES]; /* owsd has closed its own copies up to this order */
	uint32_t carried[PORTER_SLOTS];
	uint32_t ready; /* the process that has closed what is not its own */
};

struct porter {
	struct shared *shared;
	int lanes[PORTER_LANES];
	uint32_t sequence[PORTER_LANES];
	uint32_t asked[PORTER_SLOTS];
	pid_t pid;     /* 0: there is none */
	uint32_t gone; /* the lanes lead to nobody */
	/* The supervisor's, of the one that is started again. */
	int next[PORTER_LANES]; /* what becomes lanes when it is ready */
	int64_t begun_ns, again_ns, pause_ns;
};

union attached {
	struct cmsghdr align;
	char room[CMSG_SPACE(PORTER_FDS * sizeof(int))];
};

struct message {
	struct order_head head;
	struct iovec parts[2];
	struct msghdr header;
};

static void pause_ns(int64_t ns)
{
	const struct timespec t = {.tv_sec = (time_t)(ns / NS_PER_S),
	                           .tv_nsec = (long)(ns % NS_PER_S)};

	nanosleep(&t, NULL);
}

static void message_lay_out(struct message *m, struct iovec bytes)
{
	m->parts[0] = (struct iovec){&m->head, sizeof(m->head)};
	m->parts[1] = bytes;
	m->header = (struct msghdr){.msg_iov = m->parts, .msg_iovlen = bytes.iov_len ? 2 : 1};
}

static void attach(struct msghdr *header, void *room, const int *fds, unsigned count)
{
	struct cmsghdr *c = room; /* CMSG_FIRSTHDR(): there is room for one */

	header->msg_control = room;
	header->msg_controllen = CMSG_SPACE(count * sizeof(int));
	c->cmsg_level = SOL_SOCKET;
	c->cmsg_type = SCM_RIGHTS;
	c->cmsg_len = CMSG_LEN(count * sizeof(int));
	memcpy(CMSG_DATA(c), fds, count * sizeof(int));
}

/* --- What a child does ------------------------------------------------------------------------ */

static void send_over(const int *fds, unsigned count, struct iovec bytes)
{
	union attached control = {0};
	struct msghdr header = {.msg_iov = &bytes, .msg_iovlen = 1};

	if (count > 1)
		attach(&header, &control, fds + 1, count - 1);
	sendmsg(fds[0], &header, MSG_DONTWAIT | MSG_NOSIGNAL);
}

/* What is unread at close() is an error to the peer. */
static void hang_up(int fd)
{
	char byte;

	shutdown(fd, SHUT_RDWR);
	for (int i = 0; i < DRAINS && porter_receive(fd, &byte, 1, true) > 0; i++)
		;
}

static void wake(int image)
{
	const struct ows_image_header *h;

	h = mmap(NULL, sizeof(*h), PROT_READ, MAP_SHARED, image, 0);
	if (h == MAP_FAILED)
		return;
	segment_wake(&h->news, INT_MAX);
	munmap((void *)(uintptr_t)h, sizeof(*h));
}

static void empty(int file)
{
	struct stat st;

	/* a page stays that the hole does not cover whole; it may go beyond the end */
	if (fstat(file, &st) == 0)
		fallocate(file, FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, 0,
		          st.st_size + sysconf(_SC_PAGESIZE));
}

static void carry_out(unsigned what, const int *fds, unsigned count, struct iovec bytes)
{
	unsigned connections = what & PORTER_EACH ? count : 1;

	if (what & PORTER_WAKE)
		wake(fds[0]);
	if (what & PORTER_EMPTY)
		empty(fds[0]);
	for (unsigned i = 0; i < connections; i++) {
		if (what & PORTER_SEND)
			send_over(fds + i, what & PORTER_EACH ? 1 : count, bytes);
		if (what & PORTER_HANG_UP)
			hang_up(fds[i]);
	}
}

/* The child has to be the last that lets go. */
static void wait_until_given(const struct shared *shared, unsigned lane, uint32_t sequence)
{
	int64_t left_ns = GIVEN_NS;

	while ((int32_t)(__atomic_load_n(&shared->given[lane], __ATOMIC_ACQUIRE) - sequence) < 0 &&
	       left_ns > 0) {
		pause_ns(NS_PER_MS / 10);
		left_ns -= NS_PER_MS / 10;
	}
}

/* Returns whether there was an order. */
static bool take_order(struct porter *p, unsigned lane)
{
	char bytes[PORTER_BYTES];
	union attached control;
	struct message m;
	const struct cmsghdr *c;
	int fds[PORTER_FDS];
	unsigned count;
	ssize_t n;

	message_lay_out(&m, (struct iovec){bytes, sizeof(bytes)});
	m.header.msg_control = &control;
	m.header.msg_controllen = sizeof(control);
	do
		n = recvmsg(p->lanes[lane], &m.header, MSG_DONTWAIT | MSG_CMSG_CLOEXEC);
	while (n < 0 && errno == EINTR);
	if (n < (ssize_t)sizeof(m.head))
		return false;
	c = CMSG_FIRSTHDR(&m.header);
	if (c && c->cmsg_type == SCM_RIGHTS) {
		count = (unsigned)((c->cmsg_len - CMSG_LEN(0)) / sizeof(int));
		memcpy(fds, CMSG_DATA(c), count * sizeof(int));
		carry_out(m.head.what, fds, count,
		          (struct iovec){bytes, (size_t)n - sizeof(m.head)});
	}
	if (m.head.slot < PORTER_SLOTS)
		__atomic_store_n(&p->shared->carried[m.head.slot], m.head.sequence,
		                 __ATOMIC_RELEASE);
	wait_until_given(p->shared, lane, m.head.sequence);
	return true;
}

/*
 * All that it has received it lets go when it ends: then the kernel waits for no connection. Its
 * status: 0 if there was an order.
 */
static void be_child(struct porter *p, unsigned lane)
{
	int most = lane == PORTER_IN ? 1 : BATCH, taken = 0;

	/* a late child must not say of an order of the next porter that it is carried out */
	prctl(PR_SET_PDEATHSIG, SIGKILL);
	if (getppid() == p->pid)
		while (taken < most && take_order(p, lane))
			taken++;
	_exit(!taken);
}

/* --- The porter ------------------------------------------------------------------------------- */

struct children {
	pid_t pids[CHILDREN];
};

static unsigned count_children(struct children *of)
{
	unsigned n = 0;

	for (unsigned i = 0; i < CHILDREN; i++) {
		if (of->pids[i] > 0 && waitpid(of->pids[i], NULL, WNOHANG) != 0)
			of->pids[i] = 0;
		n += of->pids[i] > 0;
	}
	return n;
}

/* True: it has ended; *status: as of waitpid(). */
static bool wait_for(pid_t pid, int *status)
{
	const struct timespec most = {.tv_nsec = CHILD_NS};
	sigset_t set;

	sigemptyset(&set);
	sigaddset(&set, SIGCHLD);
	for (;;) {
		if (waitpid(pid, status, WNOHANG) != 0)
			return true;
		/* another child may have ended: then look again */
		if (sigtimedwait(&set, NULL, &most) < 0 && errno != EINTR)
			return waitpid(pid, status, WNOHANG) != 0;
	}
}

/* False: no order was carried out. */
static bool start_child(struct porter *p, unsigned lane, struct children *of)
{
	pid_t pid = fork();
	bool ended;
	int status = 0;

	if (pid == 0)
		be_child(p, lane);
	ended = pid < 0 || wait_for(pid, &status);
	/* too many processes, no memory, a child that is killed: the orders wait */
	if (pid < 0 || status) {
		pause_ns(LOOK_MS * NS_PER_MS);
		return false;
	}
	for (unsigned i = 0; !ended && i < CHILDREN; i++)
		if (of->pids[i] <= 0) {
			of->pids[i] = pid;
			break;
		}
	return true;
}

static bool porter_round(struct porter *p, struct children *children)
{
	struct pollfd fds[PORTER_LANES];
	bool hang = false, any = false;
	char byte;

	for (unsigned i = 0; i < PORTER_LANES; i++) {
		unsigned n = count_children(&children[i]);

		hang |= n > 0;
		fds[i] = (struct pollfd){.fd = p->lanes[i], .events = n < CHILDREN ? POLLIN : 0};
	}
	poll(fds, PORTER_LANES, hang ? LOOK_MS : -1);
	for (unsigned i = 0; i < PORTER_LANES; i++) {
		/* at the end of owsd what no child carries out goes with the porter */
		bool over = fds[i].revents & POLLHUP;
		if (over &&
		    (!fds[i].events || recv(p->lanes[i], &byte, 1, MSG_PEEK | MSG_DONTWAIT) <= 0))
			p->lanes[i] = -1;
		else if (fds[i].revents & POLLIN && !start_child(p, i, &children[i]) && over)
			p->lanes[i] = -1;
		any |= p->lanes[i] >= 0;
	}
	return any;
}

static bool is_lane(const struct porter *p, int fd)
{
	bool is = false;

	for (unsigned i = 0; i < PORTER_LANES; i++)
		is |= p->lanes[i] == fd;
	return is;
}

/*
 * Those of owsd, its output among them, are not to stay open for a child that hangs. /dev/null
 * takes the place of the first three: what a library writes there must not reach a peer's file.
 */
static void close_others(const struct porter *p)
{
	int null = open("/dev/null", O_RDWR | O_CLOEXEC), last = STDERR_FILENO;
	long most;

	for (int fd = 0; fd <= STDERR_FILENO; fd++)
		dup2(null, fd);
	for (unsigned i = 0; i < PORTER_LANES; i++)
		last = p->lanes[i] > last ? p->lanes[i] : last;
	for (int fd = STDERR_FILENO + 1; fd < last; fd++)
		if (!is_lane(p, fd))
			close(fd);
	if (syscall(SYS_close_range, last + 1, ~0U, 0) == 0)
		return;
	most = sysconf(_SC_OPEN_MAX); /* before Linux 5.9 */
	for (int fd = last + 1; fd < most; fd++)
		close(fd);
}

static void leave_children(struct children *children)
{
	int64_t left_ns = LAST_CHILDREN_NS;
	unsigned n = 1;

	while (n && left_ns > 0) {
		n = 0;
		for (unsigned i = 0; i < PORTER_LANES; i++)
			n += count_children(&children[i]);
		if (n)
			pause_ns(NS_PER_MS);
		left_ns -= NS_PER_MS;
	}
}

static void be_porter(struct porter *p)
{
	struct children children[PORTER_LANES] = {0};
	sigset_t all;

	sigfillset(&all);
	sigprocmask(SIG_SETMASK, &all, NULL);
	signal(SIGCHLD, SIG_DFL);
	prctl(PR_SET_NAME, "owsd-porter");
	close_others(p);
	p->pid = getpid();
	__atomic_store_n(&p->shared->ready, (uint32_t)p->pid, __ATOMIC_RELEASE);
	while (porter_round(p, children))
		;
	leave_children(children);
	_exit(0);
}

/* --- owsd's side ------------------------------------------------------------------------------ */

static void close_lanes(int *lanes)
{
	for (unsigned i = 0; i < PORTER_LANES; i++)
		if (lanes[i] >= 0)
			close(lanes[i]);
}

/* Whoever may have a copy of them, the porter learns that owsd has ended. */
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
	if (p->pid == 0) {
		/* a copy, in which nothing but the lanes is used */
		memcpy(p->lanes, theirs, sizeof(theirs));
		be_porter(p);
	}
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
		pause_ns(NS_PER_MS);
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

static void let_go(const struct porter_order *order)
{
	for (unsigned i = 0; i < order->count; i++)
		if (!(order->keep >> i & 1))
			close(order->fds[i]);
}

static int carry_here(const struct porter_order *order)
{
	carry_out(order->what, order->fds, order->count, order->bytes);
	let_go(order);
	return 0;
}

/* Returns what it was asked before. */
static uint32_t ask(struct porter *p, uint32_t slot, uint32_t sequence)
{
	return slot < PORTER_SLOTS
	               ? __atomic_exchange_n(&p->asked[slot], sequence, __ATOMIC_RELAXED)
	               : 0;
}

int porter_give(struct porter *p, enum porter_lane lane, const struct porter_order *order)
{
	union attached control = {0};
	struct message m;
	uint32_t sequence, asked;

	if (!p)
		return carry_here(order);
	sequence = ++p->sequence[lane];
	/* at once: when the porter is killed, what it was asked counts as carried out */
	asked = ask(p, order->slot, sequence);

	m.head = (struct order_head){sequence, order->what, order->slot};
	message_lay_out(&m, order->bytes);
	attach(&m.header, &control, order->fds, order->count);
	if (sendmsg(p->lanes[lane], &m.header, MSG_DONTWAIT | MSG_NOSIGNAL) < 0) {
		/* descriptors that are on their way are limited, as the room in the socket is */
		if (errno != EPIPE && errno != ECONNRESET && errno != ENOTCONN) {
			ask(p, order->slot, asked);
			return -EAGAIN;
		}
		if (order->slot < PORTER_SLOTS)
			__atomic_store_n(&p->shared->carried[order->slot], sequence,
			                 __ATOMIC_RELEASE);
		return carry_here(order);
	}
	let_go(order);
	__atomic_store_n(&p->shared->given[lane], sequence, __ATOMIC_RELEASE);
	return 0;
}

bool porter_carried(const struct porter *p, uint32_t slot)
{
	return !p || __atomic_load_n(&p->gone, __ATOMIC_RELAXED) ||
	       (int32_t)(__atomic_load_n(&p->shared->carried[slot], __ATOMIC_ACQUIRE) -
	                 __atomic_load_n(&p->asked[slot], __ATOMIC_RELAXED)) >= 0;
}

/* --- Connections ------------------------------------------------------------------------------ */

void porter_refuse_descriptors(int listener)
{
	int none = 0;

	setsockopt(listener, SOL_SOCKET, SO_PASSRIGHTS, &none, sizeof(none));
}

ptrdiff_t porter_receive(int connection, void *bytes, size_t room, bool take)
{
	struct iovec part = {bytes, room};
	struct msghdr message = {.msg_iov = &part, .msg_iovlen = 1};
	/* a look closes no descriptor, since the message stays; without room for them it says so */
	ssize_t n = recvmsg(connection, &message, MSG_PEEK | MSG_DONTWAIT | MSG_TRUNC);

	if (n < 0)
		return -errno;
	if (message.msg_flags & MSG_CTRUNC)
		return -EBADMSG;
	if (take && n > 0 &&
	    recv(connection, bytes, (size_t)n < room ? (size_t)n : room, MSG_DONTWAIT) < 0)
		return -errno;
	return n;
}
