/* SPDX-License-Identifier: MIT */
/* A .rio file read into memory, if it is one. */
#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "hal/base/file.h"
#include "src/config/read/rio.h"
#include "src/config/read/rio_file.h"

/* Is the text UTF-16, as some editors save files, with or without a byte order mark? */
static bool is_utf16(const char *text, size_t len)
{
	return len >= 2 && (!memcmp(text, "\xff\xfe", 2) || !memcmp(text, "\xfe\xff", 2) ||
	                    !text[0] != !text[1]);
}

static const char *file_kind(mode_t mode)
{
	switch (mode & S_IFMT) {
	case S_IFDIR:
		return "directory";
	case S_IFIFO:
		return "pipe";
	case S_IFSOCK:
		return "socket";
	default:
		return "device";
	}
}

/* Refuse all but regular files: a pipe may have no writer, and a device any number of bytes. */
static int rio_file_check(const struct stat *st, struct rio_position position,
                          struct config_report *report)
{
	if (!S_ISREG(st->st_mode)) {
		report_error(report, position, "is a %s: only a regular file is read",
		             file_kind(st->st_mode));
		return -EINVAL;
	}
	if (st->st_size > (off_t)RIO_FILE_MAX) {
		report_error(report, position, "longer than %u bytes", RIO_FILE_MAX);
		return -EFBIG;
	}
	return 0;
}

static int cannot_read(struct config_report *report, struct rio_position position, int err)
{
	report_error(report, position, "cannot be read: %s", strerror(-err));
	return err;
}

bool rio_dangles(const char *file)
{
	struct stat st;

	return !lstat(file, &st) && S_ISLNK(st.st_mode) && stat(file, &st) && errno == ENOENT;
}

/* Returns a descriptor, or a negative errno after reporting why. */
static int open_file(const char *file, struct config_report *report)
{
	const struct rio_position position = {file, 0, 0};
	struct stat st;
	int fd, err;

	if (!*file) {
		report_error(report, (struct rio_position){0},
		             "the name of the configuration is empty");
		return -EINVAL;
	}
	/* check before opening, which has an effect on some devices */
	if (stat(file, &st) < 0) {
		err = -errno;
		if (err != -ENOENT || !rio_dangles(file))
			return cannot_read(report, position, err);
		report_error(report, position, RIO_DANGLES);
		return err;
	}
	err = rio_file_check(&st, position, report);
	if (err)
		return err;
	fd = open(file, O_RDONLY | O_CLOEXEC | O_NOCTTY | O_NONBLOCK);
	if (fd < 0)
		return cannot_read(report, position, -errno);
	/* check again, since another file may have taken its place */
	err = fstat(fd, &st) < 0 ? cannot_read(report, position, -errno)
	                         : rio_file_check(&st, position, report);
	if (err)
		close(fd);
	return err ? err : fd;
}

int rio_read(const char *file, struct config_report *report, char **text, size_t *len)
{
	const struct rio_position position = {file, 0, 0};
	int fd = open_file(file, report);
	int err;

	*text = NULL;
	if (fd < 0)
		return fd;
	*text = file_whole(fd, RIO_FILE_MAX, len, &err);
	close(fd);
	if (!*text)
		return cannot_read(report, position, err);
	err = 0;
	if (*len > RIO_FILE_MAX) {
		report_error(report, position, "longer than %u bytes", RIO_FILE_MAX);
		err = -EFBIG;
	} else if (is_utf16(*text, *len)) {
		report_error(report, position, "is UTF-16: save it as UTF-8");
		err = -EILSEQ;
	}
	if (err) {
		free(*text);
		*text = NULL;
	}
	return err;
}
