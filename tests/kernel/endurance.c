/* SPDX-License-Identifier: MIT */
/*
 * endurance MINUTES SEED: the life of owsd and all programs beside it on the rig in real time. Time
 * and again: some faults of the chips and the wire, over each other, and reloads; then quiet, until
 * all is well; then something that happens to owsd, to one of the others or the machine itself. At
 * each look a value that is good is true, and nothing grows.
 */
#include <dirent.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "tests/kernel/endurance.h"

#define LOOK_US 50000
#define FAULTS (45 * SECOND)
#define LONGEST 40          /* s, of a fault */
#define WELL (180 * SECOND) /* the back-off is 60 s at most, and the machine may be slow */
#define AGAIN (40 * SECOND) /* another value, for who shows changes and has missed one */
#define DEAD (3 * SECOND)   /* a heartbeat that stopped is noticed after 2 s */
#define TOLD (30 * SECOND)  /* and the clients of the faces see it, on a slow machine */
#define GROWTH 512          /* KiB that the memory of one life may differ */
#define SAMPLES 3           /* from which a life's memory is known */
#define SHOWN 3             /* of what is wrong in one episode */

/* clang-format off */
static const char *const faults[] = {
	"unplug warm for",      "unplug far for",           "unplug board for",
	"unplug air for",       "brownout warm",            "brownout cold",
	"brownout board",       "brownout air",             "corrupt warm each 3 for",
	"corrupt board chance 0.3 seed 5 for",              "corrupt cold each 1 for",
	"short 0x18 for",       "short 0x1b.7 for",         "stick 0x18",
	"stick 0x1b",           "jam 0x18 for",             "jam 0x1b for",
	"reset 0x18",           "reset 0x1b",               "sleep 0x1b for",
	"refuse 0x18 each 7 for", "refuse 0x1b for",        "refuse-data 0x18 each 11 for",
	"refuse-data 0x1b for", "remove adapter for",
};
/* clang-format on */

static unsigned seed, bad, shown, episodes, restarts;
static int64_t begun, end;
static struct life owsd_life, own_life;

__attribute__((format(printf, 2, 0))) static void line(const char *what, const char *form,
                                                       va_list args)
{
	char text[300];

	vsnprintf(text, sizeof(text), form, args);
	printf("%s%s\n", what, text);
	fflush(stdout);
}

void passed(const char *form, ...)
{
	va_list args;

	va_start(args, form);
	line("ok - ", form, args);
	va_end(args);
}

void remark(const char *form, ...)
{
	va_list args;

	va_start(args, form);
	line("# ", form, args);
	va_end(args);
}

bool violated(const char *form, ...)
{
	char what[64];
	va_list args;

	bad++;
	if (shown++ >= SHOWN)
		return false;
	snprintf(what, sizeof(what),
	         "not ok - endurance: at %.1f s: ", (double)(ows_now() - begun) / 1e9);
	va_start(args, form);
	line(what, form, args);
	va_end(args);
	return true;
}

static unsigned below(unsigned n)
{
	seed = seed * 1664525u + 1013904223u;
	return (seed >> 8) % n;
}

static void look(void)
{
	usleep(LOOK_US); /* pace */
	reader_look();
	faces_step();
}

static void look_until(int64_t until)
{
	while (ows_now() < until)
		look();
}

static void fault(void)
{
	const char *text = faults[below(sizeof(faults) / sizeof(faults[0]))];
	char event[128];

	if (strcmp(text + strlen(text) - 4, " for") == 0)
		snprintf(event, sizeof(event), "%s %us", text, 2 + below(LONGEST - 2));
	else
		snprintf(event, sizeof(event), "%s", text);
	remark("%.0f s: %s", (double)(ows_now() - begun) / 1e9, event);
	if (!sim_tell(event))
		violated("%s: refused", event);
}

static void changes(void)
{
	int input = (int)below(SIGNALS);

	if (input == RELAYS)
		reader_set_relays(below(16));
	else
		truth_change(input);
}

