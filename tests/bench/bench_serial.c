/* SPDX-License-Identifier: MIT */
/*
 * Thermometers behind a serial adapter: our driver and the genuine owserver, each on the same
 * simulated adapter at a pseudo-terminal (tests/system/serial.c), whose bytes take the time of the
 * line and of the wire. A pseudo-terminal adds nothing; a USB adapter adds a millisecond and more
 * to each round trip, which is why they are counted: by the adapter, each time that the host goes
 * on after an answer.
 *
 * A scan is a reading of all, each of a conversion that began after it was asked for. owserver is
 * asked as its users do that: /simultaneous/temperature, 0.8 s, then latesttemp of each past its
 * cache. A scratchpad is one reading of a chip without a conversion.
 *
 * The processor: 20 sensors, each read every two seconds, by owsd into its image, and by a client
 * from owserver.
 */
#include <poll.h>
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

#define MS INT64_C(1000000)
#define S INT64_C(1000000000)
#define MOST 50
#define SCANS 3
#define READINGS 5
#define SENSORS 20
#define UP_NS (20 * S)
#define EVERY_NS (2 * S)
#define WARM_NS (6 * S)
#define LONG_NS (20 * S)
#define CONVERT_US 800000

struct kind {
	const char *scheme, *adapter, *owserver; /* options of the adapter, and of owserver */
};
static const struct kind kinds[] = {
	{"serial", "--ds2480b", "--device="},
	{"uart", NULL, "--passive="},
};

static char folder[512], scenario[32], config[32];

/* --- The simulated adapter */
static struct {
	pid_t pid;
	FILE *to, *from;
	char name[64];
} adapter;

static bool plug(const struct kind *kind, unsigned thermometers)
{
	char program[600];
	const char *const arguments[] = {"serial", "--paced",
	                                 kind->adapter ? kind->adapter : scenario,
	                                 kind->adapter ? scenario : NULL, NULL};
	int to[2], from[2];
	FILE *f = fopen(scenario, "w");

	if (!f || pipe(to) || pipe(from))
		return false;
	fputs("chip DS2482-100 0x18\n", f);
	/* ids differ in all bits, as those of a delivery do */
	for (unsigned i = 0; i < thermometers; i++)
		fprintf(f, "DS18B20 28.%08X%04X temperature %u\n", (i + 1) * 2654435761u, i, i);
	fclose(f);
	snprintf(program, sizeof(program), "%s/../system/serial", folder);
	adapter.pid = bench_start(program, arguments, to[0], from[1]);
	close(to[0]);
	close(from[1]);
	adapter.to = fdopen(to[1], "w");
	adapter.from = fdopen(from[0], "r");
	if (!adapter.to || !adapter.from ||
	    !fgets(adapter.name, sizeof(adapter.name), adapter.from))
		return false;
	adapter.name[strcspn(adapter.name, "\n")] = '\0';
	return true;
}

static void unplug(void)
{
	bench_stop(adapter.pid, SIGKILL);
	fclose(adapter.to);
	fclose(adapter.from);
}

/* A figure of its stats. */
static double counted(const char *name)
{
	char line[256], *at;

	fputs("stats\n", adapter.to);
	fflush(adapter.to);
	if (!fgets(line, sizeof(line), adapter.from) || !(at = strstr(line, name)))
		exit(1);
	return atof(at + strlen(name));
}

static double turns(void)
{
	return counted(" turns ");
}

static void path_of(char path[64], unsigned i, const char *property)
{
	snprintf(path, 64, "/28.%08X%04X/%s", (i + 1) * 2654435761u, i, property);
}

/* --- owsd's driver, in this process */
static struct {
	struct bus *bus;
	unsigned answers, failures;
	int err; /* the last failure */
	bool up;
	struct bus_req req[MOST];
	uint8_t data[MOST][64];
	char path[MOST][64];
} ours;

static int64_t now(void *ctx)
{
	(void)ctx;
	return bench_now();
}

static int wait_for(void *ctx, int fd, short events, int64_t until_ns)
{
	struct pollfd p = {.fd = fd, .events = events};
	int64_t left = until_ns - now(ctx);
	struct timespec t = {left > 0 ? left / S : 0, left > 0 ? left % S : 0};

	return ppoll(&p, fd >= 0, &t, NULL) > 0;
}

static void take_answer(void *ctx, const struct bus_answer *answer)
{
	(void)ctx;
	ours.answers++;
	ours.failures += answer->err != 0;
	if (answer->err)
		ours.err = answer->err;
}

static void take_event(void *ctx, const struct bus_event *event)
{
	(void)ctx;
	ours.up |= event->news == BUS_UP;
}

static const struct bus_env env = {
	.now = now, .wait = wait_for, .answer = take_answer, .event = take_event};

static void step(unsigned answers)
{
	int64_t next = bus_step(ours.bus, bench_now());

	if (ours.answers < answers && next > bench_now())
		wait_for(NULL, -1, 0, next);
}

