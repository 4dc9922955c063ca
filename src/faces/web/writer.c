/* SPDX-License-Identifier: MIT */
/* Sends the writer an order, and reads what it answers. */
#include <ctype.h>
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <sys/un.h>
#include <unistd.h>

#include "hal/base/time.h"
#include "src/faces/web/writer.h"
#include "src/ground/text/printable.h"
#include "src/memory/shm/dir.h"
#include "src/memory/shm/segment.h"

/* The writer waits 10 s for a request, 5 s for a lock and 30 s for owsd; others may be before it */
#define PATIENCE_NS (70 * NS_PER_S)
#define ANSWER_MAX (256u << 10) /* bytes */

/* --- The answer ------------------------------------------------------------------------------ */

static int status_of(const char *word)
{
	static const char *const words[] = {
		[WRITER_DONE] = "done",       [WRITER_CONFLICT] = "conflict",
		[WRITER_INVALID] = "invalid", [WRITER_REFUSED] = "refused",
		[WRITER_ERROR] = "error",
	};

	for (int i = 0; i <= WRITER_ERROR; i++)
		if (strcmp(word, words[i]) == 0)
			return i;
	return -EPROTO;
}

bool writer_is_tag(const char *text)
{
	return !*text ||
	       (strlen(text) == TAG_TEXT - 1 && text[strspn(text, "0123456789abcdef")] == '\0');
}

/* Digits and a blank, or the end: *text is behind them then. False: no number up to most. */
static bool parse_number(const char **text, int64_t most, int64_t *number)
{
	char *end;

	if (!isdigit((unsigned char)**text))
		return false;
	errno = 0;
	*number = strtoll(*text, &end, 10);
	if (errno || *number > most || (*end && *end != ' '))
		return false;
	*text = end + (*end == ' ');
	return true;
}

/* "E 12 3 words" */
static int parse_problem(const char *value, struct problems *problems)
{
	struct config_report report = problems_report(problems);
	bool error = *value == 'E';
	int64_t line, column;

	if ((!error && *value != 'W') || value[1] != ' ')
		return -EPROTO;
	value += 2;
	if (!parse_number(&value, INT_MAX, &line) || !parse_number(&value, INT_MAX, &column))
		return -EPROTO;
	report.problem(report.ctx, error, (int)line, (int)column, value);
	return 0;
}

static int take_backup(const char *value, struct writer_answer *answer)
{
	size_t len = strcspn(value, " ");

	if (!len || len >= sizeof(answer->backup) || !value[len])
		return -EPROTO;
	snprintf(answer->backup, sizeof(answer->backup), "%.*s", (int)len, value);
	value += len + 1;
	if (!writer_is_tag(answer->backup) ||
	    !parse_number(&value, INT64_MAX, &answer->backup_ms) || *value)
		return -EPROTO;
	return 0;
}

/* A key that is not known is of a later writer. */
static int parse_line(const char *key, char *value, struct writer_answer *answer, bool *has_status)
{
	int status;

	value[printable(value, strlen(value))] = '\0';
	if (strcmp(key, "status") == 0) {
		status = status_of(value);
		if (status < 0)
			return status;
		answer->status = (enum writer_status)status;
		*has_status = true;
	} else if (strcmp(key, "tag") == 0) {
		if (!writer_is_tag(value))
			return -EPROTO;
		snprintf(answer->tag, sizeof(answer->tag), "%s", value);
	} else if (strcmp(key, "reload") == 0) {
		snprintf(answer->reload, sizeof(answer->reload), "%.7s", value);
	} else if (strcmp(key, "why") == 0) {
		snprintf(answer->why, sizeof(answer->why), "%s", value);
	} else if (strcmp(key, "backup") == 0) {
		return take_backup(value, answer);
	} else if (strcmp(key, "problem") == 0) {
		return parse_problem(value, &answer->problems);
	}
	return 0;
}

int writer_parse(char *text, size_t len, struct writer_answer *answer)
{
	bool has_status = false;
	char *line = text;
	int err = 0;

	*answer = (struct writer_answer){.reload = "none"};
	if (strlen(text) != len)
		return -EPROTO;
	for (char *end; !err && (end = strchr(line, '\n')); line = end + 1) {
		char *colon = strchr(line, ':');

		*end = '\0';
		if (end == line)
			return has_status && !end[1] ? 0 : -EPROTO;
		if (!colon || colon >= end)
			return -EPROTO;
		*colon = '\0';
		err = parse_line(line, colon + 1 + (colon[1] == ' '), answer, &has_status);
	}
	return -EPROTO;
}

/* --- The connection -------------------------------------------------------------------------- */

