/* SPDX-License-Identifier: MIT */
/*
 * What the benches share: time, placement, lines of figures, and the genuine owserver as the peer.
 */
#include <arpa/inet.h>
#include <errno.h>
#include <ftw.h>
#include <math.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sched.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "tests/bench/aid.h"

#define FLAG_PERSIST 0x4
#define TYPE_READ 2
#define TYPE_WRITE 3
#define TYPE_DIRALL 7

int64_t bench_now(void)
{
	struct timespec t;

	clock_gettime(CLOCK_MONOTONIC, &t);
	return (int64_t)t.tv_sec * 1000000000 + t.tv_nsec;
}

bool bench_pin(int cpu)
{
	cpu_set_t set;

	CPU_ZERO(&set);
	CPU_SET((size_t)cpu, &set);
	return sched_setaffinity(0, sizeof(set), &set) == 0;
}

int bench_cpus(void)
{
	return (int)sysconf(_SC_NPROCESSORS_ONLN);
}

static struct shm_dir dir = {.fd = -1};
static pid_t maker;

static int remove_one(const char *path, const struct stat *st, int kind, struct FTW *at)
{
	(void)st;
	(void)kind;
	(void)at;
	return remove(path);
}

static void remove_place(void)
{
	if (getpid() == maker)
		nftw(dir.path, remove_one, 4, FTW_DEPTH | FTW_PHYS);
}

const struct shm_dir *bench_dir(void)
{
	char path[] = "/dev/shm/owsd-bench-XXXXXX";

	if (dir.fd >= 0)
		return &dir;
	if (!mkdtemp(path) || setenv("OWS_DIR", path, 1) || dir_make(&dir)) {
		perror(path);
		exit(1);
	}
	maker = getpid();
	atexit(remove_place);
	return &dir;
}

void bench_line(const char *name, double value, const char *unit)
{
	printf("%s %.*f %s\n", name, fabs(value) < 100 ? 2 : 0, value, unit);
	fflush(stdout);
}

void bench_note(const char *text)
{
	printf("# %s\n", text);
	fflush(stdout);
}

static int compare(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;

	return (x > y) - (x < y);
}

double bench_percentile(double *values, size_t n, double p)
{
	size_t at = (size_t)((double)(n - 1) * p / 100.0 + 0.5);

	qsort(values, n, sizeof(*values), compare);
	return values[at];
}

void bench_distribution(const char *name, double *values, size_t n, const char *unit)
{
	static const double points[] = {0, 1, 10, 25, 50, 75, 90, 99, 99.9, 99.99, 100};
	char line[96];

	for (size_t i = 0; i < sizeof(points) / sizeof(points[0]); i++) {
		/* beyond 1 / n a percentile is the largest value only */
		if (points[i] < 100 && (100 - points[i]) / 100 * (double)n < 1)
			continue;
		snprintf(line, sizeof(line), "%s.p%g", name, points[i]);
		bench_line(line, bench_percentile(values, n, points[i]), unit);
	}
}

int64_t bench_cpu_ns(pid_t pid)
{
	unsigned long user, system;
	char path[64], line[1024], *end;
	FILE *f;
	size_t n;

	snprintf(path, sizeof(path), "/proc/%d/stat", (int)pid);
	f = fopen(path, "r");
	if (!f)
		return 0;
	n = fread(line, 1, sizeof(line) - 1, f);
	fclose(f);
	line[n] = '\0';
	end = strrchr(line, ')');
	if (!end || sscanf(end + 2, "%*c %*d %*d %*d %*d %*d %*u %*u %*u %*u %*u %lu %lu", &user,
	                   &system) != 2)
		return 0;
	return (int64_t)(user + system) * (1000000000 / sysconf(_SC_CLK_TCK));
}

pid_t bench_start(const char *program, const char *const arguments[], int in, int out)
{
	pid_t pid = fork();

	if (pid != 0)
		return pid;
	prctl(PR_SET_PDEATHSIG, SIGKILL);
	if (in >= 0)
		dup2(in, STDIN_FILENO);
	if (out >= 0)
		dup2(out, STDOUT_FILENO);
	execvp(program, (char *const *)(uintptr_t)arguments);
	_exit(127);
}

void bench_stop(pid_t pid, int signal)
{
	if (pid <= 0)
		return;
	kill(pid, signal);
	waitpid(pid, NULL, 0);
}

int bench_port(void)
{
	struct sockaddr_in a = {.sin_family = AF_INET};
	socklen_t len = sizeof(a);
	int fd = socket(AF_INET, SOCK_STREAM, 0), port = 0;

	a.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
	if (fd >= 0 && bind(fd, (void *)&a, sizeof(a)) == 0 &&
	    getsockname(fd, (void *)&a, &len) == 0)
		port = ntohs(a.sin_port);
	close(fd);
	return port;
}

static int connect_from(uint32_t address, int port)
{
	struct sockaddr_in a = {.sin_family = AF_INET, .sin_port = htons((uint16_t)port)},
			   own = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(address)};
	int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0), on = 1;

	a.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
	if (fd < 0)
		return -1;
	if (address) {
		setsockopt(fd, IPPROTO_IP, IP_BIND_ADDRESS_NO_PORT, &on, sizeof(on));
		if (bind(fd, (void *)&own, sizeof(own)))
			perror("bind");
	}
	if (connect(fd, (void *)&a, sizeof(a))) {
		close(fd);
		return -1;
	}
	setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof(on));
	return fd;
}

