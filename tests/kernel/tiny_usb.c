/* SPDX-License-Identifier: MIT */
/* The control requests of a simulated i2c-tiny-usb adapter. */
#include <errno.h>
#include <string.h>

#include "tests/kernel/tiny_usb.h"

enum {
	REQUEST_TYPE_KIND = 0x60,
	KIND_STANDARD = 0x00,
	KIND_VENDOR = 0x40,
};

enum standard_request {
	GET_STATUS = 0,
	CLEAR_FEATURE = 1,
	SET_FEATURE = 3,
	GET_DESCRIPTOR = 6,
	GET_CONFIGURATION = 8,
	SET_CONFIGURATION = 9,
	SET_INTERFACE = 11,
};

enum { DESCRIPTOR_DEVICE = 1, DESCRIPTOR_CONFIGURATION = 2, DESCRIPTOR_STRING = 3 };

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
	18, DESCRIPTOR_DEVICE, 0x10, 0x01, 0xff, 0, 0, 64, 0x03, 0x04, 0x31, 0xc6, 0x05, 0x02,
	1, 2, 3, 1,
};
/* clang-format on */
static const uint8_t configuration_descriptor[] = {
	9, DESCRIPTOR_CONFIGURATION, 18, 0, 1, 1, 0, 0x80, 50, 9, 4, 0, 0, 0, 0xff, 0, 0, 0,
};
static const char *const strings[] = {"", "owsd", "simulated i2c-tiny-usb", "1"};

static int give(uint8_t *data, size_t room, const void *answer, size_t len)
{
	if (len > room)
		len = room;
	memcpy(data, answer, len);
	return (int)len;
}

static int string_descriptor(unsigned index, uint8_t *data, size_t room)
{
	static const uint8_t language[] = {4, DESCRIPTOR_STRING, 0x09, 0x04};
	uint8_t answer[64] = {0};
	size_t len;

	if (index == 0)
		return give(data, room, language, sizeof(language));
	if (index >= sizeof(strings) / sizeof(strings[0]))
		return -EPIPE;
	len = strlen(strings[index]);
	answer[0] = (uint8_t)(2 + 2 * len);
	answer[1] = DESCRIPTOR_STRING;
	for (size_t i = 0; i < len; i++)
		answer[2 + 2 * i] = (uint8_t)strings[index][i];
	return give(data, room, answer, answer[0]);
}

static int descriptor(unsigned type, unsigned index, uint8_t *data, size_t room)
{
	if (type == DESCRIPTOR_DEVICE)
		return give(data, room, device_descriptor, sizeof(device_descriptor));
	if (type == DESCRIPTOR_CONFIGURATION)
		return give(data, room, configuration_descriptor, sizeof(configuration_descriptor));
	if (type == DESCRIPTOR_STRING)
		return string_descriptor(index, data, room);
	return -EPIPE;
}

static int standard(const uint8_t setup[8], uint8_t *data, size_t room)
{
	static const uint8_t zero[2] = {0, 0}, one = 1;

	switch (setup[1]) {
	case GET_DESCRIPTOR:
		return descriptor(setup[3], setup[2], data, room);
	case GET_STATUS:
		return give(data, room, zero, sizeof(zero));
	case GET_CONFIGURATION:
		return give(data, room, &one, 1);
	case CLEAR_FEATURE:
	case SET_FEATURE:
	case SET_CONFIGURATION:
	case SET_INTERFACE:
		return 0;
	}
	return -EPIPE;
}

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
		return give(data, room, setup + 2, 2);
	case I2C_FUNCTIONS:
		return give(data, room, functions, sizeof(functions));
	case I2C_SET_DELAY:
		return 0;
	case I2C_STATUS:
		return give(data, room, &usb->status, 1);
	}
	return -EPIPE;
}

int tiny_usb_control(struct tiny_usb *usb, const uint8_t setup[8], uint8_t *data, size_t room)
{
	size_t stated = setup[6] | (size_t)setup[7] << 8;

	if (room > stated)
		room = stated;
	if ((setup[0] & REQUEST_TYPE_KIND) == KIND_VENDOR)
		return vendor(usb, setup, data, room);
	if ((setup[0] & REQUEST_TYPE_KIND) == KIND_STANDARD)
		return standard(setup, data, room);
	return -EPIPE;
}
