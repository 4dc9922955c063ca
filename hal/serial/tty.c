/* SPDX-License-Identifier: MIT */
/* A serial port of this machine, by termios. */
#include <errno.h>
#include <fcntl.h>
#include <linux/serial.h>
#include <poll.h>
#include <stdlib.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include "hal/base/chip_lock.h"
#include "hal/base/time.h"
#include "hal/serial/tty.h"

#define BREAK_NS (5 * NS_PER_MS)
#define WRITE_NS (2 * NS_PER_S)

struct tty {
	struct serial_port port;
	int fd;
	struct termios set;
};

static struct tty *tty_of(struct serial_port *port)
{
	return (struct tty *)port;
}

/* What a device says that was pulled. */
static int gone(int err)
{
	return err == EIO || err == ENXIO || err == ENODEV || err == EBADF ? -ENODEV : -err;
}

static speed_t code_of(unsigned baud)
{
	static const struct {
		unsigned baud;
		speed_t code;
	} speeds[] = {{4800, B4800}, {9600, B9600}, {115200, B115200}};

	for (size_t i = 0; i < sizeof(speeds) / sizeof(speeds[0]); i++)
		if (speeds[i].baud == baud)
			return speeds[i].code;
	return B0;
}

static int tty_speed(struct serial_port *port, unsigned baud)
{
	struct tty *tty = tty_of(port);
	struct termios is;

	port->cost->syscalls += 2;
	cfsetspeed(&tty->set, code_of(baud));
	if (tcsetattr(tty->fd, TCSANOW, &tty->set) || tcgetattr(tty->fd, &is))
		return errno == EINVAL ? -ENOTTY : gone(errno);
	return cfgetospeed(&is) == code_of(baud) ? 0 : -ENOTTY;
}

static int tty_write(struct serial_port *port, const uint8_t *bytes, size_t n)
{
	const struct bus_env *env = port->env;
	int64_t until_ns = bus_now(env) + WRITE_NS;

	while (n) {
		ssize_t sent = write(tty_of(port)->fd, bytes, n);

		port->cost->syscalls++;
		if (sent > 0) {
			port->cost->bytes += (size_t)sent;
			bytes += sent;
			n -= (size_t)sent;
			continue;
		}
		if (sent < 0 && errno != EAGAIN && errno != EINTR)
			return gone(errno);
		if (bus_now(env) >= until_ns)
			return -ETIMEDOUT;
		int ready = env->wait(env->ctx, tty_of(port)->fd, POLLOUT, until_ns);
		if (ready <= 0)
			return ready < 0 ? -ECANCELED : -ETIMEDOUT;
	}
	return 0;
}

/* What has come is there at once, mostly. A port that was pulled is ready, and has nothing. */
static int tty_read(struct serial_port *port, uint8_t *bytes, size_t n, int64_t until_ns)
{
	const struct bus_env *env = port->env;

	for (;;) {
		/* first: on a busy machine something may come between the look and the clock */
		bool late = bus_now(env) >= until_ns;
		ssize_t came = read(tty_of(port)->fd, bytes, n);

		port->cost->syscalls++;
		if (came > 0) {
			port->cost->bytes += (size_t)came;
			return (int)came;
		}
		if (came == 0)
			return -ENODEV;
		if (errno != EAGAIN && errno != EINTR)
			return gone(errno);
		if (late)
			return 0;
		if (env->wait(env->ctx, tty_of(port)->fd, POLLIN, until_ns) < 0)
			return -ECANCELED;
	}
}

static void tty_break(struct serial_port *port)
{
	const struct bus_env *env = port->env;

	if (ioctl(tty_of(port)->fd, TIOCSBRK) < 0)
		return;
	(void)env->wait(env->ctx, -1, 0, bus_now(env) + BREAK_NS);
	(void)ioctl(tty_of(port)->fd, TIOCCBRK);
}

static void tty_close(struct serial_port *port)
{
	int fd = tty_of(port)->fd;

	(void)tcflush(fd, TCIOFLUSH); /* or close() waits for what a stuck adapter does not take */
	(void)ioctl(fd, TIOCNXCL);
	chip_unlock(fd, 0);
	(void)close(fd);
	free(port);
}

static const struct serial_port_ops tty_ops = {
	.speed = tty_speed,
	.write = tty_write,
	.read = tty_read,
	.send_break = tty_break,
	.close = tty_close,
};

/* FTDI's driver gathers answers for 16 ms, unless it is asked not to. Others may refuse. */
static void ask_low_latency(int fd)
{
	struct serial_struct serial;

	if (ioctl(fd, TIOCGSERIAL, &serial) < 0)
		return;
	serial.flags |= ASYNC_LOW_LATENCY;
	(void)ioctl(fd, TIOCSSERIAL, &serial);
}

/* As adapters need it, but for the speed. */
static int set_up(struct tty *tty)
{
	struct termios *set = &tty->set;

	if (tcgetattr(tty->fd, set))
		return -ENOTTY;
	cfmakeraw(set);
	set->c_cflag = (set->c_cflag & ~(tcflag_t)(CRTSCTS | CSTOPB | PARENB)) | CLOCAL | CREAD |
	               CS8;
	set->c_cc[VMIN] =
		1; /* with 0 a read of nothing returns 0, as that of a port that is gone */
	set->c_cc[VTIME] = 0;
	return 0;
}

int tty_open(const char *path, const struct bus_env *env, struct serial_port **port, int *holder)
{
	struct tty *tty = calloc(1, sizeof(*tty));
	int err;

	if (!tty)
		return -ENOMEM;
	*holder = 0;
	tty->port = (struct serial_port){.ops = &tty_ops, .env = env};
	tty->fd = open(path, O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
	err = tty->fd < 0 ? -errno : set_up(tty);
	if (!err)
		err = chip_lock(tty->fd, 0, holder);
	if (err) {
		if (tty->fd >= 0)
			close(tty->fd);
		free(tty);
		return err;
	}
	(void)ioctl(tty->fd, TIOCEXCL);
	ask_low_latency(tty->fd);
	*port = &tty->port;
	return 0;
}
