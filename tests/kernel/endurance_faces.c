/* SPDX-License-Identifier: MIT */
/* The programs beside owsd in the endurance run, and genuine clients of each: one table. */
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/kernel/endurance.h"

#define PERIOD (7 * SECOND) /* from one question of a client to its next */
#define MINUTE (60 * SECOND)
#define STOPPED (5 * SECOND)
#define ON_WAY (4 * SECOND) /* a conversion, what is queued before it, and the slow machine */

/* What a client is told is of now, or of any time since it was told something before. */
enum kind { NOW, PAST };

static const struct program {
	const char *name;
	const char *starts; /* NULL: owsd itself */
	const char *asks;   /* prints the number of a good value, or nothing; NULL: nobody does */
	int signal;
	int64_t late; /* so old may it be */
	enum kind kind;
} programs[] = {
	/* The other sides first; a face has to find them again */
	{.name = "mosquitto", .starts = "mosquitto -c /tmp/broker.conf"},
	{.name = "httpd", .starts = "httpd -f -p 127.0.0.1:8086 -h /tmp/taker"},
	{.name = "the served protocol",
         .asks = "owsctl -t 127.0.0.1:4304 read /uncached/28.A0B1C2000028/temperature12",
         .signal = WARM,
         .late = ON_WAY,
         .kind = PAST},
	{.name = "owsd-web",
         .starts = "owsd-web -c /tmp/present.rio",
         .asks = "curl -sf -m 30 http://127.0.0.1:8080/api/signals | sed 's/\"i\":/\\n&/g' | "
                 "sed -n 's/.*\"name\":\"warm\".*\"value\":\\([-0-9.][-0-9.]*\\),.*/\\1/p'",
         .signal = WARM,
         .late = STALE_AFTER + ON_WAY},
	{.name = "owsd-mqtt",
         .starts = "owsd-mqtt -c /tmp/present.rio",
         .asks = "mosquitto_sub -h 127.0.0.1 -W 30 -C 1 -t owsd/rig/cold | "
                 "sed -n 's/.*\"v\":\\([-0-9.][-0-9.]*\\),\"good\":true.*/\\1/p'",
         .signal = COLD,
         .late = STALE_AFTER + 2 * ON_WAY},
	{.name = "owsd-modbus",
         .starts = "owsd-modbus -c /tmp/present.rio",
         .asks = "mbpoll -m tcp -0 -1 -q -o 10 -t 4:float -B -r 46006 127.0.0.1 | "
                 "sed -n 's/^\\[46006\\]:[^-0-9.a-z]*\\([-0-9.]*\\)$/\\1/p'",
         .signal = FAR,
         .late = STALE_AFTER + ON_WAY},
	{.name = "owsd-influx",
         .starts = "owsd-influx -c /tmp/present.rio",
         .asks = "sed -n 's/.* value=\\([-0-9.]*\\),quality=192i .*/\\1/p' /tmp/line",
         .signal = AIR,
         .late = STALE_AFTER + 3 * MINUTE},
	{.name = "owsd-recorder",
         .starts = "owsd-recorder -c /tmp/present.rio",
         .asks = "owsctl trend -s 2m --csv warm | "
                 "sed -n 's/^[^,]*,[^,]*,\\([-0-9.][-0-9.]*\\),.*/\\1/p' | tail -n 1",
         .signal = WARM,
         .late = STALE_AFTER + 3 * MINUTE,
         .kind = PAST},
	{.name = "owsd-notify",
         .starts = "owsd-notify -c /tmp/present.rio",
         .asks = "mv /tmp/told /tmp/told.taken && tail -n 1 /tmp/told.taken | "
                 "sed -n 's/^pins .*high: \\([0-9]*\\).*/\\1/p'",
         .signal = PINS,
         .late = STALE_AFTER + MINUTE,
         .kind = PAST},
	{.name = "owsd-writer", .starts = "owsd-writer -c /tmp/present.rio"},
};

#define PROGRAMS (sizeof(programs) / sizeof(programs[0]))

static struct state {
	pid_t pid, client;
	struct life life;
	int answer_fd;
	int64_t asked_ns, before_ns; /* the question of now or the last one, and that before it */
	int64_t good_ns, none_ns;    /* the last questions with such an answer */
	unsigned answers;
} states[PROGRAMS];

static bool resting;

/* --- Programs --- */
static pid_t run(const char *command, int output)
{
	char line[512];
	pid_t pid = child(output);

	if (pid == 0) {
		setpgid(0, 0); /* a client has several processes */
		snprintf(line, sizeof(line), "%s%s", strchr(command, '|') ? "" : "exec ", command);
		execl("/bin/sh", "sh", "-c", line, NULL);
		_exit(127);
	}
	return pid;
}

