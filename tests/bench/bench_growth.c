/* SPDX-License-Identifier: MIT */
/*
 * How owsd grows: 10 to 10 000 signals; 1 000 of them with 1 to 64 targets, as many as owsd takes,
 * and with 1 and 100 programs that may command. For each: the time until the image is there, what a
 * reading costs while each signal is read once in three seconds, how long a reload takes, its
 * memory, and what it costs when nothing is due. The targets are an owserver of the bench's own,
 * which answers at once. All on one CPU: what it costs to wake a thread on another one depends on
 * how deep that sleeps, by a factor of ten.
 */
#include <arpa/inet.h>
#include <dirent.h>
#include <netinet/tcp.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "src/public/ows.h"
#include "tests/bench/aid.h"

#define TARGETS 64
#define CONSUMERS 100
#define APART 3         /* seconds from reading to reading */
#define PERIODS_A_S 10  /* Period 0.1 */
#define LONG 36000      /* seconds: never within the bench */
#define SECONDS_N APART /* each signal is read once */
#define WAIT_NS 20000000000
#define READ 2

struct size {
	const char *of;
	unsigned signals, targets, consumers;
};

static const struct size sizes[] = {
	{"signals.10", 10, 1, 0},        {"signals.100", 100, 1, 0},
	{"signals.1000", 1000, 1, 0},    {"signals.10000", 10000, 1, 0},
	{"targets.8", 1000, 8, 0},       {"targets.16", 1000, 16, 0},
	{"targets.64", 1000, 64, 0},     {"consumers.1", 1000, 1, 1},
	{"consumers.100", 1000, 1, 100},
};

/* --- The peer --------------------------------------------------------------------------------- */

/* Answer one request; false: the connection has ended. */
static bool answer(int fd)
{
	static const char value[] = "     21.4375";
	char bytes[24 + 512];
	uint32_t word[6], len;
	bool is_value;

	if (recv(fd, word, sizeof(word), MSG_WAITALL) != sizeof(word))
		return false;
	/* behind the data: a token of each server that it came through */
	len = ntohl(word[1]) + 16 * (ntohl(word[0]) & 0xffff);
	if (len >= 512 || (len && recv(fd, bytes, len, MSG_WAITALL) != (ssize_t)len))
		return false;
	bytes[len] = '\0';
	word[0] = 0;
	is_value = ntohl(word[2]) == READ && strncmp(bytes, "/28.", 4) == 0;
	word[2] = is_value || ntohl(word[2]) == 1 ? 0 : htonl((uint32_t)-1);
	word[1] = 0;
	len = 0;
	if (is_value) {
		len = sizeof(value) - 1;
		word[1] = word[2] = word[4] = htonl(len);
		memcpy(bytes + sizeof(word), value, len);
	}
	memcpy(bytes, word, sizeof(word));
	return send(fd, bytes, sizeof(word) + len, MSG_NOSIGNAL) == (ssize_t)(sizeof(word) + len);
}

static void serve(const int *listeners)
{
	int epoll = epoll_create1(EPOLL_CLOEXEC), on = 1;
	struct epoll_event event = {.events = EPOLLIN}, events[32];

	for (int i = 0; i < TARGETS; i++) {
		event.data.fd = listeners[i];
		epoll_ctl(epoll, EPOLL_CTL_ADD, listeners[i], &event);
	}
	for (;;) {
		int n = epoll_wait(epoll, events, 32, -1);

		for (int i = 0; i < n; i++) {
			int fd = events[i].data.fd, is = 0;
			socklen_t len = sizeof(is);

			getsockopt(fd, SOL_SOCKET, SO_ACCEPTCONN, &is, &len);
			if (!is && !answer(fd))
				close(fd);
			if (!is)
				continue;
			event.data.fd = accept(fd, NULL, NULL);
			setsockopt(event.data.fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof(on));
			epoll_ctl(epoll, EPOLL_CTL_ADD, event.data.fd, &event);
		}
	}
}

