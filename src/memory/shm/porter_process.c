/* SPDX-License-Identifier: MIT */
/* The process of the porter, and its children, which carry orders out. */
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "hal/base/time.h"
#include "src/memory/shm/futex.h"
#include "src/memory/shm/peer.h"
#include "src/memory/shm/porter_process.h"
#include "src/public/ows_layout.h"

/* Orders that one child carries out, where they have nothing to do with each other. */
#define BATCH 64
/* The porter waits so long for a child, then it goes on. */
#define CHILD_NS (20 * NS_PER_MS)
/* Children of a lane that hang; with more of them the lane has to wait. */
#define CHILDREN 12
/* How often a hanging child is looked for. */
#define LOOK_MS 20
#define GIVEN_NS NS_PER_S
/* At the end of owsd the porter leaves that time to its children; those that hang are killed. */
#define LAST_CHILDREN_NS (NS_PER_S / 4)
#define DRAINS 512 /* a socket holds fewer messages */

struct process {
	struct porter_shared *shared;
	int lanes[PORTER_LANES];
	pid_t pid;
};

void porter_lay_out(struct porter_message *m, struct iovec bytes)
{
	m->parts[0] = (struct iovec){&m->head, sizeof(m->head)};
	m->parts[1] = bytes;
	m->header = (struct msghdr){.msg_iov = m->parts, .msg_iovlen = bytes.iov_len ? 2 : 1};
}

void porter_attach(struct msghdr *header, union porter_attached *control, const int *fds,
                   unsigned count)
{
	struct cmsghdr *c = &control->align; /* CMSG_FIRSTHDR(): there is room for one */

	header->msg_control = control;
	header->msg_controllen = CMSG_SPACE(count * sizeof(int));
	c->cmsg_level = SOL_SOCKET;
	c->cmsg_type = SCM_RIGHTS;
	c->cmsg_len = CMSG_LEN(count * sizeof(int));
	memcpy(CMSG_DATA(c), fds, count * sizeof(int));
}

/* --- What a child does ------------------------------------------------------------------------ */

static void send_over(const int *fds, unsigned count, struct iovec bytes)
{
	union porter_attached control = {0};
	struct msghdr header = {.msg_iov = &bytes, .msg_iovlen = 1};

	if (count > 1)
		porter_attach(&header, &control, fds + 1, count - 1);
	sendmsg(fds[0], &header, MSG_DONTWAIT | MSG_NOSIGNAL);
}

/* What is unread at close() is an error to the peer. */
static void end_connection(int fd)
{
	char byte;

	shutdown(fd, SHUT_RDWR);
	for (int i = 0; i < DRAINS && peer_receive(fd, &byte, 1, true) > 0; i++)
		;
}

static void wake_sleepers(int image)
{
	const struct ows_image_header *h;

	h = mmap(NULL, sizeof(*h), PROT_READ, MAP_SHARED, image, 0);
	if (h == MAP_FAILED)
		return;
	segment_wake(&h->news, INT_MAX);
	munmap((void *)(uintptr_t)h, sizeof(*h));
}

static void free_pages(int file)
{
	struct stat st;

	/* a page stays that the hole does not cover whole; it may go beyond the end */
	if (fstat(file, &st) == 0)
		fallocate(file, FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, 0,
		          st.st_size + sysconf(_SC_PAGESIZE));
}

void porter_carry_out(unsigned what, const int *fds, unsigned count, struct iovec bytes)
{
	unsigned connections = what & PORTER_EACH ? count : 1;

	if (what & PORTER_WAKE)
		wake_sleepers(fds[0]);
	if (what & PORTER_EMPTY)
		free_pages(fds[0]);
	for (unsigned i = 0; i < connections; i++) {
		if (what & PORTER_SEND)
			send_over(fds + i, what & PORTER_EACH ? 1 : count, bytes);
		if (what & PORTER_HANG_UP)
			end_connection(fds[i]);
	}
}

/* The child has to be the last that lets go. */
static void wait_until_given(const struct porter_shared *shared, unsigned lane, uint32_t sequence)
{
	int64_t left_ns = GIVEN_NS;

	while ((int32_t)(__atomic_load_n(&shared->given[lane], __ATOMIC_ACQUIRE) - sequence) < 0 &&
	       left_ns > 0) {
		clock_pause(NS_PER_MS / 10);
		left_ns -= NS_PER_MS / 10;
	}
}

/* Returns whether there was an order. */
static bool take_order(struct process *p, unsigned lane)
{
	char bytes[PORTER_BYTES];
	union porter_attached control;
	struct porter_message m;
	const struct cmsghdr *c;
	int fds[PORTER_FDS];
	unsigned count;
	ssize_t n;

	porter_lay_out(&m, (struct iovec){bytes, sizeof(bytes)});
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
		porter_carry_out(m.head.what, fds, count,
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
static void be_child(struct process *p, unsigned lane)
{
	int most = lane == PORTER_IN ? 1 : BATCH, taken = 0;

	/* a late child must not say of an order of the next porter that it is carried out */
	prctl(PR_SET_PDEATHSIG, SIGKILL);
	if (getppid() == p->pid)
		while (taken < most && take_order(p, lane))
			taken++;
	_exit(taken ? EXIT_SUCCESS : EXIT_FAILURE);
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
static bool start_child(struct process *p, unsigned lane, struct children *of)
{
	pid_t pid = fork();
	bool ended;
	int status = 0;

	if (pid == 0)
		be_child(p, lane);
	ended = pid < 0 || wait_for(pid, &status);
	/* too many processes, no memory, a child that is killed: the orders wait */
	if (pid < 0 || status) {
		clock_pause(LOOK_MS * NS_PER_MS);
		return false;
	}
	for (unsigned i = 0; !ended && i < CHILDREN; i++)
		if (of->pids[i] <= 0) {
			of->pids[i] = pid;
			break;
		}
	return true;
}

static bool porter_round(struct process *p, struct children *children)
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
		bool empty = over && (!fds[i].events ||
		                      recv(p->lanes[i], &byte, 1, MSG_PEEK | MSG_DONTWAIT) <= 0);
		if (empty || (fds[i].revents & POLLIN && !start_child(p, i, &children[i]) && over))
			p->lanes[i] = -1;
		any |= p->lanes[i] >= 0;
	}
	return any;
}

static bool is_lane(const struct process *p, int fd)
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
static void close_others(const struct process *p)
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
			clock_pause(NS_PER_MS);
		left_ns -= NS_PER_MS;
	}
}

_Noreturn void porter_main(const int *lanes, struct porter_shared *shared)
{
	struct children children[PORTER_LANES] = {0};
	struct process p = {.shared = shared, .pid = getpid()};
	sigset_t all;

	memcpy(p.lanes, lanes, sizeof(p.lanes));
	sigfillset(&all);
	sigprocmask(SIG_SETMASK, &all, NULL);
	signal(SIGCHLD, SIG_DFL);
	prctl(PR_SET_NAME, "owsd-porter");
	close_others(&p);
	__atomic_store_n(&shared->ready, (uint32_t)p.pid, __ATOMIC_RELEASE);
	while (porter_round(&p, children))
		;
	leave_children(children);
	_exit(0);
}
