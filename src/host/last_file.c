/* SPDX-License-Identifier: MIT */
/* Reads and writes NAME.last, and finds its directory. */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "src/host/last_file.h"
#include "src/shm/layout.h"
#include "src/shm/owner.h"
#include "src/shm/place.h"

#define SERVICE_STATE "/var/lib/owsd"
#define HEAD "owsd last 1\n"
#define CHECK "check "
#define CHECK_LEN (sizeof(CHECK) - 1 + 8 + 1)
#define FILE_MAX ((size_t)64 << 20)
#define NAME_MAX_ 64

/* --- The directory ---------------------------------------------------------------------------- */

static int make_way(const char *base, const char *const *parts, unsigned count, char *path)
{
	int n = snprintf(path, LAST_WHERE, "%s", base);

	for (unsigned i = 0; i < count && n > 0 && n < LAST_WHERE; i++) {
		n += snprintf(path + n, (size_t)(LAST_WHERE - n), "/%s", parts[i]);
		if (n < LAST_WHERE && mkdir(path, 0700) < 0 && errno != EEXIST)
			return -errno;
	}
	return n > 0 && n < LAST_WHERE ? 0 : -ENAMETOOLONG;
}

static int find_directory(char *path)
{
	static const char *const below_home[] = {".local", "state", "owsd"};
	const char *named = getenv("OWS_STATE_DIR"), *state = getenv("XDG_STATE_HOME");
	const char *home = getenv("HOME");

	if (named && *named)
		return make_way(named, NULL, 0, path);
	if (geteuid() == 0 || owner_is_service())
		return make_way(SERVICE_STATE, NULL, 0, path);
	if (state && *state == '/')
		return make_way(state, &below_home[2], 1, path);
	return home && *home == '/' ? make_way(home, below_home, 3, path) : -ENOENT;
}

int last_directory(char path[LAST_WHERE])
{
	struct shm_place directory = {.fd = -1};
	int err = find_directory(path);

	if (!err && mkdir(path, 0700) < 0 && errno != EEXIST)
		err = -errno;
	if (!err)
		err = place_open(path, &directory);
	return err ? err : directory.fd;
}

/* --- Fields: control characters and '\' are written as \xHH ----------------------------------- */

static void put_field(FILE *out, const char *text, size_t len, char end)
{
	for (size_t i = 0; i < len; i++) {
		unsigned char c = (unsigned char)text[i];

		if (c < 0x20 || c == 0x7f || c == '\\')
			fprintf(out, "\\x%02x", c);
		else
			fputc(c, out);
	}
	fputc(end, out);
}

static int hex_digit(char c)
{
	if (c >= '0' && c <= '9')
		return c - '0';
	return c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
}

/* Decode a field in place up to the end character. Returns its length, -1: there is none. */
static long take_field(char **at, const char *limit, char end, char **field)
{
	char *from = *at, *to = from;

	*field = to;
	while (from < limit && *from != end) {
		int high, low;

		if (*from == '\n' || *from == '\t')
			return -1;
		if (*from != '\\') {
			*to++ = *from++;
			continue;
		}
		if (limit - from < 4 || from[1] != 'x')
			return -1;
		high = hex_digit(from[2]);
		low = hex_digit(from[3]);
		if (high < 0 || low < 0)
			return -1;
		*to++ = (char)(high * 16 + low);
		from += 4;
	}
	if (from >= limit)
		return -1;
	*at = from + 1;
	return to - *field;
}

/* --- Reading ---------------------------------------------------------------------------------- */

struct line {
	char *name, *path, *value;
	int type;
	long len; /* of value */
};

/* The four fields of a line; each is ended by NUL after that. False: it is damaged. */
static bool take_line(char **at, const char *limit, struct line *line)
{
	char *type;
	long name, path, kind;

	name = take_field(at, limit, '\t', &line->name);
	path = name < 0 ? -1 : take_field(at, limit, '\t', &line->path);
	kind = path < 0 ? -1 : take_field(at, limit, '\t', &type);
	line->len = kind < 0 ? -1 : take_field(at, limit, '\n', &line->value);
	if (line->len < 0)
		return false;
	line->name[name] = line->path[path] = type[kind] = line->value[line->len] = '\0';
	line->type = value_type_parse(type);
	return line->type >= 0;
}

static int compare_lines(const void *a, const void *b)
{
	const struct line *x = a, *y = b;
	int order = strcmp(x->name, y->name);

	if (!order)
		order = strcmp(x->path, y->path);
	return order ? order : x->type - y->type;
}

static void fill_entry(struct last_entry *e, const struct line *lines, size_t count)
{
	struct line key = {.name = (char *)(uintptr_t)e->item->name,
	                   .path = (char *)(uintptr_t)e->item->path,
	                   .type = (int)e->item->type};
	const struct line *found = NULL;

	if (count)
		found = bsearch(&key, lines, count, sizeof(key), compare_lines);
	if (!found)
		return;
	if (!e->text) {
		e->known = value_parse(e->item->type, found->value, &e->value) == 0;
	} else if (found->len <= VALUE_STRING_MAX) {
		memcpy(e->text, found->value, (size_t)found->len);
		e->len = (uint32_t)found->len;
		e->known = true;
	}
}

