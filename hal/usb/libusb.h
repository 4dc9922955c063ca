/* SPDX-License-Identifier: MIT */
/* The adapters of this machine, by libusb; without it, open() says what to install. */
#pragma once

#include "hal/usb/port.h"

extern const struct usb_system usb_linux;