static bool start_peer(int ports[TARGETS], pid_t *pid)
{
	int listeners[TARGETS];

	for (int i = 0; i < TARGETS; i++) {
		struct sockaddr_in a = {.sin_family = AF_INET};
		socklen_t len = sizeof(a);

		a.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
		listeners[i] = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
		if (bind(listeners[i], (void *)&a, sizeof(a)) || listen(listeners[i], 4) ||
		    getsockname(listeners[i], (void *)&a, &len))
			return false;
		ports[i] = ntohs(a.sin_port);
	}
	*pid = fork();
	if (*pid == 0) {
		prctl(PR_SET_PDEATHSIG, SIGKILL);
		bench_pin(0);
		serve(listeners);
		_exit(0);
	}
	for (int i = 0; i < TARGETS; i++)
		close(listeners[i]);
	return *pid > 0;
}

/* --- What owsd has taken ---------------------------------------------------------------------- */

struct spent {
	double us, wakes;
};

/* A field of a file of /proc/PID; 0: there is none. */
static double field(const char *file, const char *name)
{
	FILE *f = fopen(file, "r");
	char line[256];
	double value = 0;

	while (f && fgets(line, sizeof(line), f))
		if (strncmp(line, name, strlen(name)) == 0)
			value = atof(line + strlen(name));
	if (f)
		fclose(f);
	return value;
}

static struct spent spent_of(pid_t pid)
{
	struct spent spent = {0};
	struct dirent *entry;
	char folder[64], file[400];
	DIR *tasks;

	snprintf(folder, sizeof(folder), "/proc/%d/task", (int)pid);
	tasks = opendir(folder);
	while (tasks && (entry = readdir(tasks)) != NULL) {
		if (entry->d_name[0] == '.')
			continue;
		snprintf(file, sizeof(file), "%s/%s/status", folder, entry->d_name);
		spent.wakes += field(file, "voluntary_ctxt_switches:");
		snprintf(file, sizeof(file), "%s/%s/schedstat", folder, entry->d_name);
		spent.us += field(file, "") / 1e3;
	}
	if (tasks)
		closedir(tasks);
	return spent;
}

/* Pages that no other process shares but the image's readers. */
static double own_kib(pid_t pid)
{
	char file[64];

	snprintf(file, sizeof(file), "/proc/%d/status", (int)pid);
	return field(file, "RssAnon:") + field(file, "RssShmem:");
}

static struct spent pass(pid_t pid)
{
	struct spent before = spent_of(pid), after;

	sleep(SECONDS_N);
	after = spent_of(pid);
	return (struct spent){after.us - before.us, after.wakes - before.wakes};
}

/* --- The runs --------------------------------------------------------------------------------- */

static bool write_file(const char *file, const struct size *size, const int *ports, int seconds)
{
	FILE *f = fopen(file, "w");

	if (!f)
		return false;
	fprintf(f, "OwsDrv {\n  Period 0.1\n  TargetName \"");
	for (unsigned i = 0; i < size->targets; i++)
		fprintf(f, "%s127.0.0.1:%d", i ? ", " : "", ports[i]);
	fprintf(f, "\"\n");
	for (unsigned i = 0; i < size->signals; i++)
		fprintf(f,
		        "  Item {\n    Name \"t%u\"\n    Path \"/28.%08X0000/temperature\"\n"
		        "    Type double\n    IO input\n    PerFactor %d\n  }\n",
		        i, i, seconds * PERIODS_A_S);
	fputs("}\n", f);
	return fclose(f) == 0;
}

static ino_t inode_of(const char *path)
{
	struct stat st;

	return stat(path, &st) == 0 ? st.st_ino : 0;
}

/* From begun until the image has another inode than before, in ms; less than 0: it has not. */
static double until_image(const char *image, ino_t before, int64_t begun)
{
	int64_t now = bench_now();
	ino_t inode = inode_of(image);

	for (; (!inode || inode == before) && now - begun < WAIT_NS; now = bench_now()) {
		usleep(200);
		inode = inode_of(image);
	}
	return inode && inode != before ? (double)(now - begun) / 1e6 : -1;
}

