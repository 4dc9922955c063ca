/* SPDX-License-Identifier: MIT */
/* Links in front of others, or in place of them. */
#pragma once

#include "hal/trace/lines.h"

/* As tap.link. */
struct link *trace_link_of(struct tap *tap, unsigned n, struct link *link);
