/* SPDX-License-Identifier: MIT */
#pragma once

#include "hal/base/time.h"

/* A command that may be older moves no output, whatever held it, by whichever door it comes. */
#define COMMAND_OLD_NS (2 * NS_PER_S)