/* Wait for the last signal's first value. */
static bool until_read(const char *instance, unsigned signals)
{
	int64_t begun = bench_now();
	struct ows_value value = {0};
	struct ows *h;
	char name[16];

	if (ows_open(instance, OWS_READ, &h))
		return false;
	snprintf(name, sizeof(name), "t%u", signals - 1);
	while (bench_now() - begun < WAIT_NS &&
	       (ows_get(h, ows_find(h, name), ows_now(), &value) || !ows_good(value.quality)))
		usleep(10000);
	ows_close(h);
	return ows_good(value.quality);
}

static void line(const struct size *size, const char *what, double value, const char *unit)
{
	char name[64];

	snprintf(name, sizeof(name), "growth.%s.%s", size->of, what);
	bench_line(name, value, unit);
}

static bool measure(const struct size *size, pid_t pid, const char *file, const char *image,
                    const char *instance, const int *ports, int64_t begun)
{
	double start = until_image(image, 0, begun), reload;
	struct ows *consumers[CONSUMERS];
	struct spent busy, quiet;
	ino_t before;

	if (start < 0 || !until_read(instance, size->signals))
		return false;
	for (unsigned i = 0; i < size->consumers; i++)
		if (ows_open(instance, OWS_CONTROL, &consumers[i]))
			return false;
	/* until the readings are apart as they will be */
	sleep(2 * APART);
	busy = pass(pid);
	line(size, "start", start, "ms");
	line(size, "memory", own_kib(pid), "KiB");
	before = inode_of(image);
	if (!write_file(file, size, ports, LONG))
		return false;
	begun = bench_now();
	if (kill(pid, SIGHUP))
		return false;
	reload = until_image(image, before, begun);
	line(size, "reload", reload, "ms");
	sleep(2);
	quiet = pass(pid);
	line(size, "quiet", quiet.us / SECONDS_N / 1e4, "%");
	line(size, "quiet_wakes", quiet.wakes / SECONDS_N, "/s");
	line(size, "reading", (busy.us - quiet.us) / size->signals, "us");
	line(size, "wakes", (busy.wakes - quiet.wakes) / size->signals, "/reading");
	for (unsigned i = 0; i < size->consumers; i++)
		ows_close(consumers[i]);
	return reload >= 0;
}

static bool run(const char *program, const char *folder, const struct size *size, const int *ports)
{
	char file[128], image[512], instance[32];
	int64_t begun;
	bool good;
	pid_t pid;

	snprintf(file, sizeof(file), "%s/bench.rio", folder);
	snprintf(instance, sizeof(instance), "bench-%d", (int)getpid());
	snprintf(image, sizeof(image), "%s/%s.image", bench_dir()->path, instance);
	unlink(image);
	if (!write_file(file, size, ports, APART))
		return false;
	begun = bench_now();
	pid = fork();
	if (pid == 0) {
		prctl(PR_SET_PDEATHSIG, SIGKILL);
		bench_pin(0);
		execl(program, program, "-c", file, "-n", instance, (char *)NULL);
		_exit(127);
	}
	good = measure(size, pid, file, image, instance, ports, begun);
	kill(pid, SIGTERM);
	waitpid(pid, NULL, 0);
	unlink(file);
	return good;
}

int main(int argc, char **argv)
{
	char program[512], folder[] = "/tmp/owsd-bench-XXXXXX";
	const char *slash = strrchr(argv[0], '/');
	int ports[TARGETS];
	bool good = true;
	pid_t peer;

	(void)argc;
	bench_dir();
	snprintf(program, sizeof(program), "%.*s/../owsd", slash ? (int)(slash - argv[0]) : 1,
	         slash ? argv[0] : ".");
	if (!mkdtemp(folder) || !start_peer(ports, &peer))
		return 1;
	for (unsigned i = 0; good && i < sizeof(sizes) / sizeof(sizes[0]); i++) {
		good = run(program, folder, &sizes[i], ports);
		if (!good)
			fprintf(stderr, "growth: %s was not measured\n", sizes[i].of);
	}
	kill(peer, SIGKILL);
	waitpid(peer, NULL, 0);
	rmdir(folder);
	return good ? 0 : 1;
}
