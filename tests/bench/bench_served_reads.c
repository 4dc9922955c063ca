/* SPDX-License-Identifier: MIT */
/*
 * Reads per second and latency of the served protocol beside the genuine owserver: the same paths
 * of the same simulated network, over 1, 16 and 64 kept connections, each with one request on its
 * way, and over a new connection for each read; on one CPU with the server, and on another. And
 * what 64 clients cost in memory, and whether they make the engine late.
 */
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

#define DEVICES 100
#define CLIENTS 64
#define SECOND 1000000000
#define SAMPLES 400000

static double latency[SAMPLES];

struct side {
	const char *name; /* behind the figure */
	int port;
	pid_t pid;
};

/* Requests on all n connections, one at a time on each, for a second. */
static double run(const struct side *side, const struct bench_peer *peer, int n, size_t *samples)
{
	int64_t sent[CLIENTS], begun, now = 0;
	unsigned done = 0, at = 0;
	int fds[CLIENTS];
	bool ok = true;

	*samples = 0;
	for (int i = 0; i < n; i++) {
		fds[i] = bench_socket(side->port);
		sent[i] = bench_now();
		ok &= bench_send(fds[i], peer->paths[at++ % DEVICES]);
	}
	begun = bench_now();
	for (int i = 0; ok && now - begun < SECOND; i = (i + 1) % n) {
		char data[64];

		ok = bench_receive(fds[i], data, sizeof(data)) == 12;
		now = bench_now();
		if (*samples < SAMPLES)
			latency[(*samples)++] = (double)(now - sent[i]) / 1000;
		done += ok;
		sent[i] = now;
		ok = ok && bench_send(fds[i], peer->paths[at++ % DEVICES]);
	}
	for (int i = 0; i < n; i++)
		close(fds[i]);
	return ok ? done / ((double)(now - begun) / SECOND) : 0;
}

/* A new connection for each read, one after the other, for a second. */
static double run_once_each(const struct side *side, const struct bench_peer *peer, size_t *samples)
{
	int64_t begun = bench_now(), now = begun;
	unsigned done = 0;

	for (*samples = 0; now - begun < SECOND; done++) {
		int64_t begin = now;
		char data[64];
		int fd = bench_socket_once(side->port);
		bool ok = fd >= 0 && bench_send_once(fd, peer->paths[done % DEVICES]) &&
		          bench_receive(fd, data, sizeof(data)) == 12;

		close(fd);
		if (!ok)
			return 0;
		now = bench_now();
		if (*samples < SAMPLES)
			latency[(*samples)++] = (double)(now - begin) / 1000;
	}
	return done / ((double)(now - begun) / SECOND);
}

/* n connections; 0: a new one for each read. The best of three. */
static void compare(const struct side *sides, const struct bench_peer *peer, const char *where,
                    int n)
{
	char name[64], count[16] = "new";

	if (n)
		snprintf(count, sizeof(count), "%d", n);
	for (int i = 0; i < 2; i++) {
		double best = 0, p50 = 0, p99 = 0;

		for (int round = 0; round < 3; round++) {
			size_t samples;
			double rate = n ? run(&sides[i], peer, n, &samples)
			                : run_once_each(&sides[i], peer, &samples);

			if (rate <= best)
				continue;
			best = rate;
			p50 = bench_percentile(latency, samples, 50);
			p99 = bench_percentile(latency, samples, 99);
		}
		snprintf(name, sizeof(name), "served_reads.%s.%s%s", where, count, sides[i].name);
		bench_line(name, best, "1/s");
		snprintf(name, sizeof(name), "served_p50.%s.%s%s", where, count, sides[i].name);
		bench_line(name, p50, "us");
		snprintf(name, sizeof(name), "served_p99.%s.%s%s", where, count, sides[i].name);
		bench_line(name, p99, "us");
	}
}

