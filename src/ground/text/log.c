/* SPDX-License-Identifier: MIT */
/* The ring of log lines: any thread puts one in, the supervisor writes them out. */
#include <errno.h>
#include <inttypes.h>
#include <poll.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "hal/base/bell.h"
#include "hal/base/time.h"
#include "src/ground/text/log.h"
#include "src/ground/text/printable.h"

#define LINES 256u /* a power of two */
#define LINE_BYTES 255
#define FINISH_MS 200
#define HOUR_NS (3600 * NS_PER_S)

/*
 * generation names the owner of the line: in round r of the ring, r * LINES is the producers',
 * r * LINES + 1 the reader's. All zero is the empty ring, so untouched lines cost no memory.
 */
struct line {
	uint32_t generation;
	uint8_t level;
	uint8_t len;
	int64_t time_ns;
	char text[LINE_BYTES + 1];
};

struct log {
	uint32_t head; /* next to take by a producer */
	int bell;
	uint32_t dropped;
	uint32_t tail;     /* the reader's alone */
	uint32_t reported; /* drops already reported, the reader's alone */
	log_see *see;      /* and these two */
	void *see_ctx;
	enum log_level level;
	struct line lines[LINES];
};

struct log *log_create(enum log_level level)
{
	struct log *log = calloc(1, sizeof(*log));

	if (!log)
		return NULL;
	log->level = level;
	log->bell = bell_open();
	if (log->bell >= 0)
		return log;
	free(log);
	return NULL;
}

void log_destroy(struct log *log)
{
	if (log)
		close(log->bell);
	free(log);
}

enum log_level log_level(const struct log *log)
{
	return log->level;
}

static struct line *claim_line(struct log *log, uint32_t *generation)
{
	uint32_t head = __atomic_load_n(&log->head, __ATOMIC_RELAXED);

	for (;;) {
		struct line *line = &log->lines[head % LINES];
		uint32_t mine = head - head % LINES;
		int32_t ahead = (int32_t)(__atomic_load_n(&line->generation, __ATOMIC_ACQUIRE) -
		                          mine);

		if (ahead < 0)
			return NULL;
		if (ahead > 0) {
			head = __atomic_load_n(&log->head, __ATOMIC_RELAXED);
		} else if (__atomic_compare_exchange_n(&log->head, &head, head + 1, true,
		                                       __ATOMIC_RELAXED, __ATOMIC_RELAXED)) {
			*generation = mine;
			return line;
		}
	}
}

void log_put(struct log *log, enum log_level level, const char *format, ...)
{
	char text[LINE_BYTES + 1];
	struct line *line;
	uint32_t generation;
	va_list args;
	size_t len;
	int made;

	if (!log || level > log->level)
		return;
	va_start(args, format);
	made = vsnprintf(text, sizeof(text), format, args);
	va_end(args);
	if (made < 0)
		return;
	len = made > LINE_BYTES ? printable_cut(text, LINE_BYTES) : (size_t)made;
	len = printable(text, len);

	line = claim_line(log, &generation);
	if (!line) {
		__atomic_fetch_add(&log->dropped, 1, __ATOMIC_RELAXED);
		return;
	}
	line->time_ns = clock_ns(CLOCK_BOOTTIME);
	line->level = (uint8_t)level;
	line->len = (uint8_t)len;
	memcpy(line->text, text, len);
	__atomic_store_n(&line->generation, generation + 1, __ATOMIC_RELEASE);
	bell_ring(log->bell);
}

uint64_t log_rate(struct log_rate *rate, int64_t now_ns)
{
	uint64_t since = ++rate->seen - rate->reported;

	if (rate->seen < rate->next && now_ns - rate->last_ns < HOUR_NS)
		return 0;
	if (rate->next == 0)
		rate->next = 1;
	while (rate->next <= rate->seen)
		rate->next *= 2;
	rate->last_ns = now_ns;
	rate->reported = rate->seen;
	return since;
}

const char *log_others(uint64_t n, char text[LOG_OTHERS])
{
	text[0] = '\0';
	if (n > 1)
		snprintf(text, LOG_OTHERS, " (%" PRIu64 " times since the last such line)", n);
	return text;
}

