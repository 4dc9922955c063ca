/* SPDX-License-Identifier: MIT */
/* Which serial port a target means, also after it was pulled and came back under another name. */
#include <dirent.h>
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "hal/base/rivals.h"
#include "hal/serial/find.h"
#include "hal/serial/tty.h"

/* Names below it stay; of two adapters without a serial number those by-path alone are two. */
#define STAYS "/dev/serial/"

struct place {
	const char *by_id;
	char *where;
	/* its name below by_id, as soon as it was seen; "": none, or where is a name that stays */
	char known[PATH_MAX];
};

/*
 * The name below by_id that leads to this device; of "" the only one that is there. Returns how
 * many there are.
 */
static unsigned look(const char *by_id, const char *device, char *name, size_t size)
{
	DIR *dir = opendir(by_id);
	struct stat want, st;
	unsigned count = 0;

	if (*device && stat(device, &want))
		memset(&want, 0, sizeof(want));
	for (struct dirent *entry; dir && (entry = readdir(dir));) {
		char path[PATH_MAX];

		if (entry->d_name[0] == '.')
			continue;
		snprintf(path, sizeof(path), "%s/%s", by_id, entry->d_name);
		if (stat(path, &st) || !S_ISCHR(st.st_mode) ||
		    (*device && st.st_rdev != want.st_rdev))
			continue;
		if (count++ == 0)
			snprintf(name, size, "%s", path);
	}
	if (dir)
		closedir(dir);
	return count;
}

/*
 * Its name now: as it is known, else as it was given. "": there is none, or there are several. One
 * that is known and away is waited for: what has its number meanwhile is another device.
 */
static unsigned find(struct place *place, char *path, size_t size)
{
	unsigned count = 1;

	path[0] = '\0';
	if (place->known[0])
		snprintf(path, size, "%s", place->known);
	else if (place->where[0])
		snprintf(path, size, "%s", place->where);
	else
		count = look(place->by_id, "", path, size);
	return count;
}

static int explain(int err, const char *path, int holder, char *why, size_t size)
{
	char who[RIVALS_TEXT];

	switch (err) {
	case -ENOENT:
	case -ENXIO:
	case -ENODEV:
		snprintf(why, size, "no %s: is the adapter plugged in? ls " SERIAL_BY_ID, path);
		return -ENODEV;
	case -EACCES:
	case -EPERM:
		snprintf(why, size,
		         "no permission for %s: the user has to be in the group that owns it "
		         "(dialout)",
		         path);
		return -EACCES;
	case -EADDRINUSE:
		rivals_name(RIVALS_PROC, holder, who, sizeof(who));
		snprintf(why, size, "%s is in use by %s", path, who);
		return -EBUSY;
	case -EBUSY:
		if (!rivals_find(RIVALS_PROC, path, who, sizeof(who)))
			snprintf(who, sizeof(who), "another program");
		snprintf(why, size, "%s is in use by %s", path, who);
		return err;
	case -ENOTTY:
		snprintf(why, size, "%s is no serial port", path);
		return err;
	default:
		snprintf(why, size, "%s: %s", path, strerror(-err));
		return err;
	}
}

static int open_place(void *ctx, const struct bus_env *env, struct serial_port **port, char *name,
                      size_t name_size, char *why, size_t why_size)
{
	struct place *place = ctx;
	char path[PATH_MAX];
	unsigned count = find(place, path, sizeof(path));
	int holder;

	if (count == 0) {
		snprintf(why, why_size, "no serial port in %s: is the adapter plugged in?",
		         place->by_id);
		return -ENODEV;
	}
	if (count > 1) {
		snprintf(why, why_size, "there are %u serial ports in %s: name the adapter's",
		         count, place->by_id);
		return -EINVAL;
	}
	if ((size_t)snprintf(name, name_size, "%s", path) >= name_size) {
		snprintf(why, why_size, "the name of the port is longer than %zu characters",
		         name_size - 1);
		return -ENAMETOOLONG;
	}
	int err = tty_open(path, env, port, &holder);

	if (err)
		return explain(err, path, holder, why, why_size);
	if (!place->known[0] && strncmp(place->where, STAYS, strlen(STAYS)) != 0)
		look(place->by_id, path, place->known, sizeof(place->known));
	return 0;
}

static int is_there(void *ctx, uint64_t *mark)
{
	char path[PATH_MAX];
	struct stat st;

	if (find(ctx, path, sizeof(path)) != 1 || stat(path, &st))
		return 0;
	*mark = (uint64_t)st.st_rdev << 32 ^ (uint64_t)st.st_ino ^ (uint64_t)st.st_ctime;
	return 1;
}

static void forget(void *ctx)
{
	free(((struct place *)ctx)->where);
	free(ctx);
}

int tty_source(const char *where, const char *by_id, struct serial_source *source, char *why,
               size_t why_size)
{
	struct place *place;

	if (*where && *where != '/') {
		snprintf(why, why_size, "\"%s\": expected a device, as /dev/ttyUSB0", where);
		return -EINVAL;
	}
	place = calloc(1, sizeof(*place));
	if (place)
		place->where = strdup(where);
	if (!place || !place->where) {
		free(place);
		return -ENOMEM;
	}
	place->by_id = by_id;
	*source = (struct serial_source){.open = open_place,
	                                 .visible = is_there,
	                                 .destroy = forget,
	                                 .ctx = place,
	                                 .proc = RIVALS_PROC};
	return 0;
}
