/* SPDX-License-Identifier: MIT */
/* What the image shows. */
#pragma once

#include "src/daemon/engine/state.h"

/* Publish the signal; its limit alarms are brought to the present first. */
void engine_publish(struct engine *e, struct signal *s);
/* Did record 0 change since it was published, but for its beat? */
bool engine_driver_changed(const struct engine *e);
void engine_publish_driver(struct engine *e);
/* The target, with its note. */
void engine_publish_target(struct engine *e, const struct lane *lane);
