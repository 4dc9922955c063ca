/* SPDX-License-Identifier: MIT */
/*
 * Two GPIO lines that tell people beside the machine how owsd is: AlarmLine is on while there is
 * an alarm that `owsctl alarms` would show, HeartbeatLine blinks. A thread of its own sets them
 * from the image, so that neither engine nor supervisor waits for a line.
 */
#ifndef HOST_INDICATOR_H
#define HOST_INDICATOR_H

#include "src/config/config.h"
#include "src/shm/image.h"
#include "src/text/log.h"

struct indicator;

/* NULL and 0 when the configuration has neither line. -ENOMEM; -EINVAL a line is none. */
int indicator_create(const struct config *config, const struct image *image, struct log *log,
                     struct indicator **indicator);
/*
 * Set the lines as they are to be now; takes them first, and again every few seconds where that
 * failed. Returns when to call again.
 */
int64_t indicator_step(struct indicator *indicator, int64_t now_ns);
/* The heartbeat goes out; the alarm line is let go of as it is. */
void indicator_destroy(struct indicator *indicator);

/* The thread that does so. indicator may be NULL. 0 or a negative errno. */
int indicator_start(struct indicator *indicator);
/* End it; false: it is stuck in the kernel, and indicator_destroy() must not be called. */
bool indicator_stop(struct indicator *indicator, int64_t timeout_ns);

#endif
