/* SPDX-License-Identifier: MIT */
/*
 * The process behind the guest's adapter: the simulated network of one scenario, in real time,
 * plugged into the kernel as a USB adapter: an i2c-tiny-usb with the scenario's bridge chips, or a
 * DS2490 on the first wire. An unplugged adapter of the scenario is a USB device that is gone.
 *
 *   simchip SCENARIO        plug an I2C adapter in, and serve until killed
 *   simchip -u SCENARIO     plug a DS2490 in
 *   simchip -c COMMAND...   tell the one that runs; prints its answer
 *
 * Commands are the scenario's own events without their time, `stats`, and of a DS2490 `stall N`,
 * `silent N` (endpoint N, until `well`).
 */
#include <errno.h>
#include <poll.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "hal/sim/adapter.h"
#include "hal/sim/event.h"
#include "hal/sim/scenario.h"
#include "hal/sim/usb/ds2490.h"
#include "tests/kernel/control.h"
#include "tests/kernel/tiny_usb.h"
#include "tests/kernel/vhci.h"

#define LATE_MS 1000 /* a vanished device's port is free again after this */

struct rig {
	struct sim_net net;
	struct sim_adapter adapter;
	struct tiny_usb usb;
	struct sim_ds2490 ds2490;
	bool is_ds2490;
	int64_t poll_ns; /* when the host asks EP1 of the DS2490 next */
	struct vhci vhci;
	int control_fd;
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

static int tiny_transfer(void *ctx, const struct usbip_request *request, uint8_t *data,
                         uint32_t moved)
{
	struct rig *rig = ctx;

	(void)moved;
	if (request->endpoint)
		return -EPIPE;
	return tiny_usb_control(&rig->usb, request->setup, data, request->length);
}

/* The host asks EP1 at its interval, and no sooner. */
static int poll_state(struct rig *rig, uint8_t *data, size_t room)
{
	int64_t t = now(NULL);
	int n;

	if (t < rig->poll_ns)
		return -EAGAIN;
	n = sim_ds2490_interrupt(&rig->ds2490, data, room, t);
	rig->poll_ns = t + sim_ds2490_poll_ns(&rig->ds2490);
	return n;
}

static int ds2490_transfer(void *ctx, const struct usbip_request *request, uint8_t *data,
                           uint32_t moved)
{
	struct rig *rig = ctx;

	switch (request->endpoint) {
	case 0:
		return sim_ds2490_control(&rig->ds2490, request->setup, data, request->length,
		                          now(NULL));
	case 1:
		return poll_state(rig, data, request->length);
	case 2:
		return sim_ds2490_bulk_out(&rig->ds2490, data + moved, request->length - moved,
		                           now(NULL));
	case 3:
		return sim_ds2490_bulk_in(&rig->ds2490, data, request->length, now(NULL));
	}
	return -EPIPE;
}

/* The adapter is at the kernel if and only if the scenario has it plugged in. */
static int follow_plug(struct rig *rig)
{
	if (rig->is_ds2490)
		sim_ds2490_run(&rig->ds2490, now(NULL));
	else
		sim_net_run(&rig->net, now(NULL));
	if (!rig->net.plugged && rig->vhci.fd >= 0) {
		vhci_unplug(&rig->vhci);
		rig->port = (rig->port + 1) % 8;
	} else if (rig->net.plugged && rig->vhci.fd < 0) {
		return vhci_plug(&rig->vhci, rig->port);
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

static void stats_ds2490(const struct sim_ds2490 *chip, char *text, size_t size)
{
	const struct sim_wire *wire = &chip->net->chip[0].wire[0];

	snprintf(text, size,
	         "requests %llu\ntransfers %llu\ncommands %llu\nforbidden %llu\nresets %llu\n"
	         "slots %llu\nwire_us %llu\nconversions %llu\n",
	         (unsigned long long)chip->requests, (unsigned long long)chip->transfers,
	         (unsigned long long)chip->commands, (unsigned long long)sim_ds2490_forbidden(chip),
	         (unsigned long long)wire->resets, (unsigned long long)wire->slots,
	         (unsigned long long)chip->wire_ns / 1000,
	         (unsigned long long)conversions_on(wire));
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

/* Faults of the DS2490 alone; false: it is none of them. */
static bool usb_fault(struct sim_ds2490 *chip, const char *line)
{
	if (strncmp(line, "stall ", 6) == 0)
		chip->stalled |= (uint8_t)(1u << (atoi(line + 6) & 3));
	else if (strncmp(line, "silent ", 7) == 0)
		chip->silent |= (uint8_t)(1u << (atoi(line + 7) & 3));
	else if (strcmp(line, "well") == 0)
		chip->stalled = chip->silent = 0;
	else
		return false;
	return true;
}

static int command(void *ctx, const char *line, char *answer, size_t size)
{
	struct rig *rig = ctx;

	answer[0] = '\0';
	if (strcmp(line, "stats") == 0) {
		if (rig->is_ds2490)
			stats_ds2490(&rig->ds2490, answer, size);
		else
			stats(rig, answer, size);
		return 0;
	}
	if (rig->is_ds2490 && usb_fault(&rig->ds2490, line))
		return 0;
	return sim_scenario_event(&rig->net, line, now(NULL), answer, size);
}

/* Until something may change by itself, for which a transfer may wait. */
static struct timespec until_next(const struct rig *rig)
{
	int64_t next = sim_net_next(&rig->net), t = now(NULL), ns;

	if (rig->is_ds2490 && sim_ds2490_due(&rig->ds2490) < next)
		next = sim_ds2490_due(&rig->ds2490);
	if (vhci_waits(&rig->vhci, 1) && !(rig->ds2490.silent & 2) && rig->poll_ns < next)
		next = rig->poll_ns;
	ns = next <= t ? 0 : next - t;
	if (ns > LATE_MS * INT64_C(1000000))
		ns = LATE_MS * INT64_C(1000000);
	return (struct timespec){ns / 1000000000, ns % 1000000000};
}

static int serve(struct rig *rig)
{
	struct pollfd fds[2];
	struct timespec wait;
	int err;

	for (;;) {
		err = follow_plug(rig);
		if (err)
			return err;
		fds[0] = (struct pollfd){.fd = rig->vhci.fd, .events = POLLIN};
		fds[1] = (struct pollfd){.fd = rig->control_fd, .events = POLLIN};
		wait = until_next(rig);
		if (ppoll(fds, 2, &wait, NULL) < 0 && errno != EINTR)
			return -errno;
		if (fds[1].revents)
			control_serve(rig->control_fd, command, rig);
		err = fds[0].revents ? vhci_serve(&rig->vhci) : 0;
		if (!err)
			err = vhci_again(&rig->vhci);
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
	rig.is_ds2490 = argc == 3 && strcmp(argv[1], "-u") == 0;
	if (argc != 2 && !rig.is_ds2490) {
		fputs("usage: simchip [-u] SCENARIO | simchip -c COMMAND...\n", stderr);
		return 2;
	}
	err = sim_scenario_read(argv[argc - 1], &rig.net, why, sizeof(why));
	if (err) {
		fprintf(stderr, "simchip: %s\n", err == -EINVAL ? why : strerror(-err));
		return 2;
	}
	sim_adapter_init(&rig.adapter, &rig.net, &real_time);
	rig.adapter.adapter.combine = I2C_ANY; /* the kernel sends message by message */
	rig.usb = (struct tiny_usb){.message = message, .ctx = &rig};
	sim_ds2490_init(&rig.ds2490, &rig.net);
	rig.vhci = (struct vhci){
		.fd = -1, .transfer = rig.is_ds2490 ? ds2490_transfer : tiny_transfer, .ctx = &rig};
	rig.control_fd = control_listen();
	err = rig.control_fd < 0 ? rig.control_fd : serve(&rig);
	fprintf(stderr, "simchip: %s\n", strerror(-err));
	return 1;
}
