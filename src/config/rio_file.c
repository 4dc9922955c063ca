/* SPDX-License-Identifier: MIT */
#include "rio.h"

#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* One byte more than is allowed, so that a longer file is known as such. */
#define ROOM_MAX ((size_t)RIO_FILE_MAX + 1)

static int read_all(int fd, char **text, size_t *len)
{
	size_t room = 64 * 1024, used = 0;
	char *data = malloc(room + 1), *more;
	ssize_t n;

	while (data) {
		n = read(fd, data + used, room - used);
		if (n < 0 && errno == EINTR)
			continue;
		if (n < 0) {
			int err = -errno;

			free(data);
			return err;
		}
		used += (size_t)n;
		if (n == 0 || used == ROOM_MAX)
			break;
		if (used < room)
			continue;
		room = room > ROOM_MAX / 2 ? ROOM_MAX : room * 2;
		more = realloc(data, room + 1);
		if (!more)
			free(data);
		data = more;
	}
	if (!data)
		return -ENOMEM;
	data[used] = '\0';
	*text = data;
	*len = used;
	return 0;
}

/* As Windows saves what it calls Unicode; with a byte order mark or without. */
static bool is_utf16(const char *text, size_t len)
{
	return len >= 2 && (!memcmp(text, "\xff\xfe", 2) || !memcmp(text, "\xfe\xff", 2) ||
	                    !text[0] != !text[1]);
}

int rio_read(const char *file, struct config_report *report, char **text, size_t *len)
{
	const struct place place = { file, 0, 0 };
	int fd = open(file, O_RDONLY | O_CLOEXEC | O_NOCTTY);
	int err = fd < 0 ? -errno : read_all(fd, text, len);

	if (fd >= 0)
		close(fd);
	if (err || fd < 0) {
		report_error(report, place, "cannot be read: %s", strerror(-err));
		*text = NULL;
		return err;
	}
	if (*len > RIO_FILE_MAX) {
		report_error(report, place, "longer than %u bytes", RIO_FILE_MAX);
		err = -EFBIG;
	} else if (is_utf16(*text, *len)) {
		report_error(report, place, "is UTF-16: save it as UTF-8");
		err = -EILSEQ;
	}
	if (err) {
		free(*text);
		*text = NULL;
	}
	return err;
}
