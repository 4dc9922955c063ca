/* SPDX-License-Identifier: MIT */
/* The standard requests of a USB device. */
#include <errno.h>
#include <string.h>

#include "hal/sim/usb/standard.h"

int usb_give(uint8_t *data, size_t room, const void *answer, size_t len)
{
	if (len > room)
		len = room;
	memcpy(data, answer, len);
	return (int)len;
}

static int string_descriptor(const char *const *strings, unsigned index, uint8_t *data, size_t room)
{
	static const uint8_t language[] = {4, USB_STRING, 0x09, 0x04};
	uint8_t answer[64] = {0};
	size_t len;

	if (!strings)
		return -EPIPE;
	if (index == 0)
		return usb_give(data, room, language, sizeof(language));
	for (unsigned i = 1; i < index && *strings; i++)
		strings++;
	if (!*strings)
		return -EPIPE;
	len = strlen(*strings);
	answer[0] = (uint8_t)(2 + 2 * len);
	answer[1] = USB_STRING;
	for (size_t i = 0; i < len; i++)
		answer[2 + 2 * i] = (uint8_t)(*strings)[i];
	return usb_give(data, room, answer, answer[0]);
}

static int descriptor(const struct usb_identity *identity, unsigned type, unsigned index,
                      uint8_t *data, size_t room)
{
	const uint8_t *configuration = identity->configuration;

	if (type == USB_DEVICE)
		return usb_give(data, room, identity->device, identity->device[0]);
	if (type == USB_CONFIGURATION)
		return usb_give(data, room, configuration,
		                configuration[2] | (size_t)configuration[3] << 8);
	if (type == USB_STRING)
		return string_descriptor(identity->strings, index, data, room);
	return -EPIPE;
}

int usb_standard(const struct usb_identity *identity, const uint8_t setup[8], uint8_t *data,
                 size_t room)
{
	static const uint8_t zero[2] = {0, 0}, one = 1;

	if ((setup[0] & USB_KIND) != USB_KIND_STANDARD)
		return -EPIPE;
	switch (setup[1]) {
	case USB_GET_DESCRIPTOR:
		return descriptor(identity, setup[3], setup[2], data, room);
	case USB_GET_STATUS:
		return usb_give(data, room, zero, sizeof(zero));
	case USB_GET_CONFIGURATION:
		return usb_give(data, room, &one, 1);
	case USB_CLEAR_FEATURE:
	case USB_SET_FEATURE:
	case USB_SET_CONFIGURATION:
	case USB_SET_INTERFACE:
		return 0;
	}
	return -EPIPE;
}
