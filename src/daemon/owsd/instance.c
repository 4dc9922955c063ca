/* SPDX-License-Identifier: MIT */
/* The lock that makes a process the one owsd of its instance, and the watch over its name. */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "hal/base/time.h"
#include "src/daemon/owsd/instance.h"
#include "src/memory/shm/hint.h"
#include "src/memory/shm/lock.h"
#include "src/memory/shm/segment.h"
#include "src/public/ows.h"

#define LOOK_NS NS_PER_S

/*
 * The lock is the last: as long as it exists, no other owsd creates the files that are being
 * removed.
 */
static const char *const kinds[] = {"image", "force", "control", "lock"};
#define KINDS (sizeof(kinds) / sizeof(kinds[0]))

static unsigned look_before(const struct shm_dir *dir, const char *name)
{
	unsigned before = 0;
	char file[SEGMENT_FILE];

	for (unsigned i = 0; i < KINDS; i++) {
		segment_file(name, kinds[i], file);
		if (faccessat(dir->fd, file, F_OK, AT_SYMLINK_NOFOLLOW) == 0 || errno != ENOENT)
			before |= 1u << i;
	}
	return before;
}

/*
 * Does an owsd listen there for programs that command? Its control socket takes packets: the kernel
 * refuses a stream with another error where nobody listens, and connects in no case.
 */
static bool is_served(const char *dir, const char *name)
{
	struct sockaddr_un address = {.sun_family = AF_UNIX};
	int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
	char file[SEGMENT_FILE];
	int len = snprintf(address.sun_path, sizeof(address.sun_path), "%s/%s", dir,
	                   segment_file(name, "control", file));
	bool is = fd >= 0 && len < (int)sizeof(address.sun_path) &&
	          connect(fd, (const struct sockaddr *)&address, sizeof(address)) &&
	          errno == EPROTOTYPE;

	if (fd >= 0)
		close(fd);
	return is;
}

/* Programs of this user find the one or the other, and both may write to the same devices. */
static void warn_of_namesakes(const struct instance *instance, struct log *log)
{
	char dirs[DIRS][DIR_PATH];
	int count = dir_list(dirs);

	for (int i = 0; i < count; i++)
		if (strcmp(dirs[i], instance->dir.path) != 0 && is_served(dirs[i], instance->name))
			log_warning(log,
			            "another owsd %s runs, in %s: owsctl of this user sees the one "
			            "in %s; end one of them, or name this one otherwise with -n",
			            instance->name, dirs[i], instance->dir.path);
}

int instance_take(struct instance *instance, const char *name, struct log *log, char *why,
                  size_t why_size)
{
	char hint[SEGMENT_HINT], fault[DIR_FAULT];
	bool stolen = false;
	pid_t owner = 0;
	int lock, err;

	*instance = (struct instance){.name = name, .lock = -1};
	err = dir_make(&instance->dir);
	if (err) {
		snprintf(why, why_size, "%s", dir_fault(&instance->dir, err, fault));
		return err;
	}
	instance->before = look_before(&instance->dir, name);
	lock = segment_lock(&instance->dir, name, &owner, &stolen);
	if (lock >= 0)
		instance->lock = lock;
	if (lock == -EBUSY)
		snprintf(why, why_size,
		         "instance %s is already served by process %d; end it or "
		         "choose another name with -n",
		         name, (int)owner);
	else if (lock < 0)
		snprintf(why, why_size, "cannot lock instance %s: %s%s", name, strerror(-lock),
		         segment_hint(&instance->dir, name, lock, hint));
	if (stolen)
		log_warning(
			log,
			"the previous owsd is stuck in the kernel: owsd starts with a new lock");
	if (lock >= 0) {
		warn_of_namesakes(instance, log);
		return 0;
	}
	dir_close(&instance->dir);
	return lock;
}

bool instance_keep(struct instance *instance, struct log *log)
{
	int64_t now_ns = ows_now();
	const struct shm_dir *dir = &instance->dir;
	char hint[SEGMENT_HINT];
	bool stolen;
	pid_t owner = 0;
	int lock;

	if (now_ns < instance->look_ns)
		return true;
	instance->look_ns = now_ns + LOOK_NS;
	if (segment_lock_held(&instance->dir, instance->lock, instance->name))
		return true;
	lock = segment_lock(dir, instance->name, &owner, &stolen);
	if (lock >= 0) {
		close(instance->lock);
		instance->lock = lock;
		instance->rate = (struct log_rate){0};
		log_warning(log, "%s/%s.lock was removed: made again", dir->path, instance->name);
	} else if (lock == -EBUSY && owner != getpid()) {
		log_err(log, "%s/%s.lock was removed, and process %d serves the instance now",
		        dir->path, instance->name, (int)owner);
		return false;
	} else if (log_rate(&instance->rate, now_ns)) {
		log_err(log, "%s/%s.lock was removed and cannot be made again: %s%s", dir->path,
		        instance->name, strerror(-lock),
		        segment_hint(dir, instance->name, lock, hint));
	}
	return true;
}

void instance_leave(struct instance *instance)
{
	if (instance->lock >= 0)
		close(instance->lock);
	instance->lock = -1;
	dir_close(&instance->dir);
}

void instance_abandon(struct instance *instance)
{
	char file[SEGMENT_FILE];

	if (instance->lock >= 0 &&
	    segment_lock_held(&instance->dir, instance->lock, instance->name))
		for (unsigned i = 0; i < KINDS; i++) {
			segment_file(instance->name, kinds[i], file);
			if (!(instance->before & 1u << i))
				unlinkat(instance->dir.fd, file, 0);
		}
	instance_leave(instance);
}
