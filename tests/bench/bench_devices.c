/* SPDX-License-Identifier: MIT */
/*
 * One of each simulated family on one wire, and each board of other makers.
 *
 * By the native driver on the simulator's clock, where no figure depends on the machine: from the
 * start until all are found, and a read of each property past all caches, one after the other. By
 * owsd behind a client, on the machine's clock: the listing of all their directories, which needs
 * no wire; beside it the genuine owserver, with its own simulated devices of the same families,
 * which have no wire at all. The two on the same wire are in the kernel rig (devices.sh).
 */
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "hal/bus/backends.h"
#include "hal/bus/bus.h"
#include "tests/bench/aid.h"
#include "tests/bench/walk.h"

#define S INT64_C(1000000000)
#define ROUNDS 7
#define KHZ 400

static char scenario[64];
static unsigned devices;
static struct walk ours, theirs;
static char names[16384], their_names[16384];

/* --- on the simulator's clock */
static struct {
	struct bus *bus;
	int64_t now;
	struct bus_answer last;
	bool answered;
} place;

static int64_t place_now(void *ctx)
{
	(void)ctx;
	return place.now;
}

static int place_wait(void *ctx, int fd, short events, int64_t until_ns)
{
	(void)ctx;
	(void)fd;
	(void)events;
	if (until_ns > place.now)
		place.now = until_ns;
	return 0;
}

static void place_answer(void *ctx, const struct bus_answer *answer)
{
	(void)ctx;
	place.last = *answer;
	place.answered = true;
}

static void place_event(void *ctx, const struct bus_event *event)
{
	(void)ctx;
	(void)event;
}

static uint8_t data[1 << 16];

static int ask(enum bus_op op, const char *path)
{
	struct bus_req req = {.op = (uint8_t)op,
	                      .prio = BUS_GUEST,
	                      .fresh = true,
	                      .deadline_ns = place.now + 60 * S,
	                      .path = path,
	                      .len = sizeof(data),
	                      .data = data};

	place.answered = false;
	if (bus_submit(place.bus, &req))
		return -1;
	while (!place.answered) {
		int64_t next = bus_step(place.bus, place.now);

		if (!place.answered && next > place.now)
			place.now = next;
	}
	return place.last.err ? place.last.err : (int)place.last.len;
}

/* The search for all; how many devices. */
static unsigned found(void)
{
	int len = ask(BUS_DIR, "/");
	unsigned count = 0;

	for (int i = 0; i + 4 < len; i++)
		count += data[i] == '/' && data[i + 3] == '.';
	return count;
}

static double transfers(void)
{
	size_t n;
	const struct bus_counter *counters = bus_counters(place.bus, &n);

	for (size_t i = 0; i < n; i++)
		if (strcmp(counters[i].name, "i2c_transfers") == 0)
			return (double)counters[i].value;
	return 0;
}

static double cpu_s(void)
{
	struct timespec t;

	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
	return (double)t.tv_sec + (double)t.tv_nsec / 1e9;
}

static bool on_the_simulators_clock(void)
{
	static const struct bus_env env = {
		.now = place_now, .wait = place_wait, .answer = place_answer, .event = place_event};
	char target[80], why[200] = "";
	unsigned good = 0;
	int64_t begun;
	double before, cpu;

	place.now = 1000 * S;
	snprintf(target, sizeof(target), "sim:%s", scenario);
	if (bus_create(target, &env, &place.bus, why, sizeof(why))) {
		fprintf(stderr, "devices: %s\n", why);
		return false;
	}
	begun = place.now;
	cpu = cpu_s();
	if (found() != devices) {
		fputs("devices: the driver does not find all\n", stderr);
		return false;
	}
	bench_line("devices.scan", (double)(place.now - begun) / 1e9, "s");
	begun = place.now;
	before = transfers();
	for (unsigned i = 0; i < ours.properties; i++) {
		ours.property[i].ret = ask(BUS_READ, ours.property[i].path);
		good += ours.property[i].ret >= 0;
	}
	bench_line("devices.read", (double)(place.now - begun) / 1e9, "s");
	bench_line("devices.read.good", good, "properties");
	bench_line("devices.read.refused", ours.properties - good, "properties");
	bench_line("devices.read.transfers", transfers() - before, "transactions");
	/* the driver's, and that of the simulated chips, which is most of it */
	bench_line("devices.cpu", cpu_s() - cpu, "s");
	bus_destroy(place.bus);
	return good > 0;
}

