/* SPDX-License-Identifier: MIT */
/* Plugs a simulated USB device into the kernel, and serves its requests. */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "tests/kernel/vhci.h"

#define ATTACH "/sys/devices/platform/vhci_hcd.0/attach"

enum { DEVICE_ID = 1 << 16 | 2, FULL_SPEED = 2 };

int vhci_plug(struct vhci *vhci, unsigned port)
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
	if (err) {
		close(ends[0]);
		return err;
	}
	vhci->fd = ends[0];
	vhci->count = 0;
	return 0;
}

void vhci_unplug(struct vhci *vhci)
{
	close(vhci->fd);
	vhci->fd = -1;
	vhci->count = 0;
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

static int answer(int fd, struct vhci_transfer *transfer, int status)
{
	const struct usbip_request *request = &transfer->request;

	usbip_answer(transfer->answer, request, status, transfer->moved);
	return put(fd, transfer->answer, USBIP_HEADER + (request->in ? transfer->moved : 0));
}

/* Have the device do it: 1 it has been answered, 0 it waits, or negative errno of the socket. */
static int ask(struct vhci *vhci, struct vhci_transfer *transfer)
{
	const struct usbip_request *request = &transfer->request;
	int moved = vhci->transfer(vhci->ctx, request, transfer->answer + USBIP_HEADER,
	                           transfer->moved);
	int err;

	if (moved == -EAGAIN)
		return 0;
	if (moved > 0)
		transfer->moved += (uint32_t)moved;
	if (moved > 0 && !request->in && transfer->moved < request->length)
		return 0;
	err = answer(vhci->fd, transfer, moved < 0 ? moved : 0);
	return err ? err : 1;
}

static void forget(struct vhci *vhci, unsigned i)
{
	vhci->count--;
	memmove(&vhci->waiting[i], &vhci->waiting[i + 1],
	        (vhci->count - i) * sizeof(vhci->waiting[0]));
}

/* The kernel takes a request back; what has been answered is gone already. */
static int unlink_request(struct vhci *vhci, struct vhci_transfer *transfer)
{
	int status = 0;

	for (unsigned i = 0; i < vhci->count; i++) {
		if (vhci->waiting[i].request.seq != transfer->request.unlinked)
			continue;
		forget(vhci, i);
		status = -ECONNRESET;
		break;
	}
	return answer(vhci->fd, transfer, status);
}

int vhci_serve(struct vhci *vhci)
{
	struct vhci_transfer *transfer = &vhci->waiting[vhci->count];
	int err;

	if (vhci->count == VHCI_WAITING)
		return -ENOBUFS;
	transfer->moved = 0;
	err = get(vhci->fd, transfer->answer, USBIP_HEADER);
	if (!err)
		err = usbip_decode(transfer->answer, &transfer->request);
	if (err)
		return err;
	if (transfer->request.command == USBIP_CMD_UNLINK)
		return unlink_request(vhci, transfer);
	if (!transfer->request.in)
		err = get(vhci->fd, transfer->answer + USBIP_HEADER, transfer->request.length);
	if (!err)
		err = ask(vhci, transfer);
	vhci->count += err == 0;
	return err < 0 ? err : 0;
}

int vhci_again(struct vhci *vhci)
{
	for (unsigned i = 0; i < vhci->count;) {
		int err = ask(vhci, &vhci->waiting[i]);

		if (err < 0)
			return err;
		if (err)
			forget(vhci, i);
		else
			i++;
	}
	return 0;
}

bool vhci_waits(const struct vhci *vhci, unsigned endpoint)
{
	for (unsigned i = 0; i < vhci->count; i++) {
		if (vhci->waiting[i].request.endpoint == endpoint)
			return true;
	}
	return false;
}
