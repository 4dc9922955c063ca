/* SPDX-License-Identifier: MIT */
/*
 * From ows_set() in a control program to the request of an idle owsd at its owserver: a peer of our
 * own takes the time when the write arrives, so one hop over loopback is in the figure. Beside it,
 * in turn with the sets, what it costs to wake as many threads: engine, worker, peer. Then both
 * again 0.1 ms apart ("warm"): the difference to 1 to 10 ms is what caches and processors forget.
 */
#include <arpa/inet.h>
#include <netinet/tcp.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "src/public/ows.h"
#include "tests/bench/aid.h"
#include "tests/bench/wakes.h"

#define SETS 500
#define WRITE 3
#define PRESENT 6

static int64_t arrived_ns;

static void *serve(void *ctx)
{
	int listener = *(int *)ctx, on = 1;

	for (;;) {
		int fd = accept(listener, NULL, NULL);
		uint32_t word[6];
		char payload[512];

		if (fd < 0)
			return NULL;
		setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof(on));
		while (recv(fd, word, sizeof(word), MSG_WAITALL) == sizeof(word)) {
			int64_t now = bench_now();
			uint32_t type = ntohl(word[2]);
			/* behind the data: a token of each server that it came through */
			uint32_t len = ntohl(word[1]) + 16 * (ntohl(word[0]) & 0xffff);

			if (len > sizeof(payload) ||
			    (len && recv(fd, payload, len, MSG_WAITALL) != (ssize_t)len))
				break;
			word[1] = 0;
			word[0] = 0;
			word[2] = type == 1 || type == WRITE || type == PRESENT
			                  ? 0
			                  : htonl((uint32_t)-1);
			if (send(fd, word, sizeof(word), MSG_NOSIGNAL) != sizeof(word))
				break;
			if (type == WRITE)
				__atomic_store_n(&arrived_ns, now, __ATOMIC_RELEASE);
		}
		close(fd);
	}
}

static pid_t start_owsd(const char *self, const char *folder, const char *instance, int port)
{
	char program[512], file[128];
	const char *slash = strrchr(self, '/');
	pid_t pid;
	FILE *f;

	snprintf(program, sizeof(program), "%.*s/../owsd", slash ? (int)(slash - self) : 1,
	         slash ? self : ".");
	snprintf(file, sizeof(file), "%s/bench.rio", folder);
	f = fopen(file, "w");
	if (!f)
		return -1;
	fprintf(f,
	        "OwsDrv {\n  TargetName \"127.0.0.1:%d\"\n  Period 1\n  Item {\n    Name \"relay\"\n"
	        "    Path \"/29.000029D60000/PIO.BYTE\"\n    Type long\n    IO output\n  }\n}\n",
	        port);
	fclose(f);
	pid = fork();
	if (pid == 0) {
		prctl(PR_SET_PDEATHSIG, SIGKILL);
		execl(program, program, "-c", file, "-n", instance, (char *)NULL);
		_exit(127);
	}
	return pid;
}

static void pause_for(int i, bool warm)
{
	usleep(warm ? 100 : 1000 + (useconds_t)(i * 7919 % 9000));
}

/* Less than 0: the set did not arrive. */
static double set_once(struct ows *h, int id, int value)
{
	int64_t begin, end;

	__atomic_store_n(&arrived_ns, 0, __ATOMIC_RELEASE);
	begin = bench_now();
	if (ows_set_integer(h, id, value, NULL))
		return -1;
	while (!(end = __atomic_load_n(&arrived_ns, __ATOMIC_ACQUIRE))) {
		if (bench_now() - begin > 3000000000)
			return -1;
		usleep(50);
	}
	return (double)(end - begin) / 1e3;
}

static void line(const char *name, const char *what, double value, const char *unit)
{
	char text[64];

	snprintf(text, sizeof(text), "%s%s", name, what);
	bench_line(text, value, unit);
}

static void report(const char *name, double *us, double *wakes, double *hops)
{
	double set = bench_percentile(us, SETS, 50), hop = bench_percentile(hops, SETS, 50);

	line(name, "", set, "us");
	bench_distribution(name, us, SETS, "us");
	line(name, ".wakes", bench_percentile(wakes, SETS, 50), "us");
	line(name, ".wakes_loopback", hop, "us");
	line(name, ".over_wakes", set / bench_percentile(wakes, SETS, 50), "times");
	line(name, ".over_wakes_loopback", set / hop, "times");
}

int main(int argc, char **argv)
{
	static double us[SETS], wakes[SETS], hops[SETS];
	struct bench_wakes by_eventfd, by_loopback;
	struct sockaddr_in a = {.sin_family = AF_INET};
	socklen_t len = sizeof(a);
	char folder[] = "/tmp/owsd-bench-XXXXXX", instance[32], path[128];
	int listener = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0), id = -1, done = 0;
	struct ows *h = NULL;
	pthread_t thread;
	pid_t pid;

	(void)argc;
	bench_dir();
	a.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
	if (bind(listener, (void *)&a, sizeof(a)) || listen(listener, 4) ||
	    getsockname(listener, (void *)&a, &len) || !mkdtemp(folder))
		return 1;
	pthread_create(&thread, NULL, serve, &listener);
	snprintf(instance, sizeof(instance), "bench-%d", (int)getpid());
	pid = start_owsd(argv[0], folder, instance, ntohs(a.sin_port));
	for (int i = 0; i < 200 && id < 0; i++) {
		usleep(20000);
		if (!h && ows_open(instance, OWS_CONTROL, &h))
			h = NULL;
		if (h)
			id = ows_find(h, "relay");
	}
	if (!bench_wakes_start(&by_eventfd, false) || !bench_wakes_start(&by_loopback, true))
		return 1;
	usleep(200000);
	for (int warm = 0; id >= 0 && warm < 2; warm++) {
		for (done = 0; done < SETS; done++) {
			pause_for(done, warm);
			us[done] = set_once(h, id, warm * SETS + done + 1);
			pause_for(done, warm);
			wakes[done] = bench_wakes_once(&by_eventfd);
			pause_for(done, warm);
			hops[done] = bench_wakes_once(&by_loopback);
			if (us[done] < 0 || wakes[done] < 0 || hops[done] < 0)
				break;
		}
		if (done < SETS) {
			fprintf(stderr, "set_to_wire: only %d of %d sets arrived\n", done, SETS);
			break;
		}
		report(warm ? "set_to_wire.warm" : "set_to_wire", us, wakes, hops);
	}
	bench_wakes_end(&by_eventfd);
	bench_wakes_end(&by_loopback);
	ows_close(h);
	kill(pid, SIGTERM);
	waitpid(pid, NULL, 0);
	snprintf(path, sizeof(path), "%s/bench.rio", folder);
	unlink(path);
	rmdir(folder);
	return done == SETS ? 0 : 1;
}
