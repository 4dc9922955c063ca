/* SPDX-License-Identifier: MIT */
/* An instance of owsd as `owsctl instances` shows it. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

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
/* Does the instance's process exist? Then owsctl removes none of its files. */
bool instance_is_up(enum instance_state state);
const char *instance_state_text(enum instance_state state);

/* The configuration that a command line as in /proc/PID/cmdline names; NULL: it names none. */
const char *instance_config_of(const char *line, size_t len);
