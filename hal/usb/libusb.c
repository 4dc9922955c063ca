/* SPDX-License-Identifier: MIT */
/*
 * Transfers by libusb, where owsd is built with it. owsd finds and opens the device file itself:
 * libusb looks for no devices, starts no thread and needs no netlink socket. Its blocking functions
 * are enough on a thread that has one adapter. They allocate a transfer for each call; so does its
 * Linux part for each submission of a transfer that is kept, and nothing would be gained.
 */
#include <errno.h>
#include <fcntl.h>
#include <linux/usbdevice_fs.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "hal/base/chip_lock.h"
#include "hal/base/rivals.h"
#include "hal/usb/find.h"
#include "hal/usb/libusb.h"

#define INTERFACE 0

#ifdef OWSD_LIBUSB
#include <libusb-1.0/libusb.h>

#define QUICK 3 /* alternate setting: the state each ms, packets of 64 bytes */
#define VENDOR 0x40

struct opened {
	struct usb_port port;
	int fd;
	libusb_context *context;
	libusb_device_handle *handle;
};

static int error_of(int err)
{
	static const int errors[][2] = {
		{LIBUSB_ERROR_NO_DEVICE, -ENODEV},
		{LIBUSB_ERROR_NOT_FOUND, -ENODEV},
		{LIBUSB_ERROR_TIMEOUT, -ETIMEDOUT},
		{LIBUSB_ERROR_BUSY, -EBUSY},
	};

	for (size_t i = 0; i < sizeof(errors) / sizeof(errors[0]); i++)
		if (errors[i][0] == err)
			return errors[i][1];
	return err < 0 ? -EIO : 0;
}

static libusb_device_handle *handle_of(struct usb_port *port)
{
	return ((struct opened *)port)->handle;
}

static int port_control(struct usb_port *port, uint8_t request, uint16_t value, uint16_t index)
{
	return error_of(libusb_control_transfer(handle_of(port), VENDOR, request, value, index,
	                                        NULL, 0, USB_TIMEOUT_MS));
}

static int port_transfer(struct usb_port *port, uint8_t endpoint, uint8_t *bytes, size_t n)
{
	int done = 0, err;

	if (endpoint == USB_STATE)
		err = libusb_interrupt_transfer(handle_of(port), endpoint, bytes, (int)n, &done,
		                                USB_TIMEOUT_MS);
	else
		err = libusb_bulk_transfer(handle_of(port), endpoint, bytes, (int)n, &done,
		                           USB_TIMEOUT_MS);
	return err ? error_of(err) : done;
}

static int port_clear(struct usb_port *port)
{
	static const uint8_t endpoints[] = {USB_STATE, USB_OUT, USB_IN};
	int err = 0;

	for (size_t i = 0; !err && i < sizeof(endpoints); i++)
		err = error_of(libusb_clear_halt(handle_of(port), endpoints[i]));
	return err;
}

static int port_reset(struct usb_port *port)
{
	int err = libusb_reset_device(handle_of(port));

	if (!err)
		err = libusb_set_interface_alt_setting(handle_of(port), INTERFACE, QUICK);
	return error_of(err);
}

static void port_close(struct usb_port *port)
{
	struct opened *opened = (struct opened *)port;

	if (opened->handle)
		libusb_close(opened->handle);
	if (opened->context)
		libusb_exit(opened->context);
	if (opened->fd >= 0) {
		chip_unlock(opened->fd, 0);
		close(opened->fd); /* and the interface is free */
	}
	free(opened);
}

static const struct usb_port_ops port_ops = {
	.control = port_control,
	.transfer = port_transfer,
	.clear = port_clear,
	.reset = port_reset,
	.close = port_close,
};

/* The kernel's driver loses the interface, and cannot take it while this process has it. */
static int claim(struct opened *opened)
{
	int err = libusb_set_option(NULL, LIBUSB_OPTION_NO_DEVICE_DISCOVERY);

	if (!err)
		err = libusb_init(&opened->context);
	if (!err)
		err = libusb_wrap_sys_device(opened->context, opened->fd, &opened->handle);
	if (!err)
		(void)libusb_detach_kernel_driver(opened->handle, INTERFACE);
	if (!err)
		err = libusb_claim_interface(opened->handle, INTERFACE);
	if (!err)
		err = libusb_set_interface_alt_setting(opened->handle, INTERFACE, QUICK);
	return error_of(err);
}

static int explain(int err, const struct usb_place *place, int holder, char *why, size_t size)
{
	char name[sizeof(USB_CALLED) + USB_NAME];
	const struct rivals_device device = {
		.name = name,
		.path = place->device,
		.group = "dialout, to which owsd's udev rule gives it",
	};

	snprintf(name, sizeof(name), USB_CALLED, place->name);
	if (err == -ENOENT || err == -ENXIO || err == -ENODEV) {
		snprintf(why, size, "%s is gone: is it plugged in?", name);
		return -ENODEV;
	}
	if (err != -EBUSY || !*place->driver || strcmp(place->driver, "usbfs") == 0)
		return rivals_refused(err, &device, holder, why, size);
	snprintf(why, size, "%s is in use by the kernel's driver %s", name, place->driver);
	return -EBUSY;
}

static int port_open(const struct usb_place *place, struct usb_port **port, char *why, size_t size)
{
	struct opened *opened = calloc(1, sizeof(*opened));
	int holder = 0, err;

	if (!opened)
		return explain(-ENOMEM, place, 0, why, size);
	opened->port.ops = &port_ops;
	opened->fd = open(place->device, O_RDWR | O_CLOEXEC);
	err = opened->fd < 0 ? -errno : chip_lock(opened->fd, 0, &holder);
	if (!err)
		err = usb_is_adapter(opened->fd) ? claim(opened) : -ENODEV;
	if (!err)
		*port = &opened->port;
	else
		port_close(&opened->port);
	return err ? explain(err, place, holder, why, size) : 0;
}
#else
static int port_open(const struct usb_place *place, struct usb_port **port, char *why, size_t size)
{
	(void)place, (void)port;
	snprintf(why, size,
	         "this owsd was built without libusb: install libusb-1.0-0-dev and build it again");
	return -EOPNOTSUPP;
}
#endif

/* A driver takes it, if one is loaded: it may have lost it to a process that was killed. */
static void give_back(const struct usb_place *place)
{
	struct usbdevfs_ioctl connect = {.ifno = INTERFACE, .ioctl_code = USBDEVFS_CONNECT};
	int fd = open(place->device, O_RDWR | O_CLOEXEC);

	if (fd < 0)
		return;
	if (usb_is_adapter(fd))
		(void)ioctl(fd, (int)USBDEVFS_IOCTL, &connect); /* musl takes an int */
	close(fd);
}

static unsigned list(struct usb_place places[USB_PLACES])
{
	return usb_find("/sys/bus/usb/devices", places);
}

const struct usb_system usb_linux = {
	.list = list,
	.open = port_open,
	.give_back = give_back,
	.proc = RIVALS_PROC,
};