static void read_ours(unsigned n, const char *property)
{
	ours.answers = 0;
	for (unsigned i = 0; i < n; i++) {
		path_of(ours.path[i], i, property);
		ours.req[i] = (struct bus_req){.id = i,
		                               .op = BUS_READ,
		                               .prio = BUS_INPUT,
		                               .fresh = true,
		                               .deadline_ns = bench_now() + 60 * S,
		                               .path = ours.path[i],
		                               .len = sizeof(ours.data[i]),
		                               .data = ours.data[i]};
		if (bus_submit(ours.bus, &ours.req[i]))
			ours.failures++;
	}
	while (ours.answers < n)
		step(n);
}

static bool open_ours(const struct kind *kind)
{
	char target[96], why[200] = "";

	snprintf(target, sizeof(target), "%s:%s", kind->scheme, adapter.name);
	memset(&ours, 0, sizeof(ours));
	if (bus_create(target, &env, &ours.bus, why, sizeof(why))) {
		fprintf(stderr, "serial: %s\n", why);
		return false;
	}
	for (int64_t end = bench_now() + UP_NS; !ours.up && bench_now() < end;)
		step(1);
	return ours.up;
}

/* --- owserver */
static struct {
	pid_t pid;
	int port, fd;
} theirs;

static bool read_theirs(unsigned i, const char *property)
{
	char path[64], uncached[80], text[64];

	path_of(path, i, property);
	snprintf(uncached, sizeof(uncached), "/uncached%.60s", path);
	return bench_read(theirs.fd, uncached, text, sizeof(text)) > 0;
}

static bool scan_theirs(unsigned thermometers)
{
	bool ok = bench_write(theirs.fd, "/simultaneous/temperature", "1");

	usleep(CONVERT_US);
	for (unsigned i = 0; i < thermometers; i++)
		ok &= read_theirs(i, "latesttemp");
	return ok;
}

static bool start_theirs(const struct kind *kind, unsigned thermometers)
{
	char device[96], address[32], preload[600];
	const char *const arguments[] = {"owserver",        device, "-p", address, "--foreground",
	                                 "--error_level=0", NULL};

	snprintf(preload, sizeof(preload), "%s/../system/serial.so", folder);
	snprintf(device, sizeof(device), "%s%s", kind->owserver, adapter.name);
	theirs.port = bench_port();
	snprintf(address, sizeof(address), "127.0.0.1:%d", theirs.port);
	setenv("LD_PRELOAD", preload, 1);
	theirs.pid = bench_start("owserver", arguments, -1, -1);
	unsetenv("LD_PRELOAD");
	for (int i = 0; i < 100; i++) {
		theirs.fd = bench_socket(theirs.port);
		if (theirs.fd >= 0) {
			if (scan_theirs(thermometers))
				return true;
			close(theirs.fd);
		}
		if (waitpid(theirs.pid, NULL, WNOHANG) == theirs.pid) {
			theirs.pid = 0;
			break;
		}
		usleep(200000);
	}
	bench_note("serial.*.owserver left out: owserver is not installed or did not start");
	return false;
}

static void stop_theirs(void)
{
	if (theirs.fd >= 0)
		close(theirs.fd);
	bench_stop(theirs.pid, SIGKILL);
}

/* --- The figures */
static void line(const struct kind *kind, const char *what, const char *who, double value,
                 const char *unit)
{
	char name[128];

	snprintf(name, sizeof(name), "%s.%s%s", kind->scheme, what, who);
	bench_line(name, value, unit);
}

static void scans(const struct kind *kind, unsigned thermometers, bool genuine)
{
	double seconds[SCANS], trips[SCANS];
	char what[96];

	for (int i = 0; i < SCANS; i++) {
		double before = turns();
		int64_t begun = bench_now();
		bool ok = true;

		if (genuine)
			ok = scan_theirs(thermometers);
		else
			read_ours(thermometers, "temperature12");
		seconds[i] = (double)(bench_now() - begun) / 1e9;
		trips[i] = turns() - before;
		if (!ok) {
			snprintf(what, sizeof(what),
			         "%.20s.scan.%u.owserver left out: owserver failed to read",
			         kind->scheme, thermometers);
			bench_note(what);
			return;
		}
		if (ours.failures) {
			fprintf(stderr, "serial: a reading by owsd has failed: %s\n",
			        strerror(-ours.err));
			exit(1);
		}
	}
	snprintf(what, sizeof(what), "scan.%u", thermometers);
	line(kind, what, genuine ? ".owserver" : "", bench_percentile(seconds, SCANS, 50), "s");
	snprintf(what, sizeof(what), "scan.%u.trips", thermometers);
	line(kind, what, genuine ? ".owserver" : "",
	     bench_percentile(trips, SCANS, 50) / thermometers, "per_reading");
}

/* The least of some: a background search may come between. */
static void one_reading(const struct kind *kind, bool genuine)
{
	double trips[READINGS];

	for (int i = 0; i < READINGS; i++) {
		double before = turns();

		if (genuine)
			(void)read_theirs(0, "scratchpad");
		else
			read_ours(1, "scratchpad");
		trips[i] = turns() - before;
	}
	line(kind, "scratchpad.trips", genuine ? ".owserver" : "",
	     bench_percentile(trips, READINGS, 0), "round_trips");
}