static int take_file(char *text, size_t size, struct last_entry *entries, uint32_t count)
{
	size_t body = size < CHECK_LEN ? 0 : size - CHECK_LEN, n = 0, room = 0;
	char check[CHECK_LEN + 1], *at = text + sizeof(HEAD) - 1;
	struct line *lines;
	int err = 0;

	snprintf(check, sizeof(check), CHECK "%08x\n", ows_check_bytes(text, body));
	if (body < sizeof(HEAD) - 1 || memcmp(text, HEAD, sizeof(HEAD) - 1) != 0 ||
	    memcmp(text + body, check, CHECK_LEN) != 0)
		return -EBADMSG;
	for (const char *c = at; c < text + body; c++)
		room += *c == '\n';
	lines = calloc(room + 1, sizeof(*lines));
	if (!lines)
		return -ENOMEM;
	while (!err && at < text + body)
		err = n < room && take_line(&at, text + body, &lines[n++]) ? 0 : -EBADMSG;
	if (!err)
		qsort(lines, n, sizeof(*lines), compare_lines);
	for (uint32_t i = 0; !err && i < count; i++)
		fill_entry(&entries[i], lines, n);
	free(lines);
	return err;
}

static int load_file(int directory, const char *name, char **text, size_t *size)
{
	int fd = openat(directory, name, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
	struct stat st;
	int err = 0;

	*size = 0;
	*text = NULL;
	if (fd < 0)
		return -errno;
	if (fstat(fd, &st) < 0)
		err = -errno;
	else if (!S_ISREG(st.st_mode) || (uint64_t)st.st_size > FILE_MAX)
		err = -EBADMSG;
	*text = err ? NULL : malloc((size_t)st.st_size + 1);
	if (!err && !*text)
		err = -ENOMEM;
	while (!err && *size < (size_t)st.st_size) {
		ssize_t got = read(fd, *text + *size, (size_t)st.st_size - *size);

		if (got <= 0)
			err = got < 0 ? -errno : -EBADMSG;
		else
			*size += (size_t)got;
	}
	close(fd);
	if (err) {
		free(*text);
		*text = NULL;
	}
	return err;
}

int last_read(int directory, const char *instance, struct last_entry *entries, uint32_t count)
{
	char name[NAME_MAX_], *text;
	size_t size;
	int err;

	snprintf(name, sizeof(name), "%s.last", instance);
	err = load_file(directory, name, &text, &size);
	if (err)
		return err == -ENOENT ? 0 : err;
	err = take_file(text, size, entries, count);
	free(text);
	return err;
}

/* --- Writing ---------------------------------------------------------------------------------- */

static void put_entry(FILE *out, const struct last_entry *e)
{
	const char *type = value_type_name(e->item->type);
	char number[VALUE_TEXT_MAX];

	put_field(out, e->item->name, strlen(e->item->name), '\t');
	put_field(out, e->item->path, strlen(e->item->path), '\t');
	put_field(out, type, strlen(type), '\t');
	if (e->text) {
		put_field(out, e->text, e->len, '\n');
	} else {
		value_to_text(e->item->type, e->value, number);
		put_field(out, number, strlen(number), '\n');
	}
}

/* The whole file in memory; NULL: there is none left. */
static char *make_text(const struct last_entry *entries, uint32_t count, size_t *size)
{
	char *text = NULL;
	FILE *out = open_memstream(&text, size);
	bool failed;

	if (!out)
		return NULL;
	fputs(HEAD, out);
	for (uint32_t i = 0; i < count; i++)
		if (entries[i].known)
			put_entry(out, &entries[i]);
	failed = fflush(out) != 0;
	if (!failed)
		fprintf(out, CHECK "%08x\n", ows_check_bytes(text, *size));
	failed |= ferror(out) != 0;
	failed |= fclose(out) != 0;
	if (!failed)
		return text;
	free(text);
	return NULL;
}

static int write_all(int fd, const char *text, size_t size)
{
	while (size) {
		ssize_t n = write(fd, text, size);

		if (n < 0 && errno != EINTR)
			return -errno;
		if (n == 0)
			return -EIO;
		if (n > 0) {
			text += n;
			size -= (size_t)n;
		}
	}
	return fsync(fd) < 0 ? -errno : 0;
}

int last_write(int directory, const char *instance, const struct last_entry *entries,
               uint32_t count)
{
	char name[NAME_MAX_], fresh[NAME_MAX_ + 4];
	size_t size;
	char *text = make_text(entries, count, &size);
	int fd, err;

	if (!text)
		return -ENOMEM;
	snprintf(name, sizeof(name), "%s.last", instance);
	snprintf(fresh, sizeof(fresh), "%s.new", name);
	unlinkat(directory, fresh, 0);
	fd = openat(directory, fresh, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600);
	err = fd < 0 ? -errno : write_all(fd, text, size);
	if (fd >= 0 && close(fd) < 0 && !err)
		err = -errno;
	if (!err && renameat(directory, fresh, directory, name) < 0)
		err = -errno;
	if (!err && fsync(directory) < 0)
		err = -errno;
	if (err && fd >= 0)
		unlinkat(directory, fresh, 0);
	free(text);
	return err;
}
