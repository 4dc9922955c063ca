/* SPDX-License-Identifier: MIT */
/* Sets up the driver of the DS9490R over simulated ones, on a virtual clock. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "hal/native/native.h"
#include "hal/sim/crc.h"
#include "hal/sim/event.h"
#include "hal/sim/scenario.h"
#include "tests/unit/aid/usb_scene.h"

#define FRAME (HOST_MS / 4) /* what a transfer takes of USB, but for the interrupt endpoint */

struct usb_scene sticks;
static unsigned next_device;

static struct usb_stick *stick_of(struct usb_port *port)
{
	return (struct usb_stick *)port;
}

/* What each transfer meets: an error that the test has ordered, or its adapter gone. */
static int meet(struct usb_stick *stick, int64_t ns)
{
	sticks.host.now += ns;
	if (++sticks.transfers == sticks.fail_at && !sticks.pulls)
		return sticks.fail;
	if (sticks.pulls && sticks.transfers >= sticks.fail_at)
		stick_pull(&sticks.stick[0]);
	return stick->plugged ? 0 : -ENODEV;
}

static int answer(int moved)
{
	if (moved >= 0 || moved == -ENODEV)
		return moved;
	if (moved != -EAGAIN)
		return -EIO;
	sticks.host.now += USB_TIMEOUT_MS * HOST_MS;
	return -ETIMEDOUT;
}

static int port_control(struct usb_port *port, uint8_t request, uint16_t value, uint16_t index)
{
	struct usb_stick *stick = stick_of(port);
	const uint8_t setup[8] = {0x40,           request,
	                          (uint8_t)value, (uint8_t)(value >> 8),
	                          (uint8_t)index, (uint8_t)(index >> 8)};
	int err = meet(stick, FRAME);

	return err ? err
	           : answer(sim_ds2490_control(&stick->chip, setup, NULL, 0, sticks.host.now));
}

static int bulk_in(struct usb_stick *stick, uint8_t *bytes, size_t n)
{
	int moved = sim_ds2490_bulk_in(&stick->chip, bytes, n, sticks.host.now);

	if (moved != -EAGAIN)
		return answer(moved);
	sticks.host.now += USB_TIMEOUT_MS * HOST_MS;
	moved = sim_ds2490_bulk_in(&stick->chip, bytes, n, sticks.host.now);
	return moved == -EAGAIN ? -ETIMEDOUT : answer(moved);
}

static int port_transfer(struct usb_port *port, uint8_t endpoint, uint8_t *bytes, size_t n)
{
	struct usb_stick *stick = stick_of(port);
	bool state = endpoint == USB_STATE;
	int err = meet(stick, state ? sim_ds2490_poll_ns(&stick->chip) : FRAME);

	if (err)
		return err;
	if (state) {
		int len = answer(sim_ds2490_interrupt(&stick->chip, bytes, n, sticks.host.now));

		return stick->mute && len > DS2490_STATE ? DS2490_STATE : len;
	}
	if (endpoint == USB_IN)
		return bulk_in(stick, bytes, n);
	return answer(sim_ds2490_bulk_out(&stick->chip, bytes, n, sticks.host.now));
}

static int ask(struct usb_stick *stick, uint8_t type, uint8_t request, uint8_t value, uint8_t index)
{
	const uint8_t setup[8] = {type, request, value, 0, index};

	return answer(sim_ds2490_control(&stick->chip, setup, NULL, 0, sticks.host.now));
}

static int port_clear(struct usb_port *port)
{
	static const uint8_t endpoints[] = {USB_STATE, USB_OUT, USB_IN};
	int err = meet(stick_of(port), FRAME);

	for (unsigned i = 0; !err && i < sizeof(endpoints); i++)
		err = ask(stick_of(port), 0x02, 1, 0, endpoints[i]);
	return err;
}

static int configure(struct usb_stick *stick)
{
	int err = ask(stick, 0x00, 9, 1, 0);

	return err ? err : ask(stick, 0x01, 11, 3, 0);
}

static int port_reset(struct usb_port *port)
{
	struct usb_stick *stick = stick_of(port);
	int err = meet(stick, 50 * HOST_MS);

	stick->resets++;
	if (!stick->deaf)
		stick->chip.silent = 0;
	return err ? err : configure(stick);
}

static void port_close(struct usb_port *port)
{
	stick_of(port)->open = false;
}

static const struct usb_port_ops port_ops = {
	.control = port_control,
	.transfer = port_transfer,
	.clear = port_clear,
	.reset = port_reset,
	.close = port_close,
};

static unsigned list(struct usb_place places[USB_PLACES])
{
	unsigned n = 0;

	for (unsigned i = 0; i < sticks.sticks; i++)
		if (sticks.stick[i].plugged)
			places[n++] = sticks.stick[i].place;
	return n;
}

static struct usb_stick *stick_at(const struct usb_place *place)
{
	for (unsigned i = 0; i < sticks.sticks; i++)
		if (sticks.stick[i].plugged && !strcmp(sticks.stick[i].place.device, place->device))
			return &sticks.stick[i];
	return NULL;
}