static bool measure(const struct kind *kind, unsigned thermometers)
{
	if (!plug(kind, thermometers) || !open_ours(kind))
		return false;
	read_ours(thermometers, "temperature12"); /* what is asked for once */
	scans(kind, thermometers, false);
	if (thermometers == 1)
		one_reading(kind, false);
	bus_destroy(ours.bus);
	unplug();
	if (!plug(kind, thermometers))
		return false;
	if (start_theirs(kind, thermometers)) {
		scans(kind, thermometers, true);
		if (thermometers == 1)
			one_reading(kind, true);
	}
	stop_theirs();
	unplug();
	return true;
}

static double cpu_s(pid_t pid)
{
	struct timespec t = {0};
	clockid_t clock;

	if (!clock_getcpuclockid(pid, &clock))
		clock_gettime(clock, &t);
	return (double)t.tv_sec + (double)t.tv_nsec / 1e9;
}

static void write_config(const struct kind *kind)
{
	FILE *f = fopen(config, "w");

	if (!f)
		exit(1);
	fprintf(f,
	        "OwsDrv {\n  Version 1.00\n  TargetName \"%s:%s\"\n  Period %g\n  ItemCount %d\n",
	        kind->scheme, adapter.name, (double)EVERY_NS / 1e9, SENSORS);
	for (unsigned i = 0; i < SENSORS; i++) {
		char path[64];

		path_of(path, i, "temperature");
		fprintf(f, "  Item {\n    Name \"t%u\"\n    Path \"%s\"\n    Type \"double\"\n", i,
		        path);
		fputs("    IO \"input\"\n    Uncached on\n  }\n", f);
	}
	fputs("}\n", f);
	fclose(f);
}

/* Each EVERY_NS; owsd does it by itself. */
static void keep_reading(int64_t ns, bool genuine)
{
	int64_t next = bench_now(), end = next + ns;

	while (next < end) {
		if (genuine)
			(void)scan_theirs(SENSORS);
		next += EVERY_NS;
		while (bench_now() < next)
			wait_for(NULL, -1, 0, next);
	}
}

static void processor(const struct kind *kind, pid_t pid, bool genuine)
{
	keep_reading(WARM_NS, genuine);
	int64_t begun = bench_now();
	double before = cpu_s(pid), trips = turns(), readings = counted(" conversions ");

	keep_reading(LONG_NS, genuine);
	double seconds = (double)(bench_now() - begun) / 1e9;

	line(kind, "cpu.20", genuine ? ".owserver" : "", (cpu_s(pid) - before) / seconds * 100,
	     "percent");
	line(kind, "cpu.20.trips", genuine ? ".owserver" : "", (turns() - trips) / seconds,
	     "per_second");
	line(kind, "cpu.20.readings", genuine ? ".owserver" : "",
	     (counted(" conversions ") - readings) / seconds, "per_second");
}

static bool measure_processor(const struct kind *kind)
{
	char program[600], instance[32];
	const char *const arguments[] = {"owsd", "-c", config, "-n", instance, NULL};
	pid_t pid;

	if (!plug(kind, SENSORS))
		return false;
	write_config(kind);
	snprintf(program, sizeof(program), "%s/../owsd", folder);
	snprintf(instance, sizeof(instance), "bench-%d", (int)getpid());
	pid = bench_start(program, arguments, -1, -1);
	processor(kind, pid, false);
	if (waitpid(pid, NULL, WNOHANG) == pid) {
		fprintf(stderr, "serial: owsd has ended\n");
		return false;
	}
	bench_stop(pid, SIGTERM);
	unplug();
	if (!plug(kind, SENSORS))
		return false;
	if (start_theirs(kind, SENSORS))
		processor(kind, theirs.pid, true);
	stop_theirs();
	unplug();
	return true;
}

int main(int argc, char **argv)
{
	static const unsigned counts[] = {1, 10, 50};
	const char *slash = strrchr(argv[0], '/');
	bool ok = true;

	(void)argc;
	bench_dir();
	signal(SIGPIPE, SIG_IGN);
	snprintf(folder, sizeof(folder), "%.*s", slash ? (int)(slash - argv[0]) : 1,
	         slash ? argv[0] : ".");
	snprintf(scenario, sizeof(scenario), "/tmp/owsd-bench-XXXXXX");
	snprintf(config, sizeof(config), "/tmp/owsd-bench-XXXXXX");
	int fds[2] = {mkstemp(scenario), mkstemp(config)};

	if (fds[0] < 0 || fds[1] < 0)
		return 1;
	close(fds[0]);
	close(fds[1]);
	for (unsigned k = 0; ok && k < sizeof(kinds) / sizeof(kinds[0]); k++) {
		for (unsigned i = 0; ok && i < sizeof(counts) / sizeof(counts[0]); i++)
			ok = measure(&kinds[k], counts[i]);
		ok = ok && measure_processor(&kinds[k]);
	}
	unlink(scenario);
	unlink(config);
	return !ok;
}
