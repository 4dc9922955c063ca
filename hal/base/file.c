/* SPDX-License-Identifier: MIT */
/* Reads a file as a whole. */
#include "hal/base/file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define ROOM_FIRST ((size_t)64 * 1024)

char *file_whole(int fd, size_t most, size_t *len, int *err)
{
	size_t room = most < ROOM_FIRST ? most + 1 : ROOM_FIRST, used = 0;
	char *data = malloc(room + 1), *more;
	ssize_t n;

	*err = -ENOMEM;
	while (data) {
		n = read(fd, data + used, room - used);
		if (n < 0 && errno == EINTR)
			continue;
		if (n < 0) {
			*err = -errno;
			free(data);
			return NULL;
		}
		used += (size_t)n;
		if (n == 0 || used > most)
			break;
		if (used < room)
			continue;
		room = room > most / 2 ? most + 1 : room * 2;
		more = realloc(data, room + 1);
		if (!more)
			free(data);
		data = more;
	}
	if (!data)
		return NULL;
	data[used] = '\0';
	*len = used;
	*err = 0;
	return data;
}

char *file_text(const char *file, size_t most, int *err, char *why, size_t why_size)
{
	int fd = open(file, O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
	char *text = NULL;
	struct stat st;
	size_t len;

	*err = fd < 0 || fstat(fd, &st) ? -errno : S_ISREG(st.st_mode) ? 0 : -EINVAL;
	if (!*err)
		text = file_whole(fd, most, &len, err);
	if (fd >= 0)
		close(fd);
	if (text && len <= most && strlen(text) == len)
		return text;
	if (text && len > most) {
		*err = -EFBIG;
		snprintf(why, why_size, "%.100s: longer than %zu bytes", file, most);
	} else if (text) {
		*err = -EINVAL;
		snprintf(why, why_size, "%.100s: has a zero byte, is not text", file);
	} else if (*err != -ENOMEM) {
		snprintf(why, why_size, "%.100s: %s", file,
		         *err == -EINVAL ? "not a regular file" : strerror(-*err));
	}
	free(text);
	return NULL;
}
