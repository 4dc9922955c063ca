/* SPDX-License-Identifier: MIT */
/*
 * What one of our own buses says, in owdump's words, so that the two can be compared: one line for
 * each property, its path, a tab, and the text, escaped, or "ret=-N". /uncached before a path asks
 * past every cache.
 *
 *   busdump TARGET dir PATH...   the entries of each directory
 *   busdump TARGET read          the paths on standard input
 *   busdump TARGET write         "PATH VALUE" lines on standard input; \xNN is a byte of VALUE
 *   busdump TARGET rounds PATH...   for each line on standard input all paths at once (100 at
 *                                   a time), as the engine asks for what is due; then "round".
 *                                   A line that is a number asks for the first so many;
 *                                   "steady SECONDS" asks for each of the first 100 again as soon
 *                                   as it was answered, and ends: PATH, a tab, and the mean
 *                                   seconds between two answers
 */
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "hal/bus/backends.h"
#include "hal/bus/bus.h"
#include "tests/kernel/lines.h"

enum { ROOM = 65536 };
#define SECOND INT64_C(1000000000)
#define PATIENCE (300 * SECOND)

static struct bus *bus;
static struct bus_answer last;
static bool answered, up;

/* Of a round. */
enum { ROUND_MAX = 100, VALUE_ROOM = 600 };
static struct bus_req round_req[ROUND_MAX];
static uint8_t round_data[ROUND_MAX][VALUE_ROOM];
static int round_ret[ROUND_MAX];
static int round_left;

/* Steady. */
static bool is_steady;
static int64_t round_asked[ROUND_MAX], round_first[ROUND_MAX], round_last[ROUND_MAX];
static unsigned round_count[ROUND_MAX], round_old;

static int64_t now(void *ctx)
{
	struct timespec time;

	(void)ctx;
	clock_gettime(CLOCK_BOOTTIME, &time);
	return (int64_t)time.tv_sec * SECOND + time.tv_nsec;
}

static int wait_until(void *ctx, int fd, short events, int64_t until_ns)
{
	struct pollfd poll_fd = {.fd = fd, .events = events};
	int64_t left = until_ns - now(ctx);
	struct timespec timeout;

	if (left < 0)
		left = 0;
	timeout = (struct timespec){.tv_sec = left / SECOND, .tv_nsec = left % SECOND};
	return ppoll(&poll_fd, fd >= 0, &timeout, NULL) > 0;
}

static void take_steady(const struct bus_answer *answer)
{
	uint32_t i = answer->id;

	round_ret[i] = answer->err ? answer->err : (int)answer->len;
	round_old += answer->err || answer->measured_ns < round_asked[i];
	round_last[i] = now(NULL);
	if (!round_first[i])
		round_first[i] = round_last[i];
	else
		round_count[i]++;
	round_asked[i] = 0;
}

static void take_answer(void *ctx, const struct bus_answer *answer)
{
	(void)ctx;
	if (is_steady) {
		take_steady(answer);
		return;
	}
	if (round_left) {
		round_ret[answer->id] = answer->err ? answer->err : (int)answer->len;
		answered = --round_left == 0;
		return;
	}
	last = *answer;
	answered = true;
}

static void take_event(void *ctx, const struct bus_event *event)
{
	(void)ctx;
	if (event->news == BUS_UP || event->news == BUS_DOWN)
		up = event->news == BUS_UP;
	if (event->news == BUS_DOWN || event->news == BUS_NOTE)
		fprintf(stderr, "busdump: %s\n", event->text);
}

static const struct bus_env env = {
	.now = now, .wait = wait_until, .answer = take_answer, .event = take_event};

static void run_until(const bool *flag, int64_t until_ns)
{
	while (!*flag && now(NULL) < until_ns) {
		int64_t again = bus_step(bus, now(NULL));

		if (!*flag)
			wait_until(NULL, -1, 0, again < until_ns ? again : until_ns);
	}
}

static struct bus_req make_request(enum bus_op op, const char *path, uint8_t *data, uint32_t len)
{
	static const char uncached[] = "/uncached";
	bool fresh = strncmp(path, uncached, sizeof(uncached) - 1) == 0;

	return (struct bus_req){
		.op = (uint8_t)op,
		.prio = BUS_GUEST,
		.fresh = fresh,
		.deadline_ns = now(NULL) + PATIENCE,
		.path = fresh ? path + sizeof(uncached) - 1 : path,
		.len = len,
		.data = data,
	};
}

static int ask(enum bus_op op, const char *path, uint8_t *data, uint32_t len)
{
	struct bus_req request = make_request(op, path, data, len);
	int err;

	answered = false;
	err = bus_submit(bus, &request);
	if (err)
		return err;
	run_until(&answered, request.deadline_ns + PATIENCE);
	if (!answered) {
		fprintf(stderr, "busdump: %s: no answer\n", path);
		exit(1);
	}
	return last.err ? last.err : (int)last.len;
}

