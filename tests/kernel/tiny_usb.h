/* SPDX-License-Identifier: MIT */
/*
 * A USB device that is an i2c-tiny-usb adapter: the control requests of endpoint 0, and an I2C bus
 * behind them. The kernel's i2c-tiny-usb driver makes each I2C message of a transaction one
 * transfer request and one status request. Pure but for the bus it is given.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct tiny_usb {
	/*
	 * One I2C message. 0; -ENXIO the address was refused, -EIO a data byte was refused. A
	 * message without data only asks whether the address is acknowledged.
	 */
	int (*message)(void *ctx, uint8_t address, bool read, uint8_t *data, size_t len);
	void *ctx;
	uint8_t status; /* of the last message: 0 none yet, 1 acknowledged, 2 refused */
};

/*
 * Answer one control request. data holds what came (requests out) or gets the answer (in); room is
 * its size, at most the length the request states is used. Returns the bytes moved, or -EPIPE for
 * what the device does not know (a stall).
 */
int tiny_usb_control(struct tiny_usb *usb, const uint8_t setup[8], uint8_t *data, size_t room);