int bench_socket(int port)
{
	return connect_from(0, port);
}

int bench_socket_once(int port)
{
	static uint32_t turn;

	turn = turn % 0xfffe + 1;
	return connect_from(0x7f010000 + turn, port);
}

/* text: what is written, of size bytes; NULL: size bytes are expected. */
static bool request(int fd, uint32_t type, uint32_t flags, const char *path, const char *text,
                    size_t size)
{
	char frame[24 + 256];
	uint32_t len = (uint32_t)strlen(path) + 1, all = len + (text ? (uint32_t)size : 0), word[6];

	word[0] = 0;
	word[1] = htonl(all);
	word[2] = htonl(type);
	word[3] = htonl(flags | 0x100);
	word[4] = htonl((uint32_t)size);
	word[5] = 0;
	memcpy(frame, word, 24);
	memcpy(frame + 24, path, len);
	if (text)
		memcpy(frame + 24 + len, text, size);
	return send(fd, frame, 24 + all, MSG_NOSIGNAL) == (ssize_t)(24 + all);
}

bool bench_send(int fd, const char *path)
{
	return request(fd, TYPE_READ, FLAG_PERSIST, path, NULL, 64);
}

bool bench_send_once(int fd, const char *path)
{
	return request(fd, TYPE_READ, 0, path, NULL, 64);
}

int bench_receive(int fd, char *data, size_t size)
{
	char answer[24];
	uint32_t len, word[6];
	size_t have = 0;
	ssize_t n;

	do {
		if (recv(fd, answer, 24, MSG_WAITALL) != 24)
			return -1;
		memcpy(word, answer, 24);
	} while ((int32_t)ntohl(word[1]) < 0);
	if ((int32_t)ntohl(word[2]) < 0 || ntohl(word[1]) > size)
		return -1;
	len = ntohl(word[1]);
	while (have < len) {
		n = recv(fd, data + have, len - have, 0);
		if (n <= 0)
			return -1;
		have += (size_t)n;
	}
	return (int)len;
}

static int ask(int fd, uint32_t type, const char *path, char *data, size_t size)
{
	return request(fd, type, FLAG_PERSIST, path, NULL, size) ? bench_receive(fd, data, size)
	                                                         : -1;
}

int bench_read(int fd, const char *path, char *data, size_t size)
{
	return ask(fd, TYPE_READ, path, data, size);
}

bool bench_write(int fd, const char *path, const char *text)
{
	char answer[64];

	return request(fd, TYPE_WRITE, FLAG_PERSIST, path, text, strlen(text)) &&
	       bench_receive(fd, answer, sizeof(answer)) >= 0;
}

static bool list_paths(struct bench_peer *peer)
{
	static char list[65536];
	int fd = bench_socket(peer->port), n;
	unsigned count = 0;
	char *next = list, *entry;

	if (fd < 0)
		return false;
	n = ask(fd, TYPE_DIRALL, "/", list, sizeof(list) - 1);
	close(fd);
	if (n <= 0)
		return false;
	list[n] = '\0';
	while ((entry = strsep(&next, ",")) != NULL && count < peer->devices)
		if (strncmp(entry, "/28.", 4) == 0)
			snprintf(peer->paths[count++], 32, "%.16s/temperature", entry);
	return count == peer->devices;
}

bool bench_peer_start(struct bench_peer *peer, unsigned devices, int cpu)
{
	char config[80], address[32];
	FILE *f;

	*peer = (struct bench_peer){.devices = devices};
	peer->paths = calloc(devices, sizeof(*peer->paths));
	snprintf(peer->folder, sizeof(peer->folder), "/tmp/owsd-bench-XXXXXX");
	if (!peer->paths || !mkdtemp(peer->folder))
		return false;
	snprintf(config, sizeof(config), "%s/owfs.conf", peer->folder);
	peer->port = bench_port();
	snprintf(address, sizeof(address), "127.0.0.1:%d", peer->port);
	f = fopen(config, "w");
	if (!f)
		return false;
	fputs("fake = ", f);
	for (unsigned i = 0; i < devices; i++)
		fprintf(f, "%s28", i ? "," : "");
	fputs("\n", f);
	fclose(f);
	peer->pid = fork();
	if (peer->pid == 0) {
		prctl(PR_SET_PDEATHSIG, SIGKILL);
		if (cpu >= 0)
			bench_pin(cpu);
		/* by itself it keeps 20 connections at most */
		execlp("owserver", "owserver", "-c", config, "-p", address, "--foreground",
		       "--error_level", "0", "--clients_persistent_low=100",
		       "--clients_persistent_high=200", (char *)NULL);
		_exit(127);
	}
	for (int i = 0; i < 200; i++) {
		int fd = bench_socket(peer->port);

		if (fd >= 0) {
			close(fd);
			if (list_paths(peer))
				return true;
		}
		if (waitpid(peer->pid, NULL, WNOHANG) == peer->pid) {
			peer->pid = 0;
			break;
		}
		usleep(20000);
	}
	bench_note("peer left out: the genuine owserver is not installed or did not start");
	bench_peer_end(peer);
	return false;
}

void bench_peer_end(struct bench_peer *peer)
{
	char config[80];

	if (peer->pid > 0) {
		kill(peer->pid, SIGKILL);
		waitpid(peer->pid, NULL, 0);
	}
	snprintf(config, sizeof(config), "%s/owfs.conf", peer->folder);
	unlink(config);
	rmdir(peer->folder);
	free(peer->paths);
	*peer = (struct bench_peer){0};
}
