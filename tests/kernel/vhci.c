/* SPDX-License-Identifier: MIT */
/* Plugs a simulated USB device into the kernel, and serves its requests. */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "tests/kernel/usbip.h"
#include "tests/kernel/vhci.h"

#define ATTACH "/sys/devices/platform/vhci_hcd.0/attach"

enum { DEVICE_ID = 1 << 16 | 2, FULL_SPEED = 2 };

int vhci_plug(unsigned port)
{
	char line[64];
	int ends[2], attach, len, err = 0;

	if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends))
		return -errno;
	attach = open(ATTACH, O_WRONLY | O_CLOEXEC);
	if (attach < 0) {
		err = -errno;
	} else {
		len = snprintf(line, sizeof(line), "%u %d %d %d", port, ends[1], DEVICE_ID,
		               FULL_SPEED);
		if (write(attach, line, (size_t)len) != len)
			err = -errno;
		close(attach);
	}
	close(ends[1]);
	if (!err)
		return ends[0];
	close(ends[0]);
	return err;
}

static int get(int fd, uint8_t *data, size_t len)
{
	while (len) {
		ssize_t n = read(fd, data, len);

		if (n < 0 && errno == EINTR)
			continue;
		if (n < 0)
			return -errno;
		if (n == 0)
			return -ECONNRESET;
		data += n;
		len -= (size_t)n;
	}
	return 0;
}

static int put(int fd, const uint8_t *data, size_t len)
{
	while (len) {
		ssize_t n = send(fd, data, len, MSG_NOSIGNAL);

		if (n < 0 && errno == EINTR)
			continue;
		if (n < 0)
			return -errno;
		data += n;
		len -= (size_t)n;
	}
	return 0;
}

int vhci_serve(int fd, struct tiny_usb *usb)
{
	uint8_t buffer[USBIP_HEADER + USBIP_MAX_DATA];
	uint8_t *data = buffer + USBIP_HEADER;
	struct usbip_request request;
	int err, moved = 0;
	size_t len = USBIP_HEADER;

	err = get(fd, buffer, USBIP_HEADER);
	if (!err)
		err = usbip_decode(buffer, &request);
	if (!err && request.command == USBIP_CMD_SUBMIT && !request.in)
		err = get(fd, data, request.length);
	if (err)
		return err;
	if (request.command == USBIP_CMD_SUBMIT)
		moved = request.endpoint
		                ? -EPIPE
		                : tiny_usb_control(usb, request.setup, data, request.length);
	usbip_answer(buffer, &request, moved < 0 ? moved : 0, moved < 0 ? 0 : (uint32_t)moved);
	if (request.in && moved > 0)
		len += (size_t)moved;
	return put(fd, buffer, len);
}
