/* SPDX-License-Identifier: MIT */
/* Writes the report of a face. */
#include "src/face/report.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include "hal/bus/time.h"

void report_open(struct face *face)
{
	const char *own = getenv("RUNTIME_DIRECTORY"), *all = getenv("OWS_DIR");
	size_t size = sizeof(face->report);
	int len = 0;

	if (own && *own == '/')
		len = snprintf(face->report, size, "%s/status", own);
	else if (all && *all == '/')
		len = snprintf(face->report, size, "%s/%s.%s", all, face->arguments->instance,
		               face->ops->program);
	if (len >= (int)size)
		face->report[0] = '\0';
}

void report_write(struct face *face, int64_t now_ns)
{
	char fresh[sizeof(face->report) + 4];
	FILE *out;
	int fd;

	if (!*face->report || now_ns < face->report_ns)
		return;
	face->report_ns = now_ns + REPORT_NS;
	snprintf(fresh, sizeof(fresh), "%s.new", face->report);
	unlink(fresh);
	fd = open(fresh, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0640);
	out = fd < 0 ? NULL : fdopen(fd, "w");
	if (!out) {
		if (fd >= 0)
			close(fd);
		return;
	}
	/* the umask of a service may keep the group out, which may read the signals */
	fchmod(fd, 0640);
	fprintf(out, "pid %ld\nbeat %lld\nstatus %s\n", (long)getpid(), (long long)now_ns,
	        face->status);
	if (face->ops->report)
		face->ops->report(face, out);
	if (fclose(out) || rename(fresh, face->report))
		unlink(fresh);
}

void report_remove(const struct face *face)
{
	if (*face->report)
		unlink(face->report);
}
