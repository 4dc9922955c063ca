/* SPDX-License-Identifier: MIT */
/*
 * What the page costs. owsd-web beside an instance of the bench's own (many.h): resident size with
 * 100 signals; then 10 000 signals of which 15 % change each second, with no, one and 100 streams:
 * CPU time, memory, bytes, and the age that a value has at a client; the same with a quiet house.
 * In Chromium the age at the frame that shows it, and the time from the address to the frame with
 * the values, of 1 000 signals. Beside it owhttpd in front of a genuine owserver with 100 fake
 * thermometers: the same values can be had there by a page for each device.
 */
#include <arpa/inet.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "tests/bench/aid.h"
#include "tests/bench/many.h"
#include "tests/bench/streams.h"

#define SIGNALS 10000
#define CHANGING 15 /* of 100, each second */
#define MEASURED 8  /* seconds, with each number of streams */
#define SCREEN_S 12 /* in Chromium */
#define LOADS 5
#define ASKED_S 3
#define TIMES 20000
#define PEER_DEVICES 100

static char root[] = "/var/tmp/owsd-bench-XXXXXX";
static const char *self;
static double times[TIMES];

struct page {
	pid_t pid;
	int port;
	char socket[128];
};

/* --- Processes ------------------------------------------------------------------------------- */

static void end(pid_t pid)
{
	kill(pid, SIGTERM);
	for (int i = 0; i < 100 && waitpid(pid, NULL, WNOHANG) == 0; i++)
		usleep(50000);
	kill(pid, SIGKILL);
	waitpid(pid, NULL, WNOHANG);
}

static double kib_of(pid_t pid, const char *file, const char *key)
{
	char path[64], line[256];
	double number = 0;
	FILE *f;

	snprintf(path, sizeof(path), "/proc/%d/%s", (int)pid, file);
	f = fopen(path, "r");
	while (f && fgets(line, sizeof(line), f))
		if (strncmp(line, key, strlen(key)) == 0)
			number = strtod(line + strlen(key), NULL);
	if (f)
		fclose(f);
	return number;
}

static void resident(pid_t pid, const char *name)
{
	char line[64];

	snprintf(line, sizeof(line), "page.%s", name);
	bench_line(line, kib_of(pid, "status", "VmRSS:"), "KiB");
	snprintf(line, sizeof(line), "page.%s.own", name);
	bench_line(line, kib_of(pid, "status", "RssAnon:"), "KiB");
}

static bool connects(const char *path)
{
	struct sockaddr_un address = {.sun_family = AF_UNIX};
	int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
	bool good;

	snprintf(address.sun_path, sizeof(address.sun_path), "%.100s", path);
	good = connect(fd, (struct sockaddr *)&address, sizeof(address)) == 0;
	close(fd);
	return good;
}

static bool start_page(struct page *page)
{
	const char *slash = strrchr(self, '/');
	char program[512], file[96], address[32];

	snprintf(program, sizeof(program), "%.*s/../owsd-web", slash ? (int)(slash - self) : 1,
	         slash ? self : ".");
	snprintf(file, sizeof(file), "%s/bench.rio", root);
	snprintf(page->socket, sizeof(page->socket), "%.60s/%s.web", bench_dir()->path,
	         many_instance());
	page->port = bench_port();
	snprintf(address, sizeof(address), "127.0.0.1:%d", page->port);
	if (access(program, X_OK) || !many_write_config(file)) {
		bench_note("page skipped: owsd-web is not built");
		return false;
	}
	page->pid = fork();
	if (page->pid == 0) {
		prctl(PR_SET_PDEATHSIG, SIGKILL);
		if (!freopen("/dev/null", "w", stderr))
			_exit(127);
		execl(program, program, "-n", many_instance(), "-c", file, "-l", address,
		      (char *)NULL);
		_exit(127);
	}
	for (int i = 0; i < 200; i++) {
		if (connects(page->socket))
			return true;
		usleep(20000);
	}
	bench_note("page skipped: owsd-web does not start");
	end(page->pid);
	return false;
}

/* An instance of so many signals with its page, and what is to be measured of it. */
static void with_page(uint32_t signals, void (*measure)(const struct page *page))
{
	struct page page;

	if (!many_open(signals))
		return;
	if (start_page(&page)) {
		sleep(2);
		measure(&page);
		end(page.pid);
	}
	many_close();
}

