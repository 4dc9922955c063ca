/* SPDX-License-Identifier: MIT */
/* Finds and reads secrets, and refuses those that others may have read. */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "src/faces/kit/arguments.h"
#include "src/faces/kit/secret.h"
#include "src/ground/signal/hash.h"

#define BLANK " \t\r\n"
#define NO_CREDENTIAL \
	"the service has no such credential: a file in /etc/credstore, LoadCredential= in its unit"

static int secret_refuse(int err, const char *path, const char *reason, char *why, size_t size)
{
	snprintf(why, size, "%s: %s", path, reason);
	return err;
}

/* Cut what stands around the token, and look at its letters: a password may have blanks in it. */
static bool trim_token(char *text)
{
	size_t begin = strspn(text, BLANK), len = strlen(text + begin);

	while (len && strchr(BLANK, text[begin + len - 1]))
		len--;
	memmove(text, text + begin, len);
	text[len] = '\0';
	if (!len)
		return false;
	for (const char *c = text; *c; c++)
		if ((unsigned char)*c < ' ' || *c == 127)
			return false;
	return true;
}

/* What it names: a path, or a credential, which the service manager keeps from others. */
static int secret_path(const char *name, char path[SECRET_PATH], char *why, size_t size)
{
	const char *directory = getenv("CREDENTIALS_DIRECTORY");
	bool credential = name[0] != '/';

	if (credential && !directory)
		return secret_refuse(-ENOENT, name, NO_CREDENTIAL, why, size);
	if (snprintf(path, SECRET_PATH, "%s%s%s", credential ? directory : "",
	             credential ? "/" : "", name) >= SECRET_PATH)
		return secret_refuse(-ENAMETOOLONG, name, strerror(ENAMETOOLONG), why, size);
	return 0;
}

/* Open the secret, if it is a file that no other user may read. Returns a descriptor. */
static int open_own(const char *name, char path[SECRET_PATH], char *why, size_t size)
{
	int err = secret_path(name, path, why, size), fd;
	struct stat st;

	if (err)
		return err;
	fd = open(path, O_RDONLY | O_CLOEXEC | O_NOCTTY | O_NONBLOCK);
	if (fd < 0) {
		bool missing = errno == ENOENT && name[0] != '/';

		err = -errno;
		return secret_refuse(err, missing ? name : path,
		                     missing ? NO_CREDENTIAL : strerror(-err), why, size);
	}
	if (fstat(fd, &st) < 0 || !S_ISREG(st.st_mode))
		err = secret_refuse(-EINVAL, path, "is no file", why, size);
	else if (name[0] == '/' && (st.st_mode & 077))
		err = secret_refuse(-EPERM, path, "others may read it: chmod 600", why, size);
	if (err)
		close(fd);
	return err ? err : fd;
}

int secret_file(const char *name, bool own, char path[SECRET_PATH], char *why, size_t size)
{
	int fd, err;

	if (own) {
		fd = open_own(name, path, why, size);
		if (fd >= 0)
			close(fd);
		return fd < 0 ? fd : 0;
	}
	err = secret_path(name, path, why, size);
	if (!err && access(path, R_OK)) {
		err = -errno;
		secret_refuse(err, path, strerror(-err), why, size);
	}
	return err;
}

int secret_read(const char *name, char token[SECRET_SIZE], char *why, size_t size)
{
	char path[SECRET_PATH];
	ssize_t n;
	int fd;

	token[0] = why[0] = '\0';
	if (!name)
		return 0;
	fd = open_own(name, path, why, size);
	if (fd < 0)
		return fd;
	n = read(fd, token, SECRET_SIZE - 1);
	close(fd);
	token[n > 0 ? n : 0] = '\0';
	if (n < 0)
		return secret_refuse(-errno, path, strerror(errno), why, size);
	if (n == SECRET_SIZE - 1 || !trim_token(token)) {
		token[0] = '\0';
		return secret_refuse(-EINVAL, path, "expected one token in one line", why, size);
	}
	return 0;
}

int secret_check(const char *program, const char *key, const char *name, enum secret_kind kind)
{
	char token[SECRET_SIZE], path[SECRET_PATH], why[SECRET_PATH + 128];
	int err;

	if (!name || !*name)
		return 0;
	if (name[0] != '/' && !getenv("CREDENTIALS_DIRECTORY")) {
		face_complain(program, "%s: the service alone sees its credential %s: not checked",
		              key, name);
		return 0;
	}
	err = kind == SECRET_TOKEN ? secret_read(name, token, why, sizeof(why))
	                           : secret_file(name, kind == SECRET_KEY, path, why, sizeof(why));
	if (err == -EACCES)
		face_complain(program, "%s: %s: not checked; try as its owner, or as root", key,
		              why);
	else if (err)
		face_complain(program, "%s: %s%s", key, why,
		              err == -ENOENT && name[0] == '/' ? "; make it, or name another" : "");
	return err == -EACCES ? 0 : err;
}

bool secret_is_news(const char *why, uint64_t *print)
{
	uint64_t before = *print;

	*print = *why ? hash_text(HASH_BEGIN, why, strlen(why)) : 0;
	return *print && *print != before;
}
