/* SPDX-License-Identifier: MIT */
/* An instance of owsd as `owsctl instances` shows it. */
#ifndef OWSCTL_INSTANCE_STATE_H
#define OWSCTL_INSTANCE_STATE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum instance_state {
	INSTANCE_RUNNING,
	INSTANCE_HANGS,   /* its process is there, its heart stands still */
	INSTANCE_STOPPED, /* in order */
	INSTANCE_KILLED,  /* it could not say that it ended */
	INSTANCE_LEFT,    /* no image: files of a start or an end that was cut short */
	INSTANCE_HIDDEN,  /* it cannot be looked at */
};

/*
 * What follows from the image (state as in ows_daemon; has_image false: there is none) and from the
 * lock: 1 somebody holds it, 0 the owsd of the image has let it go, negative: neither can be told (it
 * was removed, or is another's), and then the heart counts, and process: an owsd of that number is
 * there.
 */
enum instance_state instance_state_of(bool has_image, uint32_t state, bool alive, int lock,
                                      bool process);
/* Its process is there: nothing of it may be removed. */
bool instance_is_up(enum instance_state state);
const char *instance_state_text(enum instance_state state);

/* The configuration of a command line as in /proc/PID/cmdline; NULL: it names none. */
const char *instance_config_of(const char *line, size_t len);

#endif
