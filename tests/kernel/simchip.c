/* SPDX-License-Identifier: MIT */
/*
 * The process behind the guest's I2C adapter: the simulated network of one scenario, in real time,
 * plugged into the kernel as a USB adapter. An unplugged adapter of the scenario is a USB device
 * that is gone.
 *
 *   simchip SCENARIO        plug in and serve until killed
 *   simchip -c COMMAND...   tell the one that runs; prints its answer
 *
 * Commands are the scenario's own events without their time, and `stats`.
 */
#include <errno.h>
#include <poll.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "hal/sim/adapter.h"
#include "hal/sim/event.h"
#include "hal/sim/scenario.h"
#include "tests/kernel/control.h"
#include "tests/kernel/vhci.h"

#define LATE_MS 1000 /* a vanished device's port is free again after this */

struct rig {
	struct sim_net net;
	struct sim_adapter adapter;
	struct tiny_usb usb;
	int usb_fd, control_fd; /* usb_fd -1: unplugged */
	unsigned port;
};

static int64_t now(void *ctx)
{
	struct timespec time;

	(void)ctx;
	clock_gettime(CLOCK_MONOTONIC, &time);
	return (int64_t)time.tv_sec * 1000000000 + time.tv_nsec;
}

/* To sleep and be woken takes the guest's one processor longer than this. */
#define SHORT_NS 500000

/*
 * A message is answered when its last bit is through. A model whose clock ran ahead of the kernel's
 * would cut short what a driver waits for by that one: a conversion under strong pull-up.
 */
static int wait_until(void *ctx, int fd, short events, int64_t until_ns)
{
	int64_t sleep_ns = until_ns - SHORT_NS;
	struct timespec until = {.tv_sec = sleep_ns / 1000000000, .tv_nsec = sleep_ns % 1000000000};

	(void)fd;
	(void)events;
	if (now(ctx) < sleep_ns)
		clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, NULL);
	while (now(ctx) < until_ns)
		;
	return 0;
}

static const struct bus_env real_time = {.now = now, .wait = wait_until};

static int message(void *ctx, uint8_t address, bool read, uint8_t *data, size_t len)
{
	struct rig *rig = ctx;
	struct i2c_message one = {
		.flags = read ? I2C_MESSAGE_READ : 0, .len = (uint16_t)len, .data = data};

	return rig->adapter.adapter.ops->transfer(&rig->adapter.adapter, address, &one, 1);
}

/* The adapter is at the kernel if and only if the scenario has it plugged in. */
static int follow_plug(struct rig *rig)
{
	sim_net_run(&rig->net, now(NULL));
	if (!rig->net.plugged && rig->usb_fd >= 0) {
		close(rig->usb_fd);
		rig->usb_fd = -1;
		rig->port = (rig->port + 1) % 8;
	} else if (rig->net.plugged && rig->usb_fd < 0) {
		rig->usb_fd = vhci_plug(rig->port);
		if (rig->usb_fd < 0)
			return rig->usb_fd;
	}
	return 0;
}

static uint64_t conversions_on(const struct sim_wire *wire)
{
	uint64_t sum = 0;

	for (size_t i = 0; i < wire->count; i++)
		sum += wire->slaves[i]->conversions;
	return sum;
}

static void stats(const struct rig *rig, char *text, size_t size)
{
	unsigned long long resets = 0, slots = 0, wire_ns = 0, conversions = 0;

	for (unsigned i = 0; i < rig->net.chips; i++) {
		wire_ns += (unsigned long long)rig->net.chip[i].wire_ns;
		for (unsigned n = 0; n < rig->net.chip[i].channels; n++) {
			resets += rig->net.chip[i].wire[n].resets;
			slots += rig->net.chip[i].wire[n].slots;
			conversions += conversions_on(&rig->net.chip[i].wire[n]);
		}
	}
	snprintf(
		text, size,
		"messages %llu\nbytes %llu\nresets %llu\nslots %llu\nwire_us %llu\nconversions %llu\n",
		(unsigned long long)rig->adapter.adapter.transfers,
		(unsigned long long)rig->adapter.adapter.bytes, resets, slots, wire_ns / 1000,
		conversions);
}

static int command(void *ctx, const char *line, char *answer, size_t size)
{
	struct rig *rig = ctx;

	answer[0] = '\0';
	if (strcmp(line, "stats") == 0) {
		stats(rig, answer, size);
		return 0;
	}
	return sim_scenario_event(&rig->net, line, now(NULL), answer, size);
}

static int timeout_ms(const struct rig *rig)
{
	int64_t next = sim_net_next(&rig->net);
	int64_t ms = (next - now(NULL)) / 1000000 + 1;

	if (next == INT64_MAX || ms > LATE_MS)
		return LATE_MS;
	return ms < 0 ? 0 : (int)ms;
}

static int serve(struct rig *rig)
{
	struct pollfd fds[2];
	int err;

	for (;;) {
		err = follow_plug(rig);
		if (err)
			return err;
		fds[0] = (struct pollfd){.fd = rig->usb_fd, .events = POLLIN};
		fds[1] = (struct pollfd){.fd = rig->control_fd, .events = POLLIN};
		if (poll(fds, 2, timeout_ms(rig)) < 0 && errno != EINTR)
			return -errno;
		if (fds[1].revents)
			control_serve(rig->control_fd, command, rig);
		if (!fds[0].revents)
			continue;
		err = vhci_serve(rig->usb_fd, &rig->usb);
		if (err)
			return err;
	}
}

int main(int argc, char **argv)
{
	static struct rig rig;
	char why[256] = "";
	int err;

	if (argc > 2 && strcmp(argv[1], "-c") == 0)
		return control_tell(argc - 2, argv + 2);
	if (argc != 2) {
		fputs("usage: simchip SCENARIO | simchip -c COMMAND...\n", stderr);
		return 2;
	}
	err = sim_scenario_read(argv[1], &rig.net, why, sizeof(why));
	if (err) {
		fprintf(stderr, "simchip: %s\n", err == -EINVAL ? why : strerror(-err));
		return 2;
	}
	sim_adapter_init(&rig.adapter, &rig.net, &real_time);
	rig.adapter.adapter.combine = I2C_ANY; /* the kernel sends message by message */
	rig.usb = (struct tiny_usb){.message = message, .ctx = &rig};
	rig.usb_fd = -1;
	rig.control_fd = control_listen();
	err = rig.control_fd < 0 ? rig.control_fd : serve(&rig);
	fprintf(stderr, "simchip: %s\n", strerror(-err));
	return 1;
}