static void trouble(void)
{
	int64_t until = ows_now() + FAULTS;

	while (ows_now() < until) {
		if (below(3))
			fault();
		changes();
		if (below(5) == 0)
			daemon_reload();
		look_until(ows_now() + (1 + below(6000)) * (SECOND / 1000));
	}
	look_until(ows_now() + LONGEST * SECOND);
}

static bool becomes_well(const char *after)
{
	int64_t since = ows_now(), until = since + WELL, next = 0;

	while (ows_now() < until) {
		if (ows_now() >= next) {
			for (int i = 0; i < INPUTS; i++)
				truth_change(i);
			reader_set_relays(below(16));
			next = ows_now() + AGAIN;
		}
		look();
		if (reader_all_well() && faces_tell(since))
			return true;
		if (!daemon_lives()) {
			violated("owsd ended by itself after %s", after);
			daemon_start();
		}
	}
	violated("not all is well in time after %s", after);
	reader_explain();
	return false;
}

/* Resident memory in KiB; -1: cannot be told. */
static long memory_of(pid_t pid)
{
	char path[64], line[128];
	long kib = -1;
	FILE *file;

	snprintf(path, sizeof(path), "/proc/%d/status", (int)pid);
	file = fopen(path, "re");
	while (file && fgets(line, sizeof(line), file))
		if (strncmp(line, "VmRSS:", 6) == 0)
			kib = strtol(line + 6, NULL, 10);
	if (file)
		fclose(file);
	return kib;
}

static int descriptors_of(pid_t pid)
{
	char path[64];
	int count = -2; /* . and .. */
	DIR *dir;

	snprintf(path, sizeof(path), "/proc/%d/fd", (int)pid);
	dir = opendir(path);
	if (!dir)
		return -1;
	while (readdir(dir))
		count++;
	closedir(dir);
	return count;
}

/* When all is well: what it holds is what it held in this life. */
static void hold(const char *name, pid_t pid, struct life *life)
{
	long kib = memory_of(pid);
	int fds = descriptors_of(pid);

	for (int i = 0; i < 100 && life->samples && fds != life->descriptors; i++) {
		look();
		fds = descriptors_of(pid);
	}
	if (!life->samples++) {
		life->descriptors = fds;
		life->memory_most = kib;
	}
	if (fds != life->descriptors)
		violated("%s: %d descriptors are open, were %d", name, fds, life->descriptors);
	if (life->samples <= SAMPLES) {
		life->memory_most = kib > life->memory_most ? kib : life->memory_most;
	} else if (kib > life->memory_most + GROWTH) {
		violated("%s: memory grew from %ld to %ld KiB", name, life->memory_most, kib);
	}
	remark("%s: memory %ld KiB, %d descriptors", name, kib, fds);
}

static void holds(void)
{
	remark("%.0f s: episode %u, %llu good values", (double)(ows_now() - begun) / 1e9, episodes,
	       (unsigned long long)reader_checked());
	while (!faces_rest(true))
		look();
	hold("owsd", daemon_pid(), &owsd_life);
	hold("a program with libows", getpid(), &own_life);
	faces_each(hold);
	faces_rest(false);
	reader_counters();
}

/* --- What happens to owsd, to the others and the machine --- */
static void nothing_is_good(const char *when)
{
	const char *face;
	int64_t since;
	int which;

	look_until(ows_now() + DEAD);
	for (int i = 0; i < 20; i++) {
		which = reader_any_good();
		if (which >= 0) {
			violated("%s: %s is good", when, signal_names[which]);
			return;
		}
		look();
	}
	since = ows_now();
	while ((face = faces_good(since)) && ows_now() < since + TOLD)
		look();
	if (face)
		violated("%s: a client of %s is told a good value", when, face);
}

static void restart(void)
{
	owsd_life.samples = 0;
	restarts++;
	daemon_start();
	truth_relays(0); /* InitValue: the reader sets and does not beat */
}