static void read_property(const char *path)
{
	static uint8_t data[ROOM];
	int ret = ask(BUS_READ, path, data, sizeof(data));

	lines_answer(path, ret, data, ret < 0 ? 0 : (size_t)ret);
}

static void write_property(const char *path, const uint8_t *value, size_t len)
{
	static uint8_t data[ROOM];

	memcpy(data, value, len);
	lines_written(path, ask(BUS_WRITE, path, data, (uint32_t)len));
}

static void dir(const char *path)
{
	static uint8_t data[ROOM];
	int ret = ask(BUS_DIR, path, data, sizeof(data));

	if (ret < 0)
		printf("%s\tret=%d\n", path, ret);
	else
		fwrite(data, 1, (size_t)ret, stdout);
}

static void ask_for(char **paths, int i)
{
	round_req[i] = make_request(BUS_READ, paths[i], round_data[i], VALUE_ROOM);
	round_req[i].id = (uint32_t)i;
	round_req[i].prio = BUS_INPUT;
	if (bus_submit(bus, &round_req[i])) {
		fprintf(stderr, "busdump: %s: not taken\n", paths[i]);
		exit(1);
	}
}

static void one_round(char **paths, int n)
{
	answered = false;
	round_left = n;
	for (int i = 0; i < n; i++)
		ask_for(paths, i);
	run_until(&answered, now(NULL) + 2 * PATIENCE);
	if (round_left) {
		fprintf(stderr, "busdump: %d of %d answers are missing\n", round_left, n);
		exit(1);
	}
	for (int i = 0; i < n; i++)
		lines_answer(paths[i], round_ret[i], round_data[i],
		             round_ret[i] < 0 ? 0 : (size_t)round_ret[i]);
}

/* Each answer is of a conversion that began after its request, or this ends with status 1. */
static void steady(char **paths, int n, int seconds)
{
	int64_t end = now(NULL) + seconds * SECOND;

	is_steady = true;
	round_old = 0;
	for (int i = 0; i < n; i++) {
		round_asked[i] = round_first[i] = 0;
		round_count[i] = 0;
	}
	while (now(NULL) < end) {
		for (int i = 0; i < n; i++) {
			if (round_asked[i])
				continue;
			round_asked[i] = now(NULL);
			ask_for(paths, i);
		}
		int64_t again = bus_step(bus, now(NULL));

		if (again > now(NULL))
			wait_until(NULL, -1, 0, again < end ? again : end);
	}
	for (int i = 0; i < n; i++) {
		if (round_old || !round_count[i]) {
			fprintf(stderr, "busdump: %u failed or are too old, %s has %u\n", round_old,
			        paths[i], round_count[i]);
			exit(1);
		}
		printf("%s\t%.3f\n", paths[i],
		       (double)(round_last[i] - round_first[i]) / round_count[i] / SECOND);
	}
	exit(fflush(stdout) ? 1 : 0);
}

static void rounds(char **paths, int n)
{
	char line[16];

	while (n > 0 && fgets(line, sizeof(line), stdin)) {
		int few = atoi(line), count = few > 0 && few < n ? few : n, seconds;

		if (sscanf(line, "steady %d", &seconds) == 1)
			steady(paths, n < ROUND_MAX ? n : ROUND_MAX, seconds);
		for (int i = 0; i < count; i += ROUND_MAX)
			one_round(paths + i, count - i < ROUND_MAX ? count - i : ROUND_MAX);
		puts("round");
		fflush(stdout);
	}
}

int main(int argc, char **argv)
{
	const char *verb = argc > 2 ? argv[2] : "";
	char why[256] = "";

	if (strcmp(verb, "dir") != 0 && strcmp(verb, "read") != 0 && strcmp(verb, "write") != 0 &&
	    strcmp(verb, "rounds") != 0) {
		fputs("usage: busdump TARGET dir|read|write|rounds [PATH...]\n", stderr);
		return 2;
	}
	if (bus_create(argv[1], &env, &bus, why, sizeof(why))) {
		fprintf(stderr, "busdump: %s: %s\n", argv[1], why);
		return 1;
	}
	run_until(&up, now(NULL) + PATIENCE);
	if (!up) {
		fprintf(stderr, "busdump: %s is not up\n", argv[1]);
		return 1;
	}
	if (strcmp(verb, "read") == 0)
		lines_of_paths(read_property);
	if (strcmp(verb, "write") == 0)
		lines_of_values(write_property);
	if (strcmp(verb, "rounds") == 0)
		rounds(argv + 3, argc - 3);
	for (int i = 3; i < argc && strcmp(verb, "dir") == 0; i++)
		dir(argv[i]);
	bus_destroy(bus);
	return 0;
}
