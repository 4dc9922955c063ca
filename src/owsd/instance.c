/* SPDX-License-Identifier: MIT */
/* The lock that makes a process the one owsd of its instance, and the watch over its name. */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "hal/base/time.h"
#include "src/libows/ows.h"
#include "src/owsd/instance.h"
#include "src/shm/hint.h"
#include "src/shm/lock.h"
#include "src/shm/segment.h"

#define LOOK_NS NS_PER_S

/*
 * The lock is the last: as long as it exists, no other owsd creates the files that are being
 * removed.
 */
static const char *const kinds[] = {"image", "force", "control", "lock"};
#define KINDS (sizeof(kinds) / sizeof(kinds[0]))

static unsigned look_before(const struct shm_place *place, const char *name)
{
	unsigned before = 0;
	char file[SEGMENT_FILE];

	for (unsigned i = 0; i < KINDS; i++) {
		segment_file(name, kinds[i], file);
		if (faccessat(place->fd, file, F_OK, AT_SYMLINK_NOFOLLOW) == 0 || errno != ENOENT)
			before |= 1u << i;
	}
	return before;
}

int instance_take(struct instance *instance, const char *name, struct log *log, char *why,
                  size_t why_size)
{
	char hint[SEGMENT_HINT], fault[PLACE_FAULT];
	bool stolen = false;
	pid_t owner = 0;
	int lock, err;

	*instance = (struct instance){.name = name, .lock = -1};
	err = place_make(&instance->place);
	if (err) {
		snprintf(why, why_size, "%s", place_fault(&instance->place, err, fault));
		return err;
	}
	instance->before = look_before(&instance->place, name);
	lock = segment_lock(&instance->place, name, &owner, &stolen);
	if (lock >= 0)
		instance->lock = lock;
	if (lock == -EBUSY)
		snprintf(why, why_size,
		         "instance %s is already served by process %d; end it or "
		         "choose another name with -n",
		         name, (int)owner);
	else if (lock < 0)
		snprintf(why, why_size, "cannot lock instance %s: %s%s", name, strerror(-lock),
		         segment_hint(&instance->place, name, lock, hint));
	if (stolen)
		log_warning(
			log,
			"the previous owsd is stuck in the kernel: owsd starts with a new lock");
	if (lock >= 0)
		return 0;
	place_close(&instance->place);
	return lock;
}

bool instance_keep(struct instance *instance, struct log *log)
{
	int64_t now_ns = ows_now();
	const struct shm_place *place = &instance->place;
	char hint[SEGMENT_HINT];
	bool stolen;
	pid_t owner = 0;
	int lock;

	if (now_ns < instance->look_ns)
		return true;
	instance->look_ns = now_ns + LOOK_NS;
	if (segment_lock_held(&instance->place, instance->lock, instance->name))
		return true;
	lock = segment_lock(place, instance->name, &owner, &stolen);
	if (lock >= 0) {
		close(instance->lock);
		instance->lock = lock;
		instance->rate = (struct log_rate){0};
		log_warning(log, "%s/%s.lock was removed: made again", place->path, instance->name);
	} else if (lock == -EBUSY && owner != getpid()) {
		log_err(log, "%s/%s.lock was removed, and process %d serves the instance now",
		        place->path, instance->name, (int)owner);
		return false;
	} else if (log_rate(&instance->rate, now_ns)) {
		log_err(log, "%s/%s.lock was removed and cannot be made again: %s%s", place->path,
		        instance->name, strerror(-lock),
		        segment_hint(place, instance->name, lock, hint));
	}
	return true;
}

void instance_leave(struct instance *instance)
{
	if (instance->lock >= 0)
		close(instance->lock);
	instance->lock = -1;
	place_close(&instance->place);
}

void instance_abandon(struct instance *instance)
{
	char file[SEGMENT_FILE];

	if (instance->lock >= 0 &&
	    segment_lock_held(&instance->place, instance->lock, instance->name))
		for (unsigned i = 0; i < KINDS; i++) {
			segment_file(instance->name, kinds[i], file);
			if (!(instance->before & 1u << i))
				unlinkat(instance->place.fd, file, 0);
		}
	instance_leave(instance);
}
