/* SPDX-License-Identifier: MIT */
/* What survives an end of owsd-notify. */
#include <errno.h>
#include <inttypes.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "hal/base/time.h"
#include "src/faces/notify/kept.h"

static int lock(struct kept *kept)
{
	char directory[sizeof(kept->path)];

	if (kept->lock >= 0)
		return 0;
	memcpy(directory, kept->path, sizeof(directory));
	*strrchr(directory, '/') = '\0';
	kept->lock = history_lock(directory);
	return kept->lock == -EBUSY ? kept->lock : 0;
}

int kept_open(struct kept *kept, struct log *log, const char *program, const char *instance,
              int64_t now_ns, int64_t *told_ns, int64_t *looked_ns)
{
	char directory[HISTORY_PATH];
	int64_t boot, told = 0, looked = 0;
	bool here = false;
	FILE *in;

	*kept = (struct kept){.boot = history_boot_present(), .lock = -1};
	if (history_place_state(program, "notify", instance, directory))
		return 0;
	snprintf(kept->path, sizeof(kept->path), "%s/told", directory);
	history_make_above(kept->path);
	if (lock(kept))
		return -EBUSY;
	in = fopen(kept->path, "re");
	if (!in && errno == ENOENT)
		return 0;
	/* NOLINTNEXTLINE(cert-err34-c): its own */
	if (in && fscanf(in, "%" SCNd64 " %" SCNd64 " %" SCNd64, &boot, &told, &looked) == 3)
		here = boot == kept->boot && told <= now_ns && looked <= now_ns;
	else
		log_warning(log, "%s: %s; alarms may be told again", kept->path,
		            !in || ferror(in) ? strerror(errno) : "it is damaged");
	*told_ns = here ? told : 0;
	*looked_ns = here ? looked : 0;
	if (in)
		fclose(in);
	return 0;
}

void kept_write(struct kept *kept, struct log *log, int64_t told_ns, int64_t looked_ns,
                int64_t now_ns)
{
	char fresh[sizeof(kept->path) + 4];
	FILE *out;
	int err;

	if (!*kept->path || (kept->at_ns && now_ns - kept->at_ns < NS_PER_S) ||
	    (told_ns == kept->told_ns && looked_ns == kept->looked_ns))
		return;
	kept->at_ns = now_ns;
	snprintf(fresh, sizeof(fresh), "%s.new", kept->path);
	err = lock(kept);
	out = err ? NULL : fopen(fresh, "we");
	if (out)
		fprintf(out, "%" PRId64 " %" PRId64 " %" PRId64 "\n", kept->boot, told_ns,
		        looked_ns);
	if (!err && (!out || fclose(out) || rename(fresh, kept->path)))
		err = -errno;
	if (err) {
		log_err(log, "%s: %s; after a restart alarms may be told again", kept->path,
		        strerror(-err));
		kept->at_ns = now_ns + 3600 * NS_PER_S;
		return;
	}
	kept->told_ns = told_ns;
	kept->looked_ns = looked_ns;
}

void kept_close(struct kept *kept)
{
	if (kept->lock >= 0)
		close(kept->lock);
	kept->lock = -1;
}