/* The path of the socket, by the descriptor of its directory: a long name has room, too. */
static int name_socket(const struct shm_dir *dir, const char *instance, struct sockaddr_un *address)
{
	char name[SEGMENT_FILE];
	int n;

	*address = (struct sockaddr_un){.sun_family = AF_UNIX};
	n = snprintf(address->sun_path, sizeof(address->sun_path), "/proc/self/fd/%d/%s", dir->fd,
	             segment_file(instance, "config", name));
	return n < (int)sizeof(address->sun_path) ? 0 : -ENAMETOOLONG;
}

static int connect_there(const char *path, const char *instance)
{
	static const struct timeval patience = {.tv_sec = PATIENCE_NS / NS_PER_S};
	struct sockaddr_un address;
	struct shm_dir dir;
	int err = dir_open(path, &dir), fd;

	if (err)
		return err;
	err = name_socket(&dir, instance, &address);
	fd = err ? err : socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
	if (!err && fd < 0)
		fd = -errno;
	if (fd >= 0) {
		setsockopt(fd, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof(patience));
		setsockopt(fd, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
	}
	if (fd >= 0 && connect(fd, (const struct sockaddr *)&address, sizeof(address))) {
		err = -errno;
		close(fd);
		fd = err;
	}
	dir_close(&dir);
	return fd;
}

static int connect_first(const char *instance)
{
	char dirs[DIRS][DIR_PATH];
	int count = dir_list(dirs), err = count < 0 ? count : -ENOENT;

	for (int i = 0; i < count; i++) {
		int fd = connect_there(dirs[i], instance);

		if (fd >= 0)
			return fd;
		if (err == -ENOENT)
			err = fd;
	}
	return err;
}

bool writer_is_there(const char *instance)
{
	char dirs[DIRS][DIR_PATH], name[SEGMENT_FILE];
	int count = dir_list(dirs);
	bool is = false;

	segment_file(instance, "config", name);
	for (int i = 0; i < count && !is; i++) {
		struct shm_dir dir;
		struct stat st;

		if (dir_open(dirs[i], &dir))
			continue;
		is = fstatat(dir.fd, name, &st, 0) == 0 && S_ISSOCK(st.st_mode);
		dir_close(&dir);
	}
	return is;
}

void writer_remedy(const char *instance, char text[WRITER_WORDS])
{
	snprintf(text, WRITER_WORDS,
	         "the writer of the configuration does not run: systemctl enable --now "
	         "owsd-writer@%s.socket; without a service start owsd-writer",
	         instance);
}

/* A writer that has answered before the end may hang up: its answer counts. */
static int send_all(int fd, const char *bytes, size_t len)
{
	while (len) {
		ssize_t n = send(fd, bytes, len, MSG_NOSIGNAL);

		if (n < 0 && errno != EINTR)
			return errno == EPIPE || errno == ECONNRESET ? 0 : -errno;
		bytes += n > 0 ? n : 0;
		len -= n > 0 ? (size_t)n : 0;
	}
	return 0;
}

/* A writer that sends byte by byte has no longer than another. */
static int receive_all(int fd, char *text, size_t size, size_t *len, int64_t until_ns)
{
	for (*len = 0; *len < size - 1;) {
		ssize_t n = recv(fd, text + *len, size - 1 - *len, 0);

		if (n == 0 || (n < 0 && errno == ECONNRESET && *len))
			break;
		if (n < 0 && errno != EINTR)
			return -errno;
		if (ows_now() >= until_ns)
			return -ETIMEDOUT;
		*len += n > 0 ? (size_t)n : 0;
	}
	text[*len] = '\0';
	return 0;
}

static int send_order(int fd, const struct writer_order *order)
{
	size_t len = order->text ? strlen(order->text) : 0;
	char head[256], length[32] = "";
	int n, err;

	if (order->text)
		snprintf(length, sizeof(length), "length: %zu\n", len);
	n = snprintf(head, sizeof(head), "owsd-writer 1\ndo: %s\nbase: %s\nfor: %s\n%s\n",
	             order->text ? "replace" : "restore", order->base, order->person, length);
	if (n >= (int)sizeof(head))
		return -EINVAL;
	err = send_all(fd, head, (size_t)n);
	return err || !len ? err : send_all(fd, order->text, len);
}

int writer_ask(const struct writer_order *order, struct writer_answer *answer)
{
	int64_t until_ns = ows_now() + PATIENCE_NS;
	int fd = connect_first(order->instance), err;
	char *text = malloc(ANSWER_MAX);
	size_t len = 0;

	*answer = (struct writer_answer){.reload = "none"};
	err = fd < 0 ? fd : text ? send_order(fd, order) : -ENOMEM;
	if (!err && receive_all(fd, text, ANSWER_MAX, &len, until_ns))
		err = -EINPROGRESS;
	if (!err)
		err = writer_parse(text, len, answer);
	if (err)
		problems_free(&answer->problems);
	free(text);
	if (fd >= 0)
		close(fd);
	return err;
}