/*
 * Other processes may share stderr, so owsd must not make it non-blocking. A pipe that is writable
 * takes a whole line, since a line is shorter than PIPE_BUF.
 */
static bool takes_line(int fd)
{
	struct pollfd poll_fd = {.fd = fd, .events = POLLOUT};

	return fd < 0 || poll(&poll_fd, 1, 0) > 0;
}

/* -EAGAIN: fd is full, nothing was written. Other failures lose the line. */
static int write_line(int fd, int prefix, int level, const char *text, size_t len)
{
	char out[LINE_BYTES + 8];
	size_t size = 0, done = 0;

	if (prefix) {
		out[size++] = '<';
		out[size++] = (char)('0' + (level > LOG_LEVEL_DEBUG ? LOG_LEVEL_DEBUG : level));
		out[size++] = '>';
	}
	memcpy(out + size, text, len);
	size += len;
	out[size++] = '\n';
	while (done < size) {
		ssize_t n;

		if (!takes_line(fd))
			return done ? -EIO : -EAGAIN;
		n = write(fd, out + done, size - done);

		if (n > 0)
			done += (size_t)n;
		else if (n < 0 && errno == EAGAIN && done == 0)
			return -EAGAIN;
		else if (n == 0 || errno != EINTR)
			return -EIO;
	}
	return 0;
}

static void report_lost(struct log *log, int fd, int prefix)
{
	uint32_t dropped = __atomic_load_n(&log->dropped, __ATOMIC_RELAXED);
	uint32_t lost = dropped - log->reported;
	char text[48];
	int len;

	if (lost == 0)
		return;
	len = snprintf(text, sizeof(text), "%u log line%s lost", (unsigned)lost,
	               lost == 1 ? "" : "s");
	if (write_line(fd, prefix, LOG_LEVEL_WARNING, text, (size_t)len) == 0)
		log->reported = dropped;
}

static bool has_lines(const struct log *log)
{
	const struct line *line = &log->lines[log->tail % LINES];
	uint32_t generation = log->tail - log->tail % LINES;

	return __atomic_load_n(&line->generation, __ATOMIC_ACQUIRE) == generation + 1;
}

void log_show(struct log *log, log_see *see, void *ctx)
{
	log->see = see;
	log->see_ctx = ctx;
}

int log_drain(struct log *log, int fd, int prefix)
{
	int count = 0;

	/* a line that comes from here on rings again */
	bell_clear(log->bell);
	/* One round at most: producers that never stop must not keep the supervisor here. */
	while (count < (int)LINES) {
		struct line *line = &log->lines[log->tail % LINES];
		uint32_t generation = log->tail - log->tail % LINES;
		int err;

		if (!has_lines(log))
			break;
		err = write_line(fd, prefix, line->level, line->text, line->len);
		if (err == -EAGAIN)
			return count;
		if (err) /* a full disk or no reader: report_lost() logs the loss later */
			__atomic_fetch_add(&log->dropped, 1, __ATOMIC_RELAXED);
		if (log->see)
			log->see(log->see_ctx, line->time_ns, (enum log_level)line->level,
			         line->text, line->len);
		__atomic_store_n(&line->generation, generation + LINES, __ATOMIC_RELEASE);
		log->tail++;
		count++;
	}
	report_lost(log, fd, prefix);
	return count;
}

static int64_t clock_ms(void)
{
	return clock_ns(CLOCK_MONOTONIC) / NS_PER_MS;
}

void log_finish(struct log *log, int fd, int prefix)
{
	struct pollfd poll_fd = {.fd = fd, .events = POLLOUT};
	int64_t end_ms = clock_ms() + FINISH_MS, left_ms = FINISH_MS;

	log_drain(log, fd, prefix);
	while (has_lines(log) && left_ms > 0) {
		poll(&poll_fd, 1, (int)left_ms);
		log_drain(log, fd, prefix);
		left_ms = end_ms - clock_ms();
	}
}

int log_bell(const struct log *log)
{
	return log->bell;
}

uint64_t log_dropped(const struct log *log)
{
	return __atomic_load_n(&log->dropped, __ATOMIC_RELAXED);
}
