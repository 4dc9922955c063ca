/* SPDX-License-Identifier: MIT */
/*
 * bus TARGET: a bus in its worker, at the command of a system test. One command a line:
 *   read PATH · fresh PATH · write PATH VALUE · dir PATH · probe PATH
 *                 "ok TEXT" (newlines of a listing as blanks) or "error NUMBER"
 *   simulated PATH  reads: "ok yes" or "ok no"
 *   timeout MS    for the requests that follow; a minute at first
 *   repeat N PATH reads: "ok" when all were good, else "error" and the first error
 *   up · down     waits up to 90 s for this news: "ok TEXT", "error" when it did not come
 *   counters      "ok name=value ..."
 */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "hal/bus/worker.h"

#define MS INT64_C(1000000)

static struct worker *worker;
static uint8_t data[70000];
static int64_t timeout_ns = 60000 * MS;
static struct bus_event news[4096];
static unsigned n_news, news_seen;

static int64_t now(void)
{
	struct timespec t;

	clock_gettime(CLOCK_BOOTTIME, &t);
	return (int64_t)t.tv_sec * 1000 * MS + t.tv_nsec;
}

static void nap(void)
{
	nanosleep(&(struct timespec){.tv_nsec = 200000}, NULL); /* pace */
}

static bool take(struct bus_answer *answer)
{
	const struct worker_message *message;

	while ((message = worker_next(worker))) {
		if (!message->is_event) {
			*answer = message->answer;
			return true;
		}
		if (n_news < sizeof(news) / sizeof(news[0]))
			news[n_news++] = message->event;
	}
	return false;
}

static struct bus_answer ask(enum bus_op op, bool fresh, const char *path, uint32_t len)
{
	static uint32_t id;
	struct bus_req req = {.id = ++id,
	                      .op = (uint8_t)op,
	                      .fresh = fresh,
	                      .path = path,
	                      .data = data,
	                      .len = len,
	                      .deadline_ns = now() + timeout_ns};
	struct bus_answer answer = {0};

	if (worker_submit(worker, &req)) {
		answer.err = -EAGAIN;
		return answer;
	}
	while (!take(&answer))
		nap();
	if (answer.id != id)
		answer.err = -EBADE;
	return answer;
}

static void print_answer(const struct bus_answer *answer, bool with_data)
{
	if (answer->err) {
		printf("error %d\n", -answer->err);
		return;
	}
	for (uint32_t i = 0; with_data && i < answer->len; i++)
		if (data[i] == '\n')
			data[i] = ' ';
	printf("ok %.*s\n", with_data ? (int)answer->len : 0, (char *)data);
}

static void repeat(char *arguments)
{
	char *path = strchr(arguments, ' ');
	unsigned long n = strtoul(arguments, NULL, 10);
	struct bus_answer answer = {.err = path ? 0 : -EINVAL};

	for (unsigned long i = 0; i < n && !answer.err; i++)
		answer = ask(BUS_READ, false, path + 1, sizeof(data));
	print_answer(&answer, false);
}

static void await(enum bus_news what)
{
	int64_t until = now() + 90000 * MS;
	struct bus_answer none;

	while (now() < until) {
		take(&none);
		while (news_seen < n_news) {
			const struct bus_event *event = &news[news_seen++];

			if (event->news == what) {
				printf("ok %s\n", event->text);
				return;
			}
		}
		nap();
	}
	printf("error\n");
}

static void print_counters(void)
{
	size_t n;
	const struct bus_counter *counter = bus_counters(worker_bus(worker), &n);

	printf("ok");
	for (size_t i = 0; i < n; i++)
		printf(" %s=%llu", counter[i].name, (unsigned long long)bus_counted(&counter[i]));
	printf("\n");
}

static void obey(char *line)
{
	char *rest = strchr(line, ' ');
	struct bus_answer answer;
	char *value;

	if (rest)
		*rest++ = '\0';
	if (strcmp(line, "up") == 0) {
		await(BUS_UP);
	} else if (strcmp(line, "down") == 0) {
		await(BUS_DOWN);
	} else if (strcmp(line, "counters") == 0) {
		print_counters();
	} else if (!rest) {
		printf("error %d\n", EINVAL);
	} else if (strcmp(line, "timeout") == 0) {
		timeout_ns = strtoll(rest, NULL, 10) * MS;
		printf("ok\n");
	} else if (strcmp(line, "repeat") == 0) {
		repeat(rest);
	} else if (strcmp(line, "read") == 0 || strcmp(line, "fresh") == 0) {
		answer = ask(BUS_READ, line[0] == 'f', rest, sizeof(data));
		print_answer(&answer, true);
	} else if (strcmp(line, "simulated") == 0) {
		answer = ask(BUS_READ, false, rest, sizeof(data));
		if (answer.err)
			print_answer(&answer, false);
		else
			printf("ok %s\n", answer.detail & BUS_DETAIL_SIMULATED ? "yes" : "no");
	} else if (strcmp(line, "dir") == 0) {
		answer = ask(BUS_DIR, false, rest, sizeof(data));
		print_answer(&answer, true);
	} else if (strcmp(line, "probe") == 0) {
		answer = ask(BUS_PROBE, true, rest, 0);
		print_answer(&answer, false);
	} else if (strcmp(line, "write") == 0 && (value = strchr(rest, ' '))) {
		*value++ = '\0';
		snprintf((char *)data, sizeof(data), "%s", value);
		answer = ask(BUS_WRITE, false, rest, (uint32_t)strlen(value));
		print_answer(&answer, false);
	} else {
		printf("error %d\n", EINVAL);
	}
}

int main(int argc, char **argv)
{
	static char line[70000];
	char why[200] = "";

	if (argc != 2 || worker_create(argv[1], "bus", NULL, NULL, &worker, why, sizeof(why)) ||
	    worker_start(worker)) {
		fprintf(stderr, "bus TARGET: %s\n", why);
		return 2;
	}
	while (fgets(line, sizeof(line), stdin)) {
		line[strcspn(line, "\n")] = '\0';
		obey(line);
		fflush(stdout);
	}
	if (worker_stop(worker, 60000 * MS))
		return 1;
	worker_destroy(worker);
	return 0;
}