/* --- behind a client */
static bool all_there(struct walk *walk, char *their, size_t size)
{
	for (int i = 0; i < 300; i++) {
		if (walk_scan(walk, false, their, size) == (int)devices)
			return true;
		usleep(100000);
	}
	return false;
}

/* The best of some, ms; which board a device is they have learnt before. */
static double listing(struct walk *walk, const char *their)
{
	char copy[sizeof(names)], path[WALK_PATH], *rest, *name;
	double best = 0;

	snprintf(copy, sizeof(copy), "%s", their);
	for (name = strtok_r(copy, ",", &rest); name; name = strtok_r(NULL, ",", &rest)) {
		snprintf(path, sizeof(path), "/%s/type", name);
		walk_read_one(walk, path);
	}
	for (int i = 0; i < ROUNDS; i++) {
		walk_list(walk, their);
		if (walk->unlisted) {
			fprintf(stderr, "devices: not listed: %s\n", walk->why);
			return -1;
		}
		if (i == 0 || (double)walk->list_ns / 1e6 < best)
			best = (double)walk->list_ns / 1e6;
	}
	return best;
}

static void figures(const struct walk *walk, double ms, const char *who)
{
	char name[64];

	snprintf(name, sizeof(name), "devices.list%s", who);
	bench_line(name, ms, "ms");
	snprintf(name, sizeof(name), "devices.list.directories%s", who);
	bench_line(name, walk->directories, "directories");
	snprintf(name, sizeof(name), "devices.list.properties%s", who);
	bench_line(name, walk->properties, "properties");
	snprintf(name, sizeof(name), "devices.list.each%s", who);
	bench_line(name, ms * 1000 / walk->directories, "us");
}

static bool owsd(const char *program)
{
	char target[80], port[16], instance[32];
	const char *const arguments[] = {"owsd", "-t", target, "-l", port, "-n", instance, NULL};
	uint16_t at = (uint16_t)bench_port();
	double ms = -1;
	pid_t pid;

	snprintf(target, sizeof(target), "sim:%s", scenario);
	snprintf(port, sizeof(port), "%u", at);
	snprintf(instance, sizeof(instance), "bench-%d", (int)getpid());
	pid = bench_start(program, arguments, -1, -1);
	walk_init(&ours, at);
	if (all_there(&ours, names, sizeof(names)))
		ms = listing(&ours, names);
	else
		fputs("devices: owsd does not find all devices\n", stderr);
	if (ms >= 0)
		figures(&ours, ms, "");
	walk_end(&ours);
	bench_stop(pid, SIGTERM);
	return ms >= 0;
}

/* It gives each device of --tester an id by its place in the list. */
static void owserver(void)
{
	static char tester[1024];
	char address[32];
	const char *const arguments[] = {"owserver",        tester, "-p", address, "--foreground",
	                                 "--error_level=0", NULL};
	uint16_t at = (uint16_t)bench_port();
	double ms = -1;
	size_t len = 0;
	pid_t pid;

	for (const char *name = names; *name;
	     name += strcspn(name, ",") + (strchr(name, ',') != NULL))
		len += (size_t)snprintf(tester + len, sizeof(tester) - len, "%s%.2s",
		                        len ? "," : "--tester=", name);
	snprintf(address, sizeof(address), "127.0.0.1:%u", at);
	pid = bench_start("owserver", arguments, -1, -1);
	walk_init(&theirs, at);
	usleep(500000);
	if (walk_scan(&theirs, false, their_names, sizeof(their_names)) > 0)
		ms = listing(&theirs, their_names);
	if (ms >= 0)
		figures(&theirs, ms, ".owserver");
	else
		bench_note(
			"devices.list.owserver left out: owserver is not installed or did not start");
	walk_end(&theirs);
	bench_stop(pid, SIGKILL);
}

int main(int argc, char **argv)
{
	char program[512];
	const char *slash = strrchr(argv[0], '/');
	bool ok;
	FILE *f;
	int fd;

	(void)argc;
	bench_dir();
	snprintf(program, sizeof(program), "%.*s/../owsd-sim", slash ? (int)(slash - argv[0]) : 1,
	         slash ? argv[0] : ".");
	snprintf(scenario, sizeof(scenario), "/tmp/owsd-bench-XXXXXX");
	fd = mkstemp(scenario);
	f = fd < 0 ? NULL : fdopen(fd, "w");
	if (!f) {
		perror(scenario);
		return 1;
	}
	devices = walk_scenario(f, KHZ);
	fclose(f);
	bench_line("devices", devices, "devices");
	ok = owsd(program);
	if (ok) {
		owserver();
		ok = on_the_simulators_clock();
	}
	unlink(scenario);
	return !ok;
}
