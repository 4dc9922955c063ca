/* SPDX-License-Identifier: MIT */
/* In place of libows-history in a build without SQLite: there is no history that could be read. */
#include <errno.h>

#include "src/libhistory/ows_history.h"
#include "src/libhistory/replay.h"

int ows_history_place(const char *instance, char *path, size_t size)
{
	(void)instance, (void)path, (void)size;
	return -ENOSYS;
}

int ows_history_open(const char *instance, const char *directory, struct ows_history **h)
{
	(void)instance, (void)directory;
	*h = NULL;
	return -ENOSYS;
}

/* No handle is ever made: nobody can call these. */
void ows_history_close(struct ows_history *h)
{
	(void)h;
}

int ows_history_refresh(struct ows_history *h)
{
	(void)h;
	return -ENOSYS;
}

int ows_history_signal(struct ows_history *h, int index, struct ows_history_signal *signal)
{
	(void)h, (void)index, (void)signal;
	return -ENOSYS;
}

int ows_history_find(struct ows_history *h, const char *name)
{
	(void)h, (void)name;
	return -ENOSYS;
}

int ows_history_span(struct ows_history *h, int64_t *from_ns, int64_t *until_ns)
{
	(void)h, (void)from_ns, (void)until_ns;
	return -ENOSYS;
}

const char *ows_history_reason_text(uint8_t reason)
{
	(void)reason;
	return "unknown";
}

int ows_history_read(struct ows_history *h, int signal, int64_t from_ns, int64_t until_ns)
{
	(void)h, (void)signal, (void)from_ns, (void)until_ns;
	return -ENOSYS;
}

int ows_history_next(struct ows_history *h, struct ows_history_item *items, int n)
{
	(void)h, (void)items, (void)n;
	return -ENOSYS;
}

int ows_history_points(struct ows_history *h, int signal, int64_t from_ns, int64_t until_ns,
                       struct ows_history_point *points, int n)
{
	(void)h, (void)signal, (void)from_ns, (void)until_ns, (void)points, (void)n;
	return -ENOSYS;
}

int ows_history_events(struct ows_history *h, int64_t from_ns, int64_t until_ns, uint32_t kinds)
{
	(void)h, (void)from_ns, (void)until_ns, (void)kinds;
	return -ENOSYS;
}

int ows_history_next_event(struct ows_history *h, struct ows_history_event *event)
{
	(void)h, (void)event;
	return -ENOSYS;
}

int64_t replay_place(const struct ows_history *h, const struct replay_point *point)
{
	(void)h, (void)point;
	return -ENOSYS;
}

int64_t replay_end(const struct ows_history *h)
{
	(void)h;
	return 0;
}

int replay_rows(struct ows_history *h, int64_t first, int64_t end, struct replay_row *rows, int n)
{
	(void)h, (void)first, (void)end, (void)rows, (void)n;
	return -ENOSYS;
}
