/* SPDX-License-Identifier: MIT */
/* Three threads in two processes that wake one another, as a command wakes engine, worker, peer. */
#include <arpa/inet.h>
#include <netinet/tcp.h>
#include <signal.h>
#include <sys/eventfd.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/bench/aid.h"
#include "tests/bench/wakes.h"

#define LONGEST_NS 3000000000

static void *pass_on(void *ctx)
{
	struct bench_wakes *wakes = ctx;
	uint64_t one;

	while (read(wakes->fd[1], &one, sizeof(one)) == sizeof(one))
		if (write(wakes->last, &one, sizeof(one)) != sizeof(one))
			break;
	return NULL;
}

static void live(struct bench_wakes *wakes)
{
	pthread_t thread;
	uint64_t one;

	prctl(PR_SET_PDEATHSIG, SIGKILL);
	if (pthread_create(&thread, NULL, pass_on, wakes))
		_exit(1);
	while (read(wakes->fd[0], &one, sizeof(one)) == sizeof(one))
		if (write(wakes->fd[1], &one, sizeof(one)) != sizeof(one))
			break;
	_exit(0);
}

static void *take_the_time(void *ctx)
{
	struct bench_wakes *wakes = ctx;
	uint64_t one;

	while (read(wakes->fd[2], &one, sizeof(one)) == sizeof(one))
		__atomic_store_n(&wakes->awake_ns, bench_now(), __ATOMIC_RELEASE);
	return NULL;
}

static bool connect_loopback(struct bench_wakes *wakes)
{
	struct sockaddr_in a = {.sin_family = AF_INET};
	int listener = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
	socklen_t len = sizeof(a);

	a.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
	if (listener < 0)
		return false;
	if (bind(listener, (void *)&a, sizeof(a)) == 0 && listen(listener, 1) == 0 &&
	    getsockname(listener, (void *)&a, &len) == 0) {
		wakes->last = bench_socket(ntohs(a.sin_port));
		if (wakes->last >= 0)
			wakes->fd[2] = accept(listener, NULL, NULL);
	}
	close(listener);
	return wakes->fd[2] >= 0;
}

static void close_all(const struct bench_wakes *wakes)
{
	for (int i = 0; i < 3; i++)
		if (wakes->fd[i] >= 0)
			close(wakes->fd[i]);
	if (wakes->last >= 0 && wakes->last != wakes->fd[2])
		close(wakes->last);
}

bool bench_wakes_start(struct bench_wakes *wakes, bool loopback)
{
	*wakes = (struct bench_wakes){.fd = {-1, -1, -1}, .last = -1};
	for (int i = 0; i < 3 - loopback; i++)
		wakes->fd[i] = eventfd(0, EFD_CLOEXEC);
	if (!loopback)
		wakes->last = wakes->fd[2];
	else if (!connect_loopback(wakes))
		wakes->last = -1;
	if (wakes->fd[0] < 0 || wakes->fd[1] < 0 || wakes->fd[2] < 0 || wakes->last < 0) {
		close_all(wakes);
		return false;
	}
	wakes->pid = fork();
	if (wakes->pid == 0)
		live(wakes);
	if (wakes->pid < 0 || pthread_create(&wakes->thread, NULL, take_the_time, wakes)) {
		close_all(wakes);
		return false;
	}
	return true;
}

double bench_wakes_once(struct bench_wakes *wakes)
{
	int64_t begin, end;
	uint64_t one = 1;

	__atomic_store_n(&wakes->awake_ns, 0, __ATOMIC_RELEASE);
	begin = bench_now();
	if (write(wakes->fd[0], &one, sizeof(one)) != sizeof(one))
		return -1;
	while (!(end = __atomic_load_n(&wakes->awake_ns, __ATOMIC_ACQUIRE))) {
		if (bench_now() - begin > LONGEST_NS)
			return -1;
		usleep(50);
	}
	return (double)(end - begin) / 1e3;
}

void bench_wakes_end(struct bench_wakes *wakes)
{
	kill(wakes->pid, SIGKILL);
	waitpid(wakes->pid, NULL, 0);
	pthread_cancel(wakes->thread);
	pthread_join(wakes->thread, NULL);
	close_all(wakes);
}
