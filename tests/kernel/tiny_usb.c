/* SPDX-License-Identifier: MIT */
/* The control requests of a simulated i2c-tiny-usb adapter. */
#include <errno.h>
#include <string.h>

#include "hal/sim/usb/standard.h"
#include "tests/kernel/tiny_usb.h"

enum i2c_request {
	I2C_ECHO = 0,
	I2C_FUNCTIONS = 1,
	I2C_SET_DELAY = 2,
	I2C_STATUS = 3,
	I2C_TRANSFER = 4, /* + 1 begins a transaction, + 2 ends it */
	I2C_TRANSFER_LAST = 7,
};

enum { STATUS_ACKNOWLEDGED = 1, STATUS_REFUSED = 2 };

/* I2C_FUNC_I2C and the SMBus calls that the kernel makes of plain messages. */
#define FUNCTIONS 0x0eff0001u

/* clang-format off */
static const uint8_t device_descriptor[] = {
	18, USB_DEVICE, 0x10, 0x01, 0xff, 0, 0, 64, 0x03, 0x04, 0x31, 0xc6, 0x05, 0x02,
	1, 2, 3, 1,
};
/* clang-format on */
static const uint8_t configuration_descriptor[] = {
	9, USB_CONFIGURATION, 18, 0, 1, 1, 0, 0x80, 50, 9, 4, 0, 0, 0, 0xff, 0, 0, 0,
};
static const char *const strings[] = {"owsd", "simulated i2c-tiny-usb", "1", NULL};
static const struct usb_identity identity = {device_descriptor, configuration_descriptor, strings};

static int transfer(struct tiny_usb *usb, const uint8_t setup[8], uint8_t *data, size_t room)
{
	bool read = setup[2] & 1;
	uint8_t address = setup[4] & 0x7f;
	int err;

	if (read)
		memset(data, 0xff, room);
	err = usb->message(usb->ctx, address, read, data, room);
	usb->status = err == -ENXIO ? STATUS_REFUSED : STATUS_ACKNOWLEDGED;
	if (err && err != -ENXIO)
		return -EPIPE;
	return (int)room;
}

static int vendor(struct tiny_usb *usb, const uint8_t setup[8], uint8_t *data, size_t room)
{
	static const uint8_t functions[4] = {
		FUNCTIONS & 0xff,
		FUNCTIONS >> 8 & 0xff,
		FUNCTIONS >> 16 & 0xff,
		FUNCTIONS >> 24,
	};

	if (setup[1] >= I2C_TRANSFER && setup[1] <= I2C_TRANSFER_LAST)
		return transfer(usb, setup, data, room);
	switch (setup[1]) {
	case I2C_ECHO:
		return usb_give(data, room, setup + 2, 2);
	case I2C_FUNCTIONS:
		return usb_give(data, room, functions, sizeof(functions));
	case I2C_SET_DELAY:
		return 0;
	case I2C_STATUS:
		return usb_give(data, room, &usb->status, 1);
	}
	return -EPIPE;
}

int tiny_usb_control(struct tiny_usb *usb, const uint8_t setup[8], uint8_t *data, size_t room)
{
	size_t stated = setup[6] | (size_t)setup[7] << 8;

	if (room > stated)
		room = stated;
	if ((setup[0] & USB_KIND) == USB_KIND_VENDOR)
		return vendor(usb, setup, data, room);
	return usb_standard(&identity, setup, data, room);
}
