/* SPDX-License-Identifier: MIT */
/*
 * Two GPIO lines that show the state of owsd to people beside the machine: AlarmLine is on while
 * there is an alarm that `owsctl alarms` would show, HeartbeatLine blinks. A thread of the
 * indicator sets them from the image, so that neither engine nor supervisor waits for a line.
 */
#pragma once

#include "src/config/read/config.h"
#include "src/ground/text/log.h"
#include "src/memory/shm/image.h"

struct indicator;

/*
 * Returns 0, with *indicator NULL when the configuration has neither line; -ENOMEM; -EINVAL the
 * text of a line does not name a GPIO line.
 */
int indicator_create(const struct config *config, const struct image *image, struct log *log,
                     struct indicator **indicator);
/*
 * Set both lines for now_ns; takes them first, and tries again every few seconds where taking a
 * line failed. Returns the time of the next call.
 */
int64_t indicator_step(struct indicator *indicator, int64_t now_ns);
/* Turn the heartbeat off, release the alarm line as it is, and free the indicator. */
void indicator_destroy(struct indicator *indicator);

/* Start the thread that calls indicator_step(). indicator may be NULL. 0 or a negative errno. */
int indicator_start(struct indicator *indicator);
/*
 * End the thread; false: the thread is stuck in the kernel, and indicator_destroy() must not be
 * called.
 */
bool indicator_stop(struct indicator *indicator, int64_t timeout_ns);
