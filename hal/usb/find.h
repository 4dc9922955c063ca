/* SPDX-License-Identifier: MIT */
/* The DS9490R that are plugged in. */
#pragma once

#include "hal/usb/port.h"

/* As usb_system.list, in a folder like /sys/bus/usb/devices. */
unsigned usb_find(const char *sysfs, struct usb_place places[USB_PLACES]);
/*
 * Is the open device file that of a DS2490? The kernel gives the number of one that was unplugged
 * to the next that is plugged in.
 */
bool usb_is_adapter(int fd);
/* Is it a name like "1-1.4"? */
bool usb_is_name(const char *text);
