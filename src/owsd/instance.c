/* SPDX-License-Identifier: MIT */
/* The lock that makes a process the one owsd of its instance, and the watch over its name. */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "hal/bus/time.h"
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
static const char *const kinds[] = {"image", "command", "lock"};
#define KINDS (sizeof(kinds) / sizeof(kinds[0]))

static void file_path(const char *name, unsigned kind, char path[80])
{
	snprintf(path, 80, "/dev/shm/owsd.%.32s.%s", name, kinds[kind]);
}

static unsigned look_before(const char *name)
{
	unsigned before = 0;
	char path[80];

	for (unsigned i = 0; i < KINDS; i++) {
		file_path(name, i, path);
		if (faccessat(AT_FDCWD, path, F_OK, AT_SYMLINK_NOFOLLOW) == 0 || errno != ENOENT)
			before |= 1u << i;
	}
	return before;
}

int instance_take(struct instance *instance, const char *name, struct log *log, char *why,
                  size_t why_size)
{
	char hint[SEGMENT_HINT];
	bool stolen = false;
	pid_t owner = 0;
	unsigned before = look_before(name);
	int lock = segment_lock(name, &owner, &stolen);

	*instance = (struct instance){
		.name = name,
		.lock = lock < 0 ? -1 : lock,
		.before = before,
	};
	if (lock == -EBUSY)
		snprintf(why, why_size,
		         "instance %s is already served by process %d; end it or "
		         "choose another name with -n",
		         name, (int)owner);
	else if (lock < 0)
		snprintf(why, why_size, "cannot lock instance %s: %s%s", name, strerror(-lock),
		         segment_hint(name, lock, hint));
	if (stolen)
		log_warning(
			log,
			"the previous owsd is stuck in the kernel: owsd starts with a new lock");
	return lock < 0 ? lock : 0;
}

bool instance_keep(struct instance *instance, struct log *log)
{
	int64_t now_ns = ows_now();
	char hint[SEGMENT_HINT];
	bool stolen;
	pid_t owner = 0;
	int lock;

	if (now_ns < instance->look_ns)
		return true;
	instance->look_ns = now_ns + LOOK_NS;
	if (segment_lock_held(instance->lock, instance->name))
		return true;
	lock = segment_lock(instance->name, &owner, &stolen);
	if (lock >= 0) {
		close(instance->lock);
		instance->lock = lock;
		instance->rate = (struct log_rate){0};
		log_warning(log, "/dev/shm/owsd.%s.lock was removed: made again", instance->name);
	} else if (lock == -EBUSY && owner != getpid()) {
		log_err(log,
		        "/dev/shm/owsd.%s.lock was removed, and process %d serves the instance now",
		        instance->name, (int)owner);
		return false;
	} else if (log_rate(&instance->rate, now_ns)) {
		log_err(log, "/dev/shm/owsd.%s.lock was removed and cannot be made again: %s%s",
		        instance->name, strerror(-lock), segment_hint(instance->name, lock, hint));
	}
	return true;
}

void instance_leave(struct instance *instance)
{
	if (instance->lock >= 0)
		close(instance->lock);
	instance->lock = -1;
}

void instance_abandon(struct instance *instance)
{
	char path[80];

	if (instance->lock >= 0 && segment_lock_held(instance->lock, instance->name))
		for (unsigned i = 0; i < KINDS; i++) {
			file_path(instance->name, i, path);
			if (!(instance->before & 1u << i))
				unlink(path);
		}
	instance_leave(instance);
}
