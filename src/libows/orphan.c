/* SPDX-License-Identifier: MIT */
/*
 * The segments of an owsd that was killed after their names were removed: the next one makes others,
 * and cannot reach these to say so.
 */
#include <errno.h>
#include <sys/stat.h>

#include "src/libows/handle.h"

/* A name that is gone leads nowhere yet: the next owsd makes it. */
static bool leads_elsewhere(const struct ows *h, const char *kind, const struct ows_file *file)
{
	char path[MAP_PATH];
	struct stat st;

	map_path(h->instance, kind, path);
	return lstat(path, &st) == 0 && (st.st_ino != file->inode || st.st_dev != file->device);
}

bool orphan_look(struct ows *h, int64_t now_ns)
{
	int saved = errno;

	if (now_ns >= h->looked_ns && handle_age(now_ns, h->looked_ns) < ORPHAN_LOOK_NS)
		return h->orphan;
	h->looked_ns = now_ns;
	h->orphan = leads_elsewhere(h, "image", &h->map.image_file) ||
	            (h->map.command != NULL && leads_elsewhere(h, "command", &h->map.command_file));
	errno = saved;
	return h->orphan;
}

int handle_orphan(struct ows *h, int64_t now_ns)
{
	if (now_ns < h->alive_now || handle_age(now_ns, h->alive_now) >= ORPHAN_LOOK_NS)
		handle_alive(h, now_ns);
	return h->orphan ? -ESTALE : 0;
}