static double resident_kb(pid_t pid)
{
	char path[64], line[256];
	double value = -1;
	FILE *f;

	snprintf(path, sizeof(path), "/proc/%d/status", (int)pid);
	f = fopen(path, "r");
	while (f && fgets(line, sizeof(line), f))
		if (strncmp(line, "VmRSS:", 6) == 0)
			value = atof(line + 6);
	if (f)
		fclose(f);
	return value;
}

static void memory(const struct side *sides, const struct bench_peer *peer)
{
	for (int i = 0; i < 2; i++) {
		int fds[CLIENTS];
		char name[64], data[64];

		snprintf(name, sizeof(name), "served_rss.before%s", sides[i].name);
		bench_line(name, resident_kb(sides[i].pid), "KiB");
		for (int k = 0; k < CLIENTS; k++) {
			fds[k] = bench_socket(sides[i].port);
			if (fds[k] >= 0)
				bench_read(fds[k], peer->paths[k], data, sizeof(data));
		}
		snprintf(name, sizeof(name), "served_rss.%d_clients%s", CLIENTS, sides[i].name);
		bench_line(name, resident_kb(sides[i].pid), "KiB");
		for (int k = 0; k < CLIENTS; k++)
			close(fds[k]);
	}
}

static void lateness(const char *instance)
{
	struct ows_counter counter;
	struct ows *h;

	if (ows_open(instance, OWS_READ, &h))
		return;
	for (int i = 0; ows_counter(h, i, &counter) == 0; i++)
		if (strcmp(counter.name, "periods") == 0 ||
		    strcmp(counter.name, "late_periods") == 0) {
			char name[64];

			snprintf(name, sizeof(name), "served_%s", counter.name);
			bench_line(name, (double)counter.value, "periods");
		}
	ows_close(h);
}

static bool write_file(const char *file, const struct bench_peer *peer)
{
	FILE *f = fopen(file, "w");

	if (!f)
		return false;
	fprintf(f, "OwsDrv {\n  TargetName \"127.0.0.1:%d\"\n", peer->port);
	for (unsigned i = 0; i < peer->devices; i++)
		fprintf(f,
		        "  Item {\n    Name \"t%u\"\n    Path \"%s\"\n    Type double\n    IO input\n"
		        "    PerFactor 5\n  }\n",
		        i, peer->paths[i]);
	fputs("}\n", f);
	return fclose(f) == 0;
}

int main(int argc, char **argv)
{
	static const int clients[] = {0, 1, 16, 64};
	char program[512], file[128], instance[32], port[16];
	const char *slash = strrchr(argv[0], '/');
	struct bench_peer peer;
	struct side sides[2];

	(void)argc;
	bench_dir();
	if (!bench_peer_start(&peer, DEVICES, 0))
		return 0;
	snprintf(program, sizeof(program), "%.*s/../owsd", slash ? (int)(slash - argv[0]) : 1,
	         slash ? argv[0] : ".");
	snprintf(file, sizeof(file), "%s/bench.rio", peer.folder);
	snprintf(instance, sizeof(instance), "bench-%d", (int)getpid());
	sides[1] = (struct side){".owserver", peer.port, peer.pid};
	sides[0] = (struct side){"", bench_port(), 0};
	snprintf(port, sizeof(port), "%d", sides[0].port);
	if (!write_file(file, &peer))
		return 1;
	sides[0].pid = fork();
	if (sides[0].pid == 0) {
		prctl(PR_SET_PDEATHSIG, SIGKILL);
		bench_pin(0);
		execl(program, program, "-c", file, "-n", instance, "-l", port, (char *)NULL);
		_exit(127);
	}
	sleep(3);
	memory(sides, &peer);
	for (int cpu = 0; cpu < 2 && cpu < bench_cpus(); cpu++) {
		bench_pin(cpu);
		for (int i = 0; i < 4; i++)
			compare(sides, &peer, cpu ? "apart" : "pinned", clients[i]);
	}
	lateness(instance);
	kill(sides[0].pid, SIGTERM);
	waitpid(sides[0].pid, NULL, 0);
	unlink(file);
	bench_peer_end(&peer);
	return 0;
}
