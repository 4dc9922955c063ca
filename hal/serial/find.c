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

/* Folders of names that stay. The first one says what a port is, the second one where. */
static const char *const folders[] = {"by-id", "by-path"};
enum { BY_ID, BY_PATH, NAMES };

struct place {
	const char *names;
	char *where;
	char known[PATH_MAX];       /* a name that stays, as soon as it was seen; "": none */
	char last[NAMES][PATH_MAX]; /* the names of the port as it was opened last */
};

/* The next serial port of an open folder. */
static bool next_port(DIR *dir, const char *names, unsigned folder, char path[PATH_MAX],
                      struct stat *st)
{
	for (struct dirent *entry; dir && (entry = readdir(dir));) {
		snprintf(path, PATH_MAX, "%s/%s/%s", names, folders[folder], entry->d_name);
		if (entry->d_name[0] != '.' && !stat(path, st) && S_ISCHR(st->st_mode))
			return true;
	}
	return false;
}

static DIR *open_folder(const char *names, unsigned folder)
{
	char path[PATH_MAX];

	snprintf(path, sizeof(path), "%s/%s", names, folders[folder]);
	return opendir(path);
}

/*
 * The name in a folder that leads to this device; of "" the only one that is there. Returns how
 * many there are.
 */
static unsigned look(const char *names, unsigned folder, const char *device, char name[PATH_MAX])
{
	DIR *dir = open_folder(names, folder);
	char path[PATH_MAX];
	struct stat want, st;
	unsigned count = 0;

	if (*device && stat(device, &want))
		memset(&want, 0, sizeof(want));
	while (next_port(dir, names, folder, path, &st))
		if ((!*device || st.st_rdev == want.st_rdev) && count++ == 0)
			snprintf(name, PATH_MAX, "%s", path);
	if (dir)
		closedir(dir);
	return count;
}

bool tty_only(const char *names, char *path, size_t size)
{
	char name[PATH_MAX];

	return look(names, BY_ID, "", name) == 1 && (size_t)snprintf(path, size, "%s", name) < size;
}

/* Of adapters without a serial number that are the same only one has the name of what it is. */
static bool are_some_equal(const char *names)
{
	DIR *dir = open_folder(names, BY_PATH);
	char path[PATH_MAX], name[PATH_MAX];
	bool some = false;
	struct stat st;

	while (!some && next_port(dir, names, BY_PATH, path, &st))
		some = strstr(path, "usb") && !look(names, BY_ID, path, name);
	if (dir)
		closedir(dir);
	return some;
}

/*
 * Its name now: as it is known, else as it was given. "": there is none, or there are several. One
 * that is known and away is waited for: what has its number meanwhile is another device.
 */
static unsigned find(struct place *place, char path[PATH_MAX])
{
	unsigned count = 1;

	path[0] = '\0';
	if (place->known[0])
		snprintf(path, PATH_MAX, "%s", place->known);
	else if (place->where[0])
		snprintf(path, PATH_MAX, "%s", place->where);
	else
		count = look(place->names, BY_ID, "", path) + are_some_equal(place->names);
	return count;
}

/* The port was opened: what it is called, and whether it is the one that it was. */
static void know(struct place *place, const struct bus_env *env, const char *path)
{
	char text[BUS_EVENT_TEXT], is[PATH_MAX];

	for (unsigned i = 0; i < NAMES; i++) {
		char *was = place->last[i];

		if (!look(place->names, i, path, is))
			continue;
		if (*was && strcmp(was, is) != 0) {
			snprintf(text, sizeof(text),
			         "the port is %.76s now, %.76s before: the same adapter?",
			         strrchr(is, '/') + 1, strrchr(was, '/') + 1);
			bus_report(env, BUS_NOTE, 0, text);
		}
		snprintf(was, PATH_MAX, "%s", is);
	}
	if (!place->known[0] && strncmp(place->where, place->names, strlen(place->names)) != 0)
		snprintf(place->known, PATH_MAX, "%s",
		         place->last[are_some_equal(place->names) ? BY_PATH : BY_ID]);
}

static int open_place(void *ctx, const struct bus_env *env, struct serial_port **port, char *name,
                      size_t name_size, char *why, size_t why_size)
{
	struct place *place = ctx;
	char path[PATH_MAX];
	const struct rivals_device device = {
		path, path, "is the adapter plugged in? ls " SERIAL_BY_ID, "dialout"};
	unsigned count = find(place, path);
	char who[RIVALS_TEXT];
	int holder;

	if (count == 0) {
		snprintf(why, why_size, "no serial port in %s/%s: is the adapter plugged in?",
		         place->names, folders[BY_ID]);
		return -ENODEV;
	}
	if (count > 1) {
		snprintf(why, why_size,
		         "there are several serial ports in %s: name the adapter's, below %s, or "
		         "%s if two are the same",
		         place->names, folders[BY_ID], folders[BY_PATH]);
		return -EINVAL;
	}
	if ((size_t)snprintf(name, name_size, "%s", path) >= name_size) {
		snprintf(why, why_size, "the name of the port is longer than %zu characters",
		         name_size - 1);
		return -ENAMETOOLONG;
	}
	int err = tty_open(path, env, port, &holder);

	if (err == -ENOTTY)
		snprintf(why, why_size, "%s is no serial port", path);
	else if (err == -EBUSY && !rivals_find(RIVALS_PROC, path, who, sizeof(who)))
		snprintf(why, why_size,
		         "%s is in use by another program: sudo owsctl doctor names it", path);
	else if (err)
		err = rivals_refused(err, &device, holder, why, why_size);
	if (err)
		return err;
	know(place, env, path);
	return 0;
}

static int is_there(void *ctx, uint64_t *mark)
{
	char path[PATH_MAX];
	struct stat st;

	if (find(ctx, path) != 1 || stat(path, &st))
		return 0;
	*mark = (uint64_t)st.st_rdev << 32 ^ (uint64_t)st.st_ino ^ (uint64_t)st.st_ctime;
	return 1;
}

static void forget(void *ctx)
{
	free(((struct place *)ctx)->where);
	free(ctx);
}

int tty_source(const char *where, const char *names, struct serial_source *source, char *why,
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
	place->names = names;
	*source = (struct serial_source){.open = open_place,
	                                 .visible = is_there,
	                                 .destroy = forget,
	                                 .ctx = place,
	                                 .proc = RIVALS_PROC};
	return 0;
}
