/* SPDX-License-Identifier: MIT */
/* How much a native bus takes on at once. */
#pragma once

#include "hal/base/time.h"

#define NATIVE_DEPTH 400   /* requests */
#define NATIVE_CHANNELS 64 /* links of a master */
#define NATIVE_COUPLERS 16 /* their branches are channels behind those */
#define NATIVE_ALL (NATIVE_CHANNELS + 2 * NATIVE_COUPLERS)
/* Requests in a row that a device may fail before it is taken to be broken. */
#define NATIVE_DOUBTS 3
/* Of so many requests for devices that failed it is not one device that fails now and then. */
#define NATIVE_MANY 4
/* For so long the result of a conversion that no job could read serves in place of another. */
#define NATIVE_UNREAD_NS (4 * NS_PER_S)
