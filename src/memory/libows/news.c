/* SPDX-License-Identifier: MIT */
/* News of owsd: by the descriptor of a connected handle, else by the word of the image. */
#include <errno.h>
#include <poll.h>
#include <time.h>
#include <unistd.h>

#include "hal/base/time.h"
#include "src/memory/libows/handle.h"
#include "src/memory/libows/meet.h"
#include "src/memory/libows/news.h"
#include "src/memory/shm/futex.h"
#include "src/memory/shm/word.h"

#define JOIN_NS (2 * NS_PER_S) /* the longest wait of ows_fd() for owsd's welcome */

/* Is something to be read? Returns 1, 0, or a negative errno; also 0 when owsd has hung up. */
static int news_await(int fd, int64_t left_ns, bool *gone)
{
	struct timespec t = timespec_of(left_ns);
	struct pollfd poll_fd = {.fd = fd, .events = POLLIN};
	int n = ppoll(&poll_fd, 1, &t, NULL);

	if (n < 0)
		return -errno;
	*gone = n > 0 && (poll_fd.revents & POLLHUP);
	return n > 0 && !*gone;
}

/* A forked child leaves its parent the news. */
static bool has_descriptor(const struct ows *h)
{
	return h->join.news >= 0 && !handle_is_forked(h);
}

/* Make the descriptor readable at the next news, and not before. Without one it does nothing. */
static void news_arm(struct ows *h)
{
	int saved = errno;
	char room[64];
	bool gone = false;

	if (!has_descriptor(h))
		return;
	while (news_await(h->join.news, 0, &gone) == 1)
		if (read(h->join.news, room, sizeof(room)) <= 0)
			break;
	if (gone)
		join_hush(&h->join);
	word_set(&give_header(&h->give)->waits, 1);
	/* owsd counts its news before it looks which programs wait */
	word_fence(__ATOMIC_SEQ_CST);
	errno = saved;
}

int news_sleep(struct ows *h, uint32_t seen, int64_t left_ns)
{
	const uint32_t *word = &h->map.image->news;
	int saved = errno, n;
	bool gone = false;

	news_arm(h);
	if (word_get(word) != seen)
		return 0;
	n = has_descriptor(h) ? news_await(h->join.news, left_ns, &gone) : 0;
	errno = saved;
	if (!has_descriptor(h) || gone)
		return segment_wait(word, seen, left_ns);
	return n > 0 ? 0 : n < 0 ? n : -ETIMEDOUT;
}

int news_stale(struct ows *h, int64_t timeout_ns)
{
	static const uint32_t unchanged = 0;
	int64_t pause = timeout_ns < 0 || timeout_ns > NEXT_OWSD_NS ? NEXT_OWSD_NS : timeout_ns;

	if (h->told_stale && pause > 0)
		segment_wait(&unchanged, 0, pause);
	h->told_stale = true;
	return -ESTALE;
}

int ows_fd(struct ows *h)
{
	int saved = errno, err;
	uint64_t ticks;

	if (h->mine == NULL) {
		err = meet(h, &h->map, ows_now() + JOIN_NS);
		if (err)
			meet_leave(h);
		else
			meet_take(h);
		errno = saved;
		if (err)
			return err == -EAGAIN ? -ETIMEDOUT : err;
	}
	if (handle_is_forked(h))
		return -EPERM;
	err = join_watch(&h->join);
	news_arm(h);
	if (!err && read(h->join.timer, &ticks, sizeof(ticks)) < 0)
		ticks = 0; /* it has not run out yet */
	errno = saved;
	return err ? err : h->join.epoll;
}
