/* SPDX-License-Identifier: MIT */
/* Asks owsd to load its configuration again, over a connection for this alone. */
#include <errno.h>
#include <sys/socket.h>

#include "src/memory/libows/join.h"
#include "src/memory/shm/dir.h"
#include "src/memory/shm/segment.h"
#include "src/public/ows.h"

#define ERRNO_MAX 4095

struct answer {
	struct ows_welcome welcome;
	char words[OWS_WHY];
};

static void reload_show(const char *words, size_t len, char *why, size_t size)
{
	size_t n = len < size ? len : size - 1;

	for (size_t i = 0; i < n; i++)
		why[i] = (unsigned char)words[i] < ' ' || words[i] == 0x7f ? '?' : words[i];
	why[n] = '\0';
}

/* Receive the answer; -EAGAIN: none is there yet. */
static int reload_take(int connection, char *why, size_t size)
{
	struct answer answer = {0};
	const struct ows_welcome *welcome = &answer.welcome;
	ssize_t n = recv(connection, &answer, sizeof(answer), MSG_DONTWAIT);

	if (n < 0 && errno == ECONNRESET) /* what owsd has sent lies behind that */
		n = recv(connection, &answer, sizeof(answer), MSG_DONTWAIT);
	if (n < 0)
		return errno == EAGAIN || errno == EINTR ? -EAGAIN : -ENOTCONN;
	if (n == 0)
		return -ENOTCONN;
	/* An owsd that knows nothing of this flag makes the program a controller */
	if (n < (ssize_t)sizeof(*welcome) || welcome->magic != OWS_WELCOME_MAGIC ||
	    welcome->size != 0 || welcome->err > 0 || welcome->err < -ERRNO_MAX)
		return -EPROTO;
	if (why && size)
		reload_show(answer.words, (size_t)n - sizeof(*welcome), why, size);
	return welcome->err;
}

/* -ENOENT: no owsd runs there. */
static int reload_ask(const char *path, const char *instance, struct join *join)
{
	char name[SEGMENT_FILE];
	struct shm_dir dir;
	int err = dir_open(path, &dir);

	if (err)
		return err;
	err = join_begin(join, dir.fd, segment_file(instance, "control", name),
	                 program_invocation_short_name, OWS_HELLO_RELOAD);
	dir_close(&dir);
	return err;
}

static int ask_first(const char *instance, struct join *join)
{
	char dirs[DIRS][DIR_PATH];
	int count = dir_list(dirs), why = -ENOENT;

	if (count < 0)
		return count;
	for (int i = 0; i < count; i++) {
		int err = reload_ask(dirs[i], instance, join);

		if (!err)
			return 0;
		if (why == -ENOENT)
			why = err;
	}
	return why;
}

int ows_reload(const char *instance, int64_t timeout_ns, char *why, size_t size)
{
	int64_t until_ns = wait_until(ows_now(), timeout_ns);
	int saved = errno, err;
	struct join join;

	if (why && size)
		*why = '\0';
	if (!instance)
		instance = "OWS";
	if (!segment_name_ok(instance))
		return -EINVAL;
	join_none(&join);
	err = ask_first(instance, &join);
	if (!err)
		do
			err = reload_take(join.connection, why, size);
		while (err == -EAGAIN && join_await(join.connection, until_ns));
	join_end(&join);
	errno = saved;
	return err == -EAGAIN ? -ETIMEDOUT : err;
}