static void kill_it(void)
{
	daemon_signal(SIGKILL);
	daemon_end();
	nothing_is_good("owsd was killed");
	restart();
}

static void end_it(void)
{
	int status;

	daemon_signal(SIGTERM);
	status = daemon_end();
	if (status != 0)
		violated("owsd ended with status %#x", (unsigned)status);
	nothing_is_good("owsd has ended");
	restart();
}

static void stop_it(void)
{
	daemon_signal(SIGSTOP);
	nothing_is_good("owsd stands still");
	reader_stood();
	daemon_signal(SIGCONT);
}

static void wall_clock(void)
{
	static const int64_t by[] = {3600, -7200, 86400, -82800};
	static unsigned next;
	struct timespec now;

	clock_gettime(CLOCK_REALTIME, &now);
	now.tv_sec += by[next++ % 4];
	if (clock_settime(CLOCK_REALTIME, &now))
		violated("the wall clock cannot be set");
}

static void signals(void)
{
	for (int i = 0; i < 200; i++) {
		daemon_signal(i % 2 ? SIGWINCH : SIGCONT);
		if (i % 20 == 0)
			look();
	}
}

static void busy_beside(void)
{
	int64_t until = ows_now() + 4 * SECOND;
	pid_t burner = fork();

	if (burner == 0) {
		while (ows_now() < until + SECOND)
			;
		_exit(0);
	}
	look_until(until);
	waitpid(burner, NULL, 0);
}

static const struct {
	const char *name;
	void (*happens)(void);
	bool ends;
} mishaps[] = {
	{"a kill", kill_it, true},
	{"a reload", daemon_reload, false},
	{"a jump of the wall clock", wall_clock, false},
	{"an orderly end", end_it, true},
	{"a stop", stop_it, false},
	{"signals", signals, false},
	{"a busy processor", busy_beside, false},
	{"a kill of a program beside it", faces_kill, true},
	{"a stop of a program beside it", faces_stop, false},
};

/* Its last life is the second half, so that what grows slowly is seen, too. */
static void mishap(void)
{
	static unsigned next;
	unsigned n;

	do
		n = next++ % (sizeof(mishaps) / sizeof(mishaps[0]));
	while (mishaps[n].ends && ows_now() > begun + (end - begun) / 2);
	remark("%.0f s: %s", (double)(ows_now() - begun) / 1e9, mishaps[n].name);
	mishaps[n].happens();
	becomes_well(mishaps[n].name);
}

int main(int argc, char **argv)
{
	unsigned minutes = argc > 1 ? (unsigned)strtoul(argv[1], NULL, 10) : 0;

	if (argc != 3 || !minutes) {
		fputs("usage: endurance MINUTES SEED\n", stderr);
		return 2;
	}
	seed = (unsigned)strtoul(argv[2], NULL, 10);
	remark("%u minutes, seed %u", minutes, seed);
	begun = ows_now();
	end = begun + minutes * 60 * SECOND;
	for (int i = 0; i < INPUTS; i++)
		truth_change(i);
	truth_relays(0);
	daemon_start();
	faces_start();
	if (!reader_open()) {
		violated("owsd shows no table");
		return 1;
	}
	if (becomes_well("the start"))
		passed("endurance: all is well at first");
	mishap();
	while (ows_now() < end) {
		episodes++;
		shown = 0;
		trouble();
		if (!becomes_well("faults"))
			continue;
		holds();
		mishap();
	}
	if (bad)
		remark("%u times something was wrong; the first %d of each episode are shown", bad,
		       SHOWN);
	else if (daemon_lives())
		passed("endurance: %u episodes, %u restarts: %llu good values in %llu looks were true",
		       episodes, restarts, (unsigned long long)reader_checked(),
		       (unsigned long long)reader_looks());
	faces_end();
	daemon_signal(SIGTERM);
	if (daemon_end() == 0)
		passed("endurance: owsd ends when it is told to");
	else
		violated("owsd does not end");
	return bad != 0;
}
