/* SPDX-License-Identifier: MIT */
/* The Mqtt block, of which owsd-mqtt takes its options. owsd checks it, and does not use it. */
#pragma once

#include "src/config/read/build.h"

block_derive mqtt_derive;
