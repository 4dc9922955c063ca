/* SPDX-License-Identifier: MIT */
/* What a bus reports by itself. */
#pragma once

#include "src/daemon/engine/state.h"

void lane_event(struct lane *lane, const struct bus_event *event);
