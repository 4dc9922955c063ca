/* SPDX-License-Identifier: MIT */
/*
 * An I2C adapter for a program that is started with this in LD_PRELOAD: the ioctls of i2c-dev go to
 * the program i2c (i2c.c beside this folder), which listens at the unix socket I2C_SOCKET. So the
 * simulated chips live on when owsd ends. The file that is opened may be any. One connection for
 * each transfer.
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <linux/i2c-dev.h>
#include <linux/i2c.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#define MOST 65536

static int (*next_ioctl)(int, unsigned long, ...);
static __thread uint16_t address; /* each bus has a thread, and opens one adapter here */

__attribute__((constructor)) static void prepare(void)
{
	*(void **)&next_ioctl = dlsym(RTLD_NEXT, "ioctl");
}

static int connected(void)
{
	struct sockaddr_un to = {.sun_family = AF_UNIX};
	const char *path = getenv("I2C_SOCKET");
	int fd = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);

	strncpy(to.sun_path, path ? path : "", sizeof(to.sun_path) - 1);
	if (fd >= 0 && connect(fd, (struct sockaddr *)&to, sizeof(to))) {
		close(fd);
		fd = -1;
	}
	return fd;
}

/* Of each message: address, 1 for reading, length; then the bytes that are written. */
static size_t pack(const struct i2c_rdwr_ioctl_data *data, uint8_t *bytes)
{
	size_t n = 0;

	for (unsigned i = 0; i < data->nmsgs; i++) {
		const struct i2c_msg *msg = &data->msgs[i];

		if (n + 4 + msg->len > MOST)
			return 0;
		bytes[n++] = (uint8_t)msg->addr;
		bytes[n++] = msg->flags & I2C_M_RD ? 1 : 0;
		bytes[n++] = (uint8_t)msg->len;
		bytes[n++] = (uint8_t)(msg->len >> 8);
		if (!(msg->flags & I2C_M_RD)) {
			memcpy(bytes + n, msg->buf, msg->len);
			n += msg->len;
		}
	}
	return n;
}

/* The answer: the error's number, then the bytes that were read. */
static int unpack(const struct i2c_rdwr_ioctl_data *data, const uint8_t *bytes, size_t n)
{
	size_t at = 1;

	if (bytes[0])
		return bytes[0];
	for (unsigned i = 0; i < data->nmsgs; i++) {
		struct i2c_msg *msg = &data->msgs[i];

		if (!(msg->flags & I2C_M_RD))
			continue;
		if (at + msg->len > n)
			return EIO;
		memcpy(msg->buf, bytes + at, msg->len);
		at += msg->len;
	}
	return 0;
}

static int transfer(const struct i2c_rdwr_ioctl_data *data)
{
	uint8_t bytes[MOST];
	size_t length = pack(data, bytes);
	int fd = connected(), err = ENODEV;
	ssize_t n;

	if (fd < 0)
		return ENODEV;
	if (length && send(fd, bytes, length, MSG_NOSIGNAL) == (ssize_t)length) {
		n = recv(fd, bytes, sizeof(bytes), 0);
		err = n > 0 ? unpack(data, bytes, (size_t)n) : ENODEV;
	}
	close(fd);
	return err;
}

/* The calls that the driver makes: a byte each way, and a byte after a command. */
static int smbus(const struct i2c_smbus_ioctl_data *call)
{
	uint8_t bytes[2] = {call->command, 0};
	struct i2c_msg msg = {.addr = address, .len = 1, .buf = bytes};
	struct i2c_rdwr_ioctl_data data = {.msgs = &msg, .nmsgs = 1};

	if (call->size == I2C_SMBUS_BYTE && call->read_write == I2C_SMBUS_READ) {
		msg.flags = I2C_M_RD;
		msg.buf = &call->data->byte;
	} else if (call->size == I2C_SMBUS_BYTE_DATA && call->read_write == I2C_SMBUS_WRITE) {
		bytes[1] = call->data->byte;
		msg.len = 2;
	} else if (call->size != I2C_SMBUS_BYTE) {
		return EOPNOTSUPP;
	}
	return transfer(&data);
}

int ioctl(int fd, unsigned long request, ...)
{
	va_list list;
	void *value;
	int err = 0;

	va_start(list, request);
	value = va_arg(list, void *);
	va_end(list);
	switch (request) {
	case I2C_FUNCS:
		*(unsigned long *)value = I2C_FUNC_I2C;
		break;
	case I2C_SLAVE:
		address = (uint16_t)(uintptr_t)value;
		break;
	case I2C_TIMEOUT:
		break;
	case I2C_RDWR:
		err = transfer(value);
		break;
	case I2C_SMBUS:
		err = smbus(value);
		break;
	default:
		return next_ioctl(fd, request, value);
	}
	errno = err ? err : errno;
	return err ? -1 : 0;
}