/* --- HTTP ------------------------------------------------------------------------------------ */

/* Bytes of the answer; 0: none. */
static size_t ask(int port, const char *path)
{
	char request[256], data[16384];
	struct timeval patience = {.tv_sec = 10};
	int fd = bench_socket(port), n;
	size_t len = 0;
	ssize_t got;

	if (fd < 0)
		return 0;
	setsockopt(fd, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
	n = snprintf(request, sizeof(request), "GET %s HTTP/1.0\r\nHost: localhost\r\n\r\n", path);
	if (send(fd, request, (size_t)n, MSG_NOSIGNAL) == n)
		while ((got = recv(fd, data, sizeof(data), 0)) > 0)
			len += (size_t)got;
	close(fd);
	return len;
}

/* One after the other, for some seconds. owhttpd ends some connections without a word. */
static void ask_on(int port, const char *path, const char *name)
{
	int64_t begin = bench_now(), now = begin;
	size_t n = 0, len = 0, missing = 0;
	char line[64];

	while (now - begin < ASKED_S * INT64_C(1000000000) && n < TIMES) {
		int64_t then = now;
		size_t got = ask(port, path);

		now = bench_now();
		if (!got) {
			missing++;
			continue;
		}
		len = got;
		times[n++] = (double)(now - then) / 1e6;
	}
	snprintf(line, sizeof(line), "%s: %zu of %zu requests had no answer", name, missing,
	         n + missing);
	if (missing)
		bench_note(line);
	if (!n)
		return;
	snprintf(line, sizeof(line), "page.%s.rate", name);
	bench_line(line, (double)n / ((double)(now - begin) / 1e9), "1/s");
	snprintf(line, sizeof(line), "page.%s.bytes", name);
	bench_line(line, (double)len, "bytes");
	snprintf(line, sizeof(line), "page.%s.p50", name);
	bench_line(line, bench_percentile(times, n, 50), "ms");
}

/* --- Streams --------------------------------------------------------------------------------- */

static void ages(size_t n, const char *name)
{
	static const int points[] = {50, 95, 99};
	char line[64];

	if (!n)
		bench_note("no value of the probe has come");
	for (size_t i = 0; n && i < sizeof(points) / sizeof(points[0]); i++) {
		snprintf(line, sizeof(line), "page.%s.p%d", name, points[i]);
		bench_line(line, bench_percentile(times, n, points[i]), "ms");
	}
}

static void measure_streams(const struct page *page, unsigned count, const char *name)
{
	unsigned had = count ? streams_open(page->socket, count) : 0;
	int64_t begin, cpu;
	char line[64];

	if (had < count)
		bench_note("not all streams were opened");
	sleep(1);
	streams_begin();
	begin = bench_now();
	cpu = bench_cpu_ns(page->pid);
	sleep(MEASURED);
	cpu = bench_cpu_ns(page->pid) - cpu;
	snprintf(line, sizeof(line), "page.%s.cpu", name);
	bench_line(line, (double)cpu / (double)(bench_now() - begin) * 100, "%");
	snprintf(line, sizeof(line), "%s.rss", name);
	resident(page->pid, line);
	if (!count)
		return;
	snprintf(line, sizeof(line), "page.%s.bytes", name);
	bench_line(line,
	           (double)streams_bytes() / ((double)(bench_now() - begin) / 1e9) / had / 1e3,
	           "kB/s");
	snprintf(line, sizeof(line), "%s.age", name);
	ages(streams_latencies(times, TIMES), line);
	streams_close();
}

/* --- Chromium -------------------------------------------------------------------------------- */

/* The numbers of lines with that word; prints why there are none. */
static size_t numbers_of(const char *text, const char *word)
{
	size_t n = 0, len = strlen(word);

	for (const char *line = text; *line; line += strcspn(line, "\n"), line += *line == '\n')
		if (strncmp(line, word, len) == 0 && line[len] == ' ' && n < TIMES)
			times[n++] = strtod(line + len, NULL);
	return n;
}

static const char *screen(const struct page *page, const char *what, const char *numbers)
{
	static char text[65536];
	char command[512];
	size_t len;
	FILE *in;

	snprintf(command, sizeof(command),
	         "exec timeout 90 python3 tests/bench/page-screen %s http://127.0.0.1:%d/ %s", what,
	         page->port, numbers);
	in = popen(command, "r");
	len = in ? fread(text, 1, sizeof(text) - 1, in) : 0;
	text[len] = '\0';
	if (in && pclose(in) && !strncmp(text, "skipped", 7))
		len = 0;
	if (!len || strncmp(text, "skipped", 7) == 0) {
		snprintf(command, sizeof(command), "screen %.200s",
		         len ? text : "skipped: no Chromium");
		command[strcspn(command, "\n")] = '\0';
		bench_note(command);
		text[0] = '\0';
	}
	return text;
}

static void measure_screen(const struct page *page, const char *name)
{
	char numbers[64];
	size_t n;

	snprintf(numbers, sizeof(numbers), "%lld %d", (long long)many_base_ms(), SCREEN_S);
	n = numbers_of(screen(page, "latency", numbers), "latency");
	if (n)
		ages(n, name);
}

static void measure_paint(const struct page *page)
{
	static const char *const words[] = {"first", "paint", "again"};
	const char *text;
	char numbers[16], line[64];

	many_pace((struct many_pace){.changing = CHANGING});
	snprintf(numbers, sizeof(numbers), "%d", LOADS);
	text = screen(page, "paint", numbers);
	for (size_t i = 0; i < sizeof(words) / sizeof(words[0]); i++) {
		size_t n = numbers_of(text, words[i]);

		snprintf(line, sizeof(line), "page.paint.%s", words[i]);
		if (n)
			bench_line(line, bench_percentile(times, n, 50), "ms");
	}
	ask_on(page->port, "/api/signals", "signals");
}

/* --- owhttpd --------------------------------------------------------------------------------- */

static void measure_owhttpd(void)
{
	struct bench_peer peer;
	char server[32], listen[32], path[32], uncached[64];
	int port;
	pid_t pid;

	if (!bench_peer_start(&peer, PEER_DEVICES, -1))
		return;
	port = bench_port();
	snprintf(server, sizeof(server), "127.0.0.1:%d", peer.port);
	snprintf(listen, sizeof(listen), "127.0.0.1:%d", port);
	pid = fork();
	if (pid == 0) {
		prctl(PR_SET_PDEATHSIG, SIGKILL);
		if (!freopen("/dev/null", "w", stderr))
			_exit(127);
		execlp("owhttpd", "owhttpd", "-s", server, "-p", listen, "--foreground",
		       "--error_level", "0", (char *)NULL);
		_exit(127);
	}
	snprintf(path, sizeof(path), "/%.15s", peer.paths[0] + 1);
	snprintf(uncached, sizeof(uncached), "/uncached%s", path);
	for (int i = 0; i < 100 && !ask(port, path); i++)
		usleep(50000);
	if (waitpid(pid, NULL, WNOHANG) == pid) {
		bench_note("owhttpd skipped: it is not installed (Debian package owhttpd)");
	} else {
		ask_on(port, uncached, "owhttpd.uncached");
		ask_on(port, path, "owhttpd.cached");
		resident(pid, "owhttpd.rss");
		end(pid);
	}
	bench_peer_end(&peer);
}

/* --------------------------------------------------------------------------------------------- */

static void measure_idle(const struct page *page)
{
	resident(page->pid, "idle.rss");
}

static void measure_many(const struct page *page)
{
	many_pace((struct many_pace){.changing = CHANGING, .probe = true});
	measure_streams(page, 0, "streams.0");
	measure_streams(page, 1, "streams.1");
	measure_streams(page, 100, "streams.100");
	streams_open(page->socket, 99);
	measure_screen(page, "screen");
	many_pace((struct many_pace){.probe = true});
	measure_screen(page, "screen.quiet");
	streams_close();
	measure_streams(page, 100, "quiet.100");
}

int main(int argc, char **argv)
{
	char command[64];

	(void)argc;
	self = argv[0];
	if (!mkdtemp(root))
		return 1;
	with_page(100, measure_idle);
	with_page(SIGNALS, measure_many);
	with_page(1000, measure_paint);
	measure_owhttpd();
	snprintf(command, sizeof(command), "rm -rf %s", root);
	return system(command) != 0;
}
