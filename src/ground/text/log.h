/* SPDX-License-Identifier: MIT */
/*
 * The log: any thread puts lines into a bounded ring, without blocking and without a system call
 * but one wake; the supervisor writes them to stderr. The log counts the lines that find the ring
 * full.
 *
 * Room src/ground/text: the log, and texts that are safe to print.
 */
#pragma once

#include <stddef.h>
#include <stdint.h>

enum log_level { /* syslog's numbers */
	         LOG_LEVEL_ERR = 3,
	         LOG_LEVEL_WARNING = 4,
	         LOG_LEVEL_NOTICE = 5,
	         LOG_LEVEL_INFO = 6,
	         LOG_LEVEL_DEBUG = 7,
	         LOG_LEVEL_TRACE =
	                 8, /* the requests themselves; to the journal this is debug too */
};

struct log;

/*
 * Allocates the ring once. Lines above level are not formatted. NULL: no memory, or no descriptor.
 */
struct log *log_create(enum log_level level);
void log_destroy(struct log *log);
enum log_level log_level(const struct log *log);

/* Any thread. Cuts the line at 255 bytes; control characters become '?'. log NULL: does nothing. */
void log_put(struct log *log, enum log_level level, const char *format, ...)
	__attribute__((format(printf, 3, 4)));

/*
 * What a program says of itself, then the kernel's word on it: a name in quotes, which has none, a
 * process and a user.
 */
#define LOG_PROGRAM "\"%s\" (process %d, user %u)"

#define log_at(log, lvl, ...) \
	do { \
		if ((log) && (lvl) <= log_level(log)) \
			log_put((log), (lvl), __VA_ARGS__); \
	} while (0)
#define log_err(log, ...) log_at(log, LOG_LEVEL_ERR, __VA_ARGS__)
#define log_warning(log, ...) log_at(log, LOG_LEVEL_WARNING, __VA_ARGS__)
#define log_notice(log, ...) log_at(log, LOG_LEVEL_NOTICE, __VA_ARGS__)
#define log_info(log, ...) log_at(log, LOG_LEVEL_INFO, __VA_ARGS__)
#define log_debug(log, ...) log_at(log, LOG_LEVEL_DEBUG, __VA_ARGS__)
#define log_trace(log, ...) log_at(log, LOG_LEVEL_TRACE, __VA_ARGS__)

/*
 * For an event that may repeat every cycle: whether to log it now (the 1st, 2nd, 4th, 8th time, and
 * at least hourly). Returns how many events there were since the last one that was logged, this
 * one included, or 0: do not log now. log_others() makes of a number above 1 the words that end the
 * line; else they are empty.
 */
struct log_rate {
	uint64_t seen, reported, next;
	int64_t last_ns;
};
uint64_t log_rate(struct log_rate *rate, int64_t now_ns);
#define LOG_OTHERS 64
const char *log_others(uint64_t n, char text[LOG_OTHERS]);

/*
 * Show each line that log_drain() takes to see, too; text has len bytes and no NUL. time_ns is
 * CLOCK_BOOTTIME. NULL: no more. Supervisor only.
 */
typedef void log_see(void *ctx, int64_t time_ns, enum log_level level, const char *text,
                     size_t len);
void log_show(struct log *log, log_see *see, void *ctx);
/*
 * Supervisor only: write the lines to fd (with "<4>" levels if prefix) as long as fd takes them
 * without blocking; the other lines stay in the ring. Returns how many were written.
 */
int log_drain(struct log *log, int fd, int prefix);
/* Write the last lines before the end; tries for at most 200 ms. */
void log_finish(struct log *log, int fd, int prefix);
/* A bell (hal/base/bell.h), rung from the moment a line is put until the next log_drain(). */
int log_bell(const struct log *log);
uint64_t log_dropped(const struct log *log);
