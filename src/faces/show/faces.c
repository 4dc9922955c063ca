/* SPDX-License-Identifier: MIT */
/* Reads the reports of faces. */
#include "src/faces/show/faces.h"

#include <fcntl.h>
#include <glob.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "hal/base/time.h"
#include "src/ground/text/printable.h"

#define SILENT_NS (20 * NS_PER_S)
#define LINES_MOST 64

/* What stands after a word at the beginning of a line; NULL: it begins otherwise. */
static const char *after(const char *line, const char *word)
{
	size_t len = strlen(word);

	return strncmp(line, word, len) == 0 ? line + len : NULL;
}

static int64_t positive(const char *text)
{
	long long n = strtoll(text, NULL, 10);

	return n > 0 ? n : 0;
}

static void take_report_line(struct faces_one *face, const char *line)
{
	struct faces_counter *counter = &face->counters[face->count];
	const char *rest;

	if ((rest = after(line, "status ")))
		snprintf(face->status, sizeof(face->status), "%.255s", rest);
	else if ((rest = after(line, "trouble ")))
		snprintf(face->trouble, sizeof(face->trouble), "%.255s", rest);
	else if ((rest = after(line, "troubled ")))
		face->trouble_ns = positive(rest);
	else if ((rest = after(line, "refused ")))
		snprintf(face->refused, sizeof(face->refused), "%.255s", rest);
	else if ((rest = after(line, "loaded ")))
		face->loaded_ns = positive(rest);
	else if ((rest = after(line, "pid ")))
		face->pid = (long)(positive(rest) & INT32_MAX);
	else if ((rest = after(line, "beat ")))
		face->beat_ns = positive(rest);
	else if ((rest = after(line, "since ")))
		face->since_ns = positive(rest);
	else if (face->count < FACES_COUNTERS && /* NOLINTNEXTLINE(cert-err34-c): owsd's own */
	         sscanf(line, "count %31s %" SCNu64, counter->name, &counter->value) == 2)
		face->count++;
}

/* False: it cannot be read, or is no report. */
static bool read_report(const char *path, const char *program, struct faces_one *face)
{
	/* a face may have been taken over, and its reader has more rights */
	int fd = open(path, O_RDONLY | O_NONBLOCK | O_NOFOLLOW | O_NOCTTY | O_CLOEXEC);
	struct stat st;
	FILE *in = fd >= 0 && !fstat(fd, &st) && S_ISREG(st.st_mode) ? fdopen(fd, "r") : NULL;
	char line[512];

	if (!in) {
		if (fd >= 0)
			close(fd);
		return false;
	}
	*face = (struct faces_one){0};
	snprintf(face->program, sizeof(face->program), "%.*s", (int)strcspn(program, "/"), program);
	face->program[printable(face->program, strlen(face->program))] = '\0';
	for (unsigned i = 0; i < LINES_MOST && fgets(line, sizeof(line), in); i++) {
		line[strcspn(line, "\n")] = '\0';
		line[printable(line, strlen(line))] = '\0';
		take_report_line(face, line);
	}
	fclose(in);
	return face->beat_ns > 0;
}

unsigned faces_read(const char *instance, struct faces_one faces[FACES_MOST])
{
	const char *all = getenv("OWS_DIR");
	bool own = all && *all == '/';
	char pattern[512];
	unsigned count = 0;
	glob_t found;

	if (own)
		snprintf(pattern, sizeof(pattern), "%s/%s.owsd-*[!w]", all, instance);
	else
		snprintf(pattern, sizeof(pattern), "/run/owsd-*/%s/status", instance);
	if (glob(pattern, 0, NULL, &found))
		return 0;
	for (size_t i = 0; i < found.gl_pathc && count < FACES_MOST; i++) {
		const char *path = found.gl_pathv[i], *end = strrchr(path, '.');

		count += read_report(path, own && end ? end + 1 : path + strlen("/run/"),
		                     &faces[count]);
	}
	globfree(&found);
	return count;
}

bool faces_silent(const struct faces_one *face, int64_t now_ns)
{
	return now_ns - face->beat_ns > SILENT_NS;
}

void faces_json(struct json *json, const char *key, const char *instance, const struct when *now)
{
	struct faces_one faces[FACES_MOST];
	unsigned count = faces_read(instance, faces);
	char text[WHEN_TEXT];

	json_array(json, key);
	for (unsigned i = 0; i < count; i++) {
		const struct faces_one *face = &faces[i];

		json_object(json, NULL);
		json_string(json, "program", face->program);
		json_int(json, "pid", face->pid);
		json_bool(json, "alive", !faces_silent(face, now->boot));
		json_seconds(json, "age", now->boot - face->beat_ns);
		json_string(json, "status", face->status);
		json_string(json, "connected",
		            face->since_ns ? when_iso(now, face->since_ns, text) : NULL);
		json_string(json, "trouble", *face->trouble ? face->trouble : NULL);
		if (face->trouble_ns)
			json_seconds(json, "trouble_age", now->boot - face->trouble_ns);
		json_string(json, "refused", *face->refused ? face->refused : NULL);
		json_object(json, "counters");
		for (unsigned k = 0; k < face->count; k++)
			json_uint(json, face->counters[k].name, face->counters[k].value);
		json_object_end(json);
		json_object_end(json);
	}
	json_array_end(json);
}
