/* SPDX-License-Identifier: MIT */
/* What is to be seen of an instance, without asking it. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "src/memory/shm/dir.h"

/* An instance of owsd as `owsctl instances` shows it. */
enum instance_state {
	INSTANCE_RUNNING,
	INSTANCE_HANGS,   /* its process exists, its heart stands still */
	INSTANCE_STOPPED, /* it ended in order */
	INSTANCE_KILLED,  /* it ended without marking its segments */
	INSTANCE_LEFT,    /* no image: files of a start or an end that was cut short */
	INSTANCE_HIDDEN,  /* its files cannot be read */
};

/*
 * The state of an instance by its image (state as in ows_daemon; has_image false: there is none)
 * and its lock: 1: a process holds the lock; 0: the owsd of the image has released it; negative:
 * not known, because the lock was removed or belongs to another user. Then the heart decides, and
 * `process`: an owsd with that process id exists.
 */
enum instance_state instance_state_of(bool has_image, uint32_t state, bool alive, int lock,
                                      bool process);
const char *instance_state_text(enum instance_state state);

/* The configuration that a command line as in /proc/PID/cmdline names; NULL: it names none. */
const char *instance_config_of(const char *line, size_t len);

#define INSTANCE_FIELD 400

struct instance_info {
	const char *name, *dir;
	enum instance_state state;
	int pid;          /* 0: not known */
	int64_t since_ns; /* when this state began; 0: not known */
	int signals;      /* -1: not known */
	char targets[INSTANCE_FIELD], config[INSTANCE_FIELD]; /* "": not known */
	const char *why; /* hidden: the reason; up: the fault of its lock; else NULL */
};

/* name and dir have to outlive info. */
void instance_look(const struct shm_dir *dir, const char *name, int64_t now_ns,
                   struct instance_info *info);
/*
 * Does it run? Looks at the heart and the process too: the lock may have been removed or replaced.
 * *pid is 0 where it is not known.
 */
bool instance_runs(const struct shm_dir *dir, const char *name, int *pid);
/*
 * How many instances run here; one of them in `name` (SEGMENT_NAME_MAX + 1 bytes), and with `names`
 * all, with commas between.
 */
unsigned instances_running(char *name, char *names, size_t size);
/* Does one run that has this configuration file? name has SEGMENT_NAME_MAX + 1 bytes. */
bool instance_of_file(const char *file, char *name);

/*
 * The configuration of an instance: that of the owsd which runs, else where a service of that name
 * has it. The file may be missing.
 */
void instance_config(const char *name, char config[INSTANCE_FIELD]);
