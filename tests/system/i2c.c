/* SPDX-License-Identifier: MIT */
/*
 * i2c SCENARIO SOCKET: simulated chips behind an I2C adapter that live as long as this process.
 * owsd has them through preload/i2c.c. It listens at the unix socket: a packet of a connection is a
 * transfer, an empty connection asks for the thermometers. These are lines of
 *
 *   id (family first), TH and TL of the scratchpad, TH and TL of the EEPROM, copies to the EEPROM
 *
 * The wire is the whole network of the scenario, whose times are added to the real ones.
 */
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <time.h>
#include <unistd.h>

#include "hal/sim/adapter.h"
#include "hal/sim/chips/thermometer.h"
#include "hal/sim/scenario.h"

#define MOST 65536
#define MESSAGES 42
#define CHIPS 64

static int64_t spent_ns;
static unsigned copies[CHIPS];
static bool copied[CHIPS];

static int64_t now(void *ctx)
{
	struct timespec time;

	(void)ctx;
	clock_gettime(CLOCK_MONOTONIC, &time);
	return (int64_t)time.tv_sec * 1000000000 + time.tv_nsec + spent_ns;
}

static int wait_until(void *ctx, int fd, short events, int64_t until_ns)
{
	int64_t at = now(ctx);

	(void)fd, (void)events;
	spent_ns += until_ns > at ? until_ns - at : 0;
	return 0;
}

/* The thermometers of all wires in turn; NULL: there are no more. */
static struct sim_slave *thermometer(const struct sim_net *net, unsigned number)
{
	for (unsigned c = 0; c < net->chips; c++)
		for (unsigned w = 0; w < net->chip[c].channels; w++)
			for (size_t i = 0; i < net->chip[c].wire[w].count; i++) {
				struct sim_slave *slave = net->chip[c].wire[w].slaves[i];

				if ((slave->rom[0] == 0x28 || slave->rom[0] == 0x22) && !number--)
					return slave;
			}
	return NULL;
}

/* A copy takes longer than a transfer, so none begins and ends within one. */
static void count_copies(const struct sim_net *net)
{
	const struct sim_slave *slave;

	for (unsigned i = 0; i < CHIPS && (slave = thermometer(net, i)); i++) {
		const struct sim_thermometer *chip = slave->state;

		copies[i] += chip->copying && !copied[i];
		copied[i] = chip->copying;
	}
}

static size_t tell(const struct sim_net *net, char *text, size_t size)
{
	const struct sim_slave *slave;
	size_t n = 0;

	for (unsigned i = 0; i < CHIPS && n < size && (slave = thermometer(net, i)); i++) {
		const struct sim_thermometer *chip = slave->state;
		const uint8_t *rom = slave->rom;

		n += (size_t)snprintf(text + n, size - n,
		                      "%02X.%02X%02X%02X%02X%02X%02X %d %d %d %d %u\n", rom[0],
		                      rom[1], rom[2], rom[3], rom[4], rom[5], rom[6],
		                      (int8_t)chip->scratchpad[2], (int8_t)chip->scratchpad[3],
		                      (int8_t)chip->eeprom[0], (int8_t)chip->eeprom[1], copies[i]);
	}
	return n < size ? n : size - 1;
}

/* The messages of a packet, each read one with a place for its bytes in answer. 0: not whole. */
static unsigned parse(uint8_t *bytes, size_t n, struct i2c_message *messages, uint8_t *answer,
                      size_t *length)
{
	unsigned count = 0;
	size_t at = 0;

	*length = 1;
	while (at + 4 <= n && count < MESSAGES) {
		struct i2c_message *message = &messages[count++];

		message->flags = bytes[at + 1] ? I2C_MESSAGE_READ : 0;
		message->len = (uint16_t)(bytes[at + 2] | bytes[at + 3] << 8);
		at += 4;
		message->data = message->flags ? answer + *length : bytes + at;
		*(message->flags ? length : &at) += message->len;
		if (at > n || *length > MOST)
			return 0;
	}
	return at == n ? count : 0;
}

static void serve(struct sim_adapter *adapter, int fd)
{
	static uint8_t bytes[MOST], answer[MOST];
	struct i2c_message messages[MESSAGES];
	ssize_t n = recv(fd, bytes, sizeof(bytes), 0);
	size_t length;
	unsigned count;

	if (n <= 0) {
		length = tell(adapter->net, (char *)answer, sizeof(answer));
		(void)!write(fd, answer, length);
		return;
	}
	count = parse(bytes, (size_t)n, messages, answer, &length);
	int err = count ? adapter->adapter.ops->transfer(&adapter->adapter, bytes[0], messages,
	                                                 count)
	                : -EINVAL;
	answer[0] = (uint8_t)-err;
	count_copies(adapter->net);
	(void)!send(fd, answer, err ? 1 : length, MSG_NOSIGNAL);
}

static int listening(const char *path)
{
	struct sockaddr_un at = {.sun_family = AF_UNIX};
	int fd = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);

	if (fd < 0 || strlen(path) >= sizeof(at.sun_path))
		return -1;
	memcpy(at.sun_path, path, strlen(path));
	return bind(fd, (struct sockaddr *)&at, sizeof(at)) || listen(fd, 64) ? -1 : fd;
}

int main(int argc, char **argv)
{
	static const struct bus_env env = {.now = now, .wait = wait_until};
	static struct sim_net net;
	static struct sim_adapter adapter;
	char why[256];
	int fd;

	if (argc != 3) {
		fprintf(stderr, "usage: i2c SCENARIO SOCKET\n");
		return 2;
	}
	if (sim_scenario_read(argv[1], &net, why, sizeof(why))) {
		fprintf(stderr, "%s\n", why);
		return 1;
	}
	sim_adapter_init(&adapter, &net, &env);
	sim_net_start(&net, now(NULL));
	fd = listening(argv[2]);
	for (int one; fd >= 0 && (one = accept(fd, NULL, NULL)) >= 0; close(one))
		serve(&adapter, one);
	perror(argv[2]);
	return 1;
}
