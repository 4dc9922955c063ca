/* SPDX-License-Identifier: MIT */
/* In place of libows-history in a build without SQLite: there is no history that could be read. */
#include <errno.h>

/* no function here uses what it is given */
#pragma GCC diagnostic ignored "-Wunused-parameter"

#include "src/history/library/replay.h"
#include "src/public/ows_history.h"

#define NONE(name, ...) \
	int name(__VA_ARGS__) \
	{ \
		return -ENOSYS; \
	}

NONE(ows_history_place, const char *instance, char *path, size_t size)

int ows_history_open(const char *instance, const char *directory, struct ows_history **h)
{
	*h = NULL;
	return -ENOSYS;
}

/* No handle is ever made, so no program can call these. */
void ows_history_close(struct ows_history *h)
{
	(void)h;
}

const char *ows_history_reason_text(uint8_t reason)
{
	return "unknown";
}

NONE(ows_history_refresh, struct ows_history *h)
NONE(ows_history_signals, struct ows_history *h)
NONE(ows_history_signal, struct ows_history *h, int index, struct ows_history_signal *signal)
NONE(ows_history_find, struct ows_history *h, const char *name)
NONE(ows_history_span, struct ows_history *h, int64_t *from_ns, int64_t *until_ns)
NONE(ows_history_read, struct ows_history *h, int signal, int64_t from_ns, int64_t until_ns)
NONE(ows_history_next, struct ows_history *h, struct ows_history_item *items, int n)
NONE(ows_history_points, struct ows_history *h, int signal, int64_t from_ns, int64_t until_ns,
     struct ows_history_point *points, int n)
NONE(ows_history_events, struct ows_history *h, int64_t from_ns, int64_t until_ns, uint32_t kinds)
NONE(ows_history_next_event, struct ows_history *h, struct ows_history_event *event)

int64_t replay_place(const struct ows_history *h, const struct replay_point *point)
{
	return -ENOSYS;
}

int64_t replay_end(const struct ows_history *h)
{
	return 0;
}

NONE(replay_rows, struct ows_history *h, int64_t first, int64_t end, struct replay_row *rows, int n)
