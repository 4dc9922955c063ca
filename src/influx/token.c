/* SPDX-License-Identifier: MIT */
/* Reads the token, and refuses one that others may have read. */
#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "src/influx/token.h"

#define BLANK " \t\r\n"

static int refuse(int err, const char *path, const char *reason, char *why, size_t size)
{
	snprintf(why, size, "%s: %s", path, reason);
	return err;
}

/* Cut what stands around the token, and look at its letters. */
static bool trim(char *text)
{
	size_t begin = strspn(text, BLANK), len = strcspn(text + begin, BLANK);

	memmove(text, text + begin, len);
	if (!len || text[begin + len + strspn(text + begin + len, BLANK)])
		return false;
	text[len] = '\0';
	for (const char *c = text; *c; c++)
		if (*c < ' ' || *c == 127)
			return false;
	return true;
}

static int take(int fd, bool credential, const char *path, char token[TOKEN_SIZE], char *why,
                size_t size)
{
	struct stat st;
	ssize_t n;

	if (fstat(fd, &st) < 0 || !S_ISREG(st.st_mode))
		return refuse(-EINVAL, path, "is no file", why, size);
	/* the service manager keeps the directory of credentials from others */
	if (!credential && (st.st_mode & 077))
		return refuse(-EPERM, path, "others may read it: chmod 600", why, size);
	n = read(fd, token, TOKEN_SIZE - 1);
	token[n > 0 ? n : 0] = '\0';
	if (n < 0)
		return refuse(-errno, path, strerror(errno), why, size);
	if (n == TOKEN_SIZE - 1 || !trim(token)) {
		token[0] = '\0';
		return refuse(-EINVAL, path, "expected one token in one line", why, size);
	}
	return 0;
}

int token_read(const char *name, char token[TOKEN_SIZE], char *why, size_t size)
{
	const char *directory = getenv("CREDENTIALS_DIRECTORY");
	bool credential = name && name[0] != '/';
	char path[TOKEN_PATH];
	int fd, err;

	token[0] = '\0';
	if (!name)
		return 0;
	if (credential && !directory)
		return refuse(-ENOENT, name,
		              "the service has no credentials: LoadCredential= in its unit", why,
		              size);
	if (snprintf(path, sizeof(path), "%s%s%s", credential ? directory : "",
	             credential ? "/" : "", name) >= (int)sizeof(path))
		return refuse(-ENAMETOOLONG, name, strerror(ENAMETOOLONG), why, size);
	fd = open(path, O_RDONLY | O_CLOEXEC | O_NOCTTY | O_NONBLOCK);
	if (fd < 0) {
		err = -errno;
		return refuse(err, path, strerror(-err), why, size);
	}
	err = take(fd, credential, path, token, why, size);
	close(fd);
	return err;
}
