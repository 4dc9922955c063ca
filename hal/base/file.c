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

char *file_text(const char *file, size_t most, int *err, char *why, size_t why_size)
{
	int fd = open(file, O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
	char *text = NULL;
	struct stat st;
	size_t len = 0;
	ssize_t n = 1;

	*err = fd < 0 || fstat(fd, &st) ? -errno : S_ISREG(st.st_mode) ? 0 : -EINVAL;
	if (*err) {
		snprintf(why, why_size, "%.100s: %s", file,
		         *err == -EINVAL ? "not a regular file" : strerror(-*err));
	} else {
		text = malloc(most + 2);
		*err = text ? 0 : -ENOMEM;
	}
	while (text && n > 0 && len <= most) {
		do
			n = read(fd, text + len, most + 1 - len);
		while (n < 0 && errno == EINTR);
		*err = n < 0 ? -errno : 0;
		len += n > 0 ? (size_t)n : 0;
	}
	if (fd >= 0)
		close(fd);
	if (!text)
		return NULL;
	text[len] = '\0';
	if (n >= 0 && len <= most && strlen(text) == len)
		return text;
	if (n < 0) {
		snprintf(why, why_size, "%.100s: %s", file, strerror(-*err));
	} else if (len > most) {
		*err = -EFBIG;
		snprintf(why, why_size, "%.100s: longer than %zu bytes", file, most);
	} else {
		*err = -EINVAL;
		snprintf(why, why_size, "%.100s: has a zero byte, is not text", file);
	}
	free(text);
	return NULL;
}
