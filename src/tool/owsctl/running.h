/* SPDX-License-Identifier: MIT */
/* What is to be seen of an instance, without asking it. */
#pragma once

#include <stddef.h>

#include "src/memory/shm/dir.h"
#include "src/tool/owsctl/instance_state.h"

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