static int open_stick(const struct usb_place *place, struct usb_port **port, char *why, size_t size)
{
	struct usb_stick *stick = stick_at(place);

	if (!stick || stick->refuses || stick->open) {
		snprintf(why, size, "%s cannot be opened", place->name);
		return !stick ? -ENODEV : stick->open ? -EBUSY : stick->refuses;
	}
	stick->opens++;
	stick->open = true;
	stick->kernel = false;
	stick->port.ops = &port_ops;
	*port = &stick->port;
	return configure(stick);
}

static void give_back(const struct usb_place *place)
{
	struct usb_stick *stick = stick_at(place);

	if (stick)
		stick->kernel = true;
}

const struct usb_system sticks_system = {.list = list, .open = open_stick, .give_back = give_back};

void sticks_begin(void)
{
	memset(&sticks, 0, sizeof(sticks));
	host_init_virtual(&sticks.host);
	sticks.host.now = HOST_S;
}

void sticks_end(void)
{
	if (sticks.master)
		sticks.master->ops->destroy(sticks.master);
	sticks.master = NULL;
	for (unsigned i = 0; i < sticks.sticks; i++)
		sim_net_clear(&sticks.stick[i].net);
	sticks.sticks = 0;
}

void stick_pull(struct usb_stick *stick)
{
	stick->plugged = false;
}

void stick_plug(struct usb_stick *stick, const char *port)
{
	snprintf(stick->place.name, sizeof(stick->place.name), "%s", port);
	snprintf(stick->place.device, sizeof(stick->place.device), "/dev/bus/usb/001/%03u",
	         ++next_device);
	stick->plugged = true;
	stick->open = false;
	stick->kernel = true;
	sim_ds2490_init(&stick->chip, &stick->net);
}

struct usb_stick *stick_add(const char *scenario)
{
	struct usb_stick *stick = &sticks.stick[sticks.sticks++];
	char port[8];

	TEST_ASSERT_EQUAL_INT_MESSAGE(
		0,
		sim_scenario_parse("test", scenario, &stick->net, sticks.why, sizeof(sticks.why)),
		sticks.why);
	sim_net_start(&stick->net, sticks.host.now);
	snprintf(port, sizeof(port), "1-%u", sticks.sticks);
	stick_plug(stick, port);
	return stick;
}

void stick_event(struct usb_stick *stick, const char *text)
{
	TEST_ASSERT_EQUAL_INT_MESSAGE(0,
	                              sim_scenario_event(&stick->net, text, sticks.host.now,
	                                                 sticks.why, sizeof(sticks.why)),
	                              sticks.why);
}

void sticks_make(const char *where)
{
	TEST_ASSERT_EQUAL_INT_MESSAGE(0,
	                              usb_create(&sticks_system, where, &sticks.host.env,
	                                         &sticks.master, sticks.why, sizeof(sticks.why)),
	                              sticks.why);
}

int sticks_try(void)
{
	int err = sticks.master->ops->open(sticks.master, sticks.why, sizeof(sticks.why));

	sticks.wire = sticks.master->ops->channel(sticks.master, 0);
	return err;
}

void sticks_start(const char *scenario)
{
	stick_add(scenario);
	sticks_make("");
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, sticks_try(), sticks.why);
}

static int create(const char *where, const struct bus_env *env, struct link_master **master,
                  char *why, size_t size)
{
	return usb_create(&sticks_system, where, env, master, why, size);
}

struct bus *sticks_bus(const char *scenario)
{
	static struct link_master_ops of_bus;
	static const struct bus_ops ops = {NATIVE_BUS_SLOTS};
	struct bus *bus;

	of_bus = usb_master_ops;
	of_bus.create = create;
	stick_add(scenario);
	TEST_ASSERT_EQUAL_INT(0, native_create(&ops, &of_bus, "", &sticks.host.env, &bus,
	                                       sticks.why, sizeof(sticks.why)));
	host_run(&sticks.host, bus, sticks.host.now + 10 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(1, host_events(&sticks.host, BUS_UP));
	return bus;
}

int sticks_scratchpad(const char *name, uint8_t scratchpad[9])
{
	uint8_t out[10] = {0x55};
	const struct link_part part = {
		.reset = true, .out = out, .out_n = 10, .in = scratchpad, .in_n = 9};

	memcpy(out + 1, sim_net_slave(&sticks.stick[0].net, name)->rom, 8);
	out[9] = 0xBE;
	return sticks.wire->ops->run(sticks.wire, &part);
}

void sticks_check(const char *name)
{
	uint8_t scratchpad[9];

	TEST_ASSERT_EQUAL_INT(0, sticks_scratchpad(name, scratchpad));
	TEST_ASSERT_EQUAL_HEX8(0x50, scratchpad[0]);
	TEST_ASSERT_EQUAL_HEX8(0x05, scratchpad[1]);
	TEST_ASSERT_EQUAL_HEX8(0, sim_crc8(0, scratchpad, 9));
}
