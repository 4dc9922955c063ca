/* SPDX-License-Identifier: MIT */
/* An I2C adapter of the kernel, by i2c-dev and libi2c. */
#include <errno.h>
#include <stdbool.h>

#include "hal/base/chip_lock.h"
#include "hal/ds2482/i2c_dev.h"

#ifdef OWSD_LIBI2C

#include <fcntl.h>
#include <i2c/smbus.h>
#include <linux/i2c-dev.h>
#include <linux/i2c.h>
#include <stdlib.h>
#include <sys/ioctl.h>
#include <unistd.h>

/* In units of 10 ms: an I2C transaction of owsd takes 20 ms at most. */
#define TIMEOUT_10MS 10

struct i2c_dev {
	struct i2c_adapter adapter; /* first */
	int fd;
	int address; /* the address set on the descriptor; -1: none */
};

/* Map the errors that adapter drivers use for a refusal to the ones of i2c.h. */
static int i2c_error(int err, bool first)
{
	switch (err) {
	case ENODEV:
	case ESHUTDOWN:
	case EBADF:
		return -ENODEV;
	case EREMOTEIO:
		return first ? -ENXIO : -EIO;
	case ENXIO:
		return -ENXIO;
	case EBUSY:
		return -EBUSY;
	case ETIMEDOUT:
		return -ETIMEDOUT;
	case EOPNOTSUPP:
	case EINVAL:
		return -EOPNOTSUPP;
	default:
		return -EIO;
	}
}

static int dev_transfer(struct i2c_adapter *base, uint8_t address, struct i2c_message *messages,
                        size_t n)
{
	struct i2c_dev *dev = (struct i2c_dev *)base;
	struct i2c_msg msgs[I2C_RDWR_IOCTL_MAX_MSGS];
	struct i2c_rdwr_ioctl_data data = {.msgs = msgs, .nmsgs = (uint32_t)n};

	if (n == 0 || n > base->max_messages || base->combine == I2C_SMBUS_ONLY)
		return -EOPNOTSUPP;
	base->transfers++;
	base->syscalls++;
	for (size_t i = 0; i < n; i++) {
		bool read = messages[i].flags & I2C_MESSAGE_READ;

		msgs[i] = (struct i2c_msg){.addr = address,
		                           .flags = read ? I2C_M_RD : 0,
		                           .len = messages[i].len,
		                           .buf = messages[i].data};
		base->bytes += messages[i].len + 1u;
	}
	return ioctl(dev->fd, I2C_RDWR, &data) < 0 ? i2c_error(errno, false) : 0;
}

static int set_address(struct i2c_dev *dev, uint8_t address)
{
	if (dev->address == address)
		return 0;
	dev->adapter.syscalls++;
	if (ioctl(dev->fd, I2C_SLAVE, (long)address) < 0)
		return i2c_error(errno, true);
	dev->address = address;
	return 0;
}

static void i2c_dev_count(struct i2c_dev *dev, unsigned bytes)
{
	dev->adapter.transfers++;
	dev->adapter.syscalls++;
	dev->adapter.bytes += bytes;
}

static int dev_write_byte(struct i2c_adapter *base, uint8_t address, uint8_t command)
{
	struct i2c_dev *dev = (struct i2c_dev *)base;
	int err = set_address(dev, address);

	if (err)
		return err;
	i2c_dev_count(dev, 2);
	return i2c_smbus_write_byte(dev->fd, command) < 0 ? i2c_error(errno, true) : 0;
}

static int dev_write_byte_data(struct i2c_adapter *base, uint8_t address, uint8_t command,
                               uint8_t data)
{
	struct i2c_dev *dev = (struct i2c_dev *)base;
	int err = set_address(dev, address);

	if (err)
		return err;
	i2c_dev_count(dev, 3);
	return i2c_smbus_write_byte_data(dev->fd, command, data) < 0 ? i2c_error(errno, false) : 0;
}

static int dev_read_byte(struct i2c_adapter *base, uint8_t address)
{
	struct i2c_dev *dev = (struct i2c_dev *)base;
	int byte = set_address(dev, address);

	if (byte)
		return byte;
	i2c_dev_count(dev, 2);
	byte = i2c_smbus_read_byte(dev->fd);
	return byte < 0 ? i2c_error(errno, true) : byte;
}

static int dev_claim(struct i2c_adapter *base, uint8_t address)
{
	struct i2c_dev *dev = (struct i2c_dev *)base;
	int err;

	dev->address = -1; /* the next call sets the address again, and the kernel checks it */
	err = set_address(dev, address);
	return err ? err : chip_lock(dev->fd, address, &base->holder);
}

static void dev_release(struct i2c_adapter *base, uint8_t address)
{
	chip_unlock(((struct i2c_dev *)base)->fd, address);
}

static void dev_close(struct i2c_adapter *base)
{
	struct i2c_dev *dev = (struct i2c_dev *)base;

	close(dev->fd);
	free(dev);
}

static const struct i2c_adapter_ops i2c_dev_ops = {
	.transfer = dev_transfer,
	.write_byte = dev_write_byte,
	.write_byte_data = dev_write_byte_data,
	.read_byte = dev_read_byte,
	.claim = dev_claim,
	.release = dev_release,
	.close = dev_close,
};

int i2c_dev_open(const char *path, struct i2c_adapter **adapter)
{
	struct i2c_dev *dev = calloc(1, sizeof(*dev));
	unsigned long functions = 0;
	int err;

	if (!dev)
		return -ENOMEM;
	dev->fd = open(path, O_RDWR | O_CLOEXEC);
	if (dev->fd < 0) {
		err = -errno;
		free(dev);
		return err;
	}
	if (ioctl(dev->fd, I2C_FUNCS, &functions) < 0) {
		err = -errno;
		close(dev->fd);
		free(dev);
		return err;
	}
	dev->address = -1;
	dev->adapter.ops = &i2c_dev_ops;
	dev->adapter.max_messages = I2C_RDWR_IOCTL_MAX_MSGS;
	(void)ioctl(dev->fd, I2C_TIMEOUT, (long)TIMEOUT_10MS);
	if (functions & I2C_FUNC_I2C)
		dev->adapter.combine = I2C_ANY;
	*adapter = &dev->adapter;
	return 0;
}

#else

int i2c_dev_open(const char *path, struct i2c_adapter **adapter)
{
	(void)path, (void)adapter;
	return -EOPNOTSUPP;
}

#endif
