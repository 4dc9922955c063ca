/* SPDX-License-Identifier: MIT */
/*
 * The alarms that this user's owsctl has read. Each run of owsctl is a new reader to libows, but
 * not to its user: what it has read of _Alarm stands in the file NAME.seen until the next run, in
 * the place of the user's own owsd, where nobody else can write.
 *
 *     START              of owsd, in nanoseconds: what another owsd counted means nothing
 *     OCCURRENCES NAME   of each signal whose _Alarm was read
 */
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "src/owsctl/seen.h"
#include "src/shm/segment.h"
#include "src/show/names.h"

#define TEXT_MAX (1024 * 1024)

/* Open and lock the file, which belongs to this user alone; -1: it is not available now. */
static int open_file(const char *instance)
{
	char name[SEGMENT_FILE];
	struct shm_place place;
	struct stat st;
	int fd;

	if (place_make(&place))
		return -1;
	fd = openat(place.fd, segment_file(instance, "seen", name),
	            O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0600);
	place_close(&place);
	if (fd < 0)
		return -1;
	if (fstat(fd, &st) == 0 && S_ISREG(st.st_mode) && st.st_uid == geteuid() &&
	    st.st_size <= TEXT_MAX && flock(fd, LOCK_EX | LOCK_NB) == 0)
		return fd;
	close(fd);
	return -1;
}

static char *load(int fd)
{
	char *text = calloc(1, TEXT_MAX + 1);
	ssize_t n = text ? pread(fd, text, TEXT_MAX, 0) : -1;

	if (n >= 0)
		return text;
	free(text);
	return NULL;
}

/* Write the lines of text without that of the signal, and the signal's new line. True: written. */
static bool store(int fd, char *text, int64_t start_ns, const char *signal, uint32_t occurrences)
{
	FILE *out = fdopen(dup(fd), "r+");
	char *rest;
	bool ok;

	if (!out)
		return false;
	ok = ftruncate(fd, 0) == 0 && fprintf(out, "%" PRId64 "\n", start_ns) > 0;
	for (char *line = strtok_r(text, "\n", &rest); line; line = strtok_r(NULL, "\n", &rest)) {
		const char *name = strchr(line, ' ');

		if (name && strcmp(name + 1, signal) != 0)
			ok &= fprintf(out, "%s\n", line) > 0;
	}
	ok &= fprintf(out, "%" PRIu32 " %s\n", occurrences, signal) > 0;
	return fclose(out) == 0 && ok;
}

/* Read the number that text has for the signal, if this owsd's START is in it. */
static bool has_seen(const char *text, int64_t start_ns, const char *signal, uint32_t *occurrences)
{
	char *end;

	if (strtoll(text, &end, 10) != start_ns)
		return false;
	while (*end == '\n' && end[1]) {
		unsigned long count = strtoul(end + 1, &end, 10);
		size_t len = strcspn(end, "\n");

		if (len == strlen(signal) + 1 && memcmp(end + 1, signal, len - 1) == 0) {
			*occurrences = (uint32_t)count;
			return true;
		}
		end += len;
	}
	return false;
}

static bool is_news(const char *instance, int64_t start_ns, const char *signal,
                    uint32_t occurrences)
{
	int fd = open_file(instance);
	uint32_t seen = 0;
	char *text = fd < 0 ? NULL : load(fd);
	bool news = true;

	if (text && has_seen(text, start_ns, signal, &seen) && seen == occurrences)
		news = false;
	else if (text) {
		if (strtoll(text, NULL, 10) != start_ns)
			text[0] = '\0';
		store(fd, text, start_ns, signal, occurrences);
	}
	free(text);
	if (fd >= 0)
		close(fd);
	return news;
}

void seen_alarm(const struct ctl *ctl, struct ows *h, const char *name, int id,
                struct reading *reading)
{
	static const char suffix[] = "_Alarm";
	size_t len = strlen(name);
	struct ows_alarm_state alarms;
	struct ows_daemon daemon;
	enum attribute attribute;
	struct ows_info info;
	int signal;

	if (len < sizeof(suffix) || strcmp(name + len - sizeof(suffix) + 1, suffix) != 0 ||
	    !reading_good(reading) || !reading->value.integer)
		return;
	if (names_lookup(h, ctl->instance, name, &signal, &attribute) || attribute != ATTR_ALARM ||
	    ows_info(h, signal, &info) || ows_alarm_state(h, id, &alarms) ||
	    ows_daemon(h, ows_now(), &daemon))
		return;
	if (is_news(ctl->instance, daemon.start_ns, info.name, alarms.occurrences))
		return;
	reading->value.integer = 0;
	reading->value.number = 0;
	reading->len = (size_t)snprintf(reading->text, sizeof(reading->text), "0");
}