static void start(unsigned i)
{
	char path[64];
	int log;

	snprintf(path, sizeof(path), "/tmp/log/%s", programs[i].name);
	log = open(path, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
	states[i].life.samples = 0;
	states[i].pid = run(programs[i].starts, log);
	close(log);
	if (states[i].pid < 0)
		violated("%s cannot be started", programs[i].name);
}

void faces_start(void)
{
	for (unsigned i = 0; i < PROGRAMS; i++)
		if (programs[i].starts)
			start(i);
}

static void see_to(unsigned i)
{
	int status;

	if (states[i].pid <= 0 || waitpid(states[i].pid, &status, WNOHANG) != states[i].pid)
		return;
	violated("%s ended by itself with status %#x", programs[i].name, (unsigned)status);
	start(i);
}

/* The next one that can be started. */
static unsigned next_of(unsigned *last)
{
	do
		*last = (*last + 1) % PROGRAMS;
	while (!programs[*last].starts);
	remark("that is %s", programs[*last].name);
	return *last;
}

void faces_kill(void)
{
	static unsigned last = PROGRAMS - 1;
	unsigned i = next_of(&last);

	kill(states[i].pid, SIGKILL);
	child_end(states[i].pid);
	start(i);
}

void faces_stop(void)
{
	static unsigned last = PROGRAMS - 1;
	unsigned i = next_of(&last);
	int64_t until = ows_now() + STOPPED;

	kill(states[i].pid, SIGSTOP);
	while (ows_now() < until) {
		usleep(50000); /* pace */
		reader_look();
		faces_step();
	}
	kill(states[i].pid, SIGCONT);
}

void faces_each(void (*hold)(const char *name, pid_t pid, struct life *life))
{
	for (unsigned i = 0; i < PROGRAMS; i++)
		if (states[i].pid > 0 && strncmp(programs[i].name, "owsd-", 5) == 0)
			hold(programs[i].name, states[i].pid, &states[i].life);
}

/* --- Clients --- */
static void ask(struct state *state, const char *command)
{
	int ends[2];

	if (resting || ows_now() < state->asked_ns + PERIOD || pipe2(ends, O_CLOEXEC))
		return;
	state->before_ns = state->asked_ns;
	state->asked_ns = ows_now();
	state->client = run(command, ends[1]);
	state->answer_fd = ends[0];
	close(ends[1]);
}

static void judge(const struct program *program, struct state *state, const char *text)
{
	int64_t from = program->kind == PAST && state->before_ns ? state->before_ns
	                                                         : state->asked_ns;
	char *end;
	double value = strtod(text, &end);

	if (end == text || (*end && *end != '\n')) {
		state->none_ns = state->asked_ns;
		return;
	}
	state->good_ns = state->asked_ns;
	state->answers++;
	if (!truth_between(program->signal, value, from - program->late, ows_now()))
		violated("a client of %s was told %s", program->name, text);
}

static void step(const struct program *program, struct state *state)
{
	char text[256];
	ssize_t got;

	if (state->client <= 0) {
		ask(state, program->asks);
		return;
	}
	if (waitpid(state->client, NULL, WNOHANG) != state->client) {
		if (ows_now() > state->asked_ns + MINUTE) {
			violated("a client of %s got no answer and no error within a minute",
			         program->name);
			kill(-state->client, SIGKILL);
		}
		return;
	}
	state->client = -1;
	got = read(state->answer_fd, text, sizeof(text) - 1);
	text[got > 0 ? got : 0] = '\0';
	close(state->answer_fd);
	judge(program, state, text);
}

void faces_step(void)
{
	for (unsigned i = 0; i < PROGRAMS; i++) {
		see_to(i);
		if (programs[i].asks)
			step(&programs[i], &states[i]);
	}
}

bool faces_rest(bool rest)
{
	resting = rest;
	for (unsigned i = 0; i < PROGRAMS; i++)
		if (states[i].client > 0)
			return false;
	return true;
}

bool faces_tell(int64_t since_ns)
{
	for (unsigned i = 0; i < PROGRAMS; i++)
		if (programs[i].asks && programs[i].signal != PINS && states[i].good_ns < since_ns)
			return false;
	return true;
}

const char *faces_good(int64_t since_ns)
{
	for (unsigned i = 0; i < PROGRAMS; i++)
		if (programs[i].asks && programs[i].kind == NOW && states[i].none_ns < since_ns)
			return programs[i].name;
	return NULL;
}

/* --- The end --- */
static void end_client(struct state *state)
{
	if (state->client <= 0)
		return;
	kill(-state->client, SIGKILL);
	child_end(state->client);
	close(state->answer_fd);
}

void faces_end(void)
{
	int status;

	for (unsigned i = PROGRAMS; i-- > 0;) {
		end_client(&states[i]);
		if (programs[i].asks && states[i].answers)
			passed("endurance: a client of %s had %u true answers", programs[i].name,
			       states[i].answers);
		else if (programs[i].asks)
			violated("a client of %s never had an answer", programs[i].name);
		if (states[i].pid <= 0)
			continue;
		kill(states[i].pid, SIGTERM);
		status = child_end(states[i].pid);
		if (status != 0 && strncmp(programs[i].name, "owsd-", 5) == 0)
			violated("%s ended with status %#x", programs[i].name, (unsigned)status);
	}
}
