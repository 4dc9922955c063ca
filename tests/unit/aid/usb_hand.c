/* SPDX-License-Identifier: MIT */
/* The host of a simulated DS2490. */
#include <string.h>

#include "unity.h"

#include "hal/sim/event.h"
#include "hal/sim/scenario.h"
#include "tests/unit/aid/usb_hand.h"

struct usb_hand usb;

int usb_request(uint8_t type, uint8_t request, unsigned value, unsigned index, unsigned len)
{
	const uint8_t setup[8] = {
		type,           request,
		(uint8_t)value, (uint8_t)(value >> 8),
		(uint8_t)index, (uint8_t)(index >> 8),
		(uint8_t)len,   (uint8_t)(len >> 8),
	};

	return sim_ds2490_control(&usb.chip, setup, usb.data, sizeof(usb.data), usb.now);
}

void usb_control(unsigned code)
{
	TEST_ASSERT_EQUAL_INT(0, usb_request(0x40, DS2490_CONTROL, code, 0, 0));
}

void usb_mode(unsigned code, unsigned value)
{
	TEST_ASSERT_EQUAL_INT(0, usb_request(0x40, DS2490_MODE, code, value, 0));
}

void usb_comm(unsigned code, unsigned parameter)
{
	TEST_ASSERT_EQUAL_INT(0, usb_request(0x40, DS2490_COMM, code, parameter, 0));
}

int usb_look(void)
{
	int n = sim_ds2490_interrupt(&usb.chip, usb.state, sizeof(usb.state), usb.now);

	TEST_ASSERT_GREATER_OR_EQUAL_INT(DS2490_STATE, n);
	return n - DS2490_STATE;
}

bool usb_has(uint8_t flag)
{
	usb_look();
	return usb.state[DS2490_AT_FLAGS] & flag;
}

int64_t usb_finish(void)
{
	int64_t begun = usb.now, due;

	while ((due = sim_ds2490_due(&usb.chip)) != INT64_MAX) {
		usb.now = due > usb.now ? due : usb.now;
		sim_ds2490_run(&usb.chip, usb.now);
	}
	return usb.now - begun;
}

void usb_out(const void *bytes, size_t n)
{
	TEST_ASSERT_EQUAL_INT((int)n, sim_ds2490_bulk_out(&usb.chip, bytes, n, usb.now));
}

int usb_in(size_t room)
{
	memset(usb.data, 0, sizeof(usb.data));
	return sim_ds2490_bulk_in(&usb.chip, usb.data, room, usb.now);
}

uint8_t usb_result_of(unsigned code, unsigned parameter)
{
	usb_comm(code | DS2490_IM | DS2490_NTF, parameter);
	usb_finish();
	TEST_ASSERT_EQUAL_INT(1, usb_look());
	return usb.state[DS2490_STATE];
}

void usb_event(const char *text)
{
	char why[128];

	TEST_ASSERT_EQUAL_INT(0, sim_scenario_event(&usb.net, text, usb.now, why, sizeof(why)));
}

void usb_begin(const char *scenario)
{
	char why[256] = "";

	usb.now = 1000 * USB_MS;
	usb.allowed = 0;
	TEST_ASSERT_EQUAL_INT_MESSAGE(
		0, sim_scenario_parse("test", scenario, &usb.net, why, sizeof(why)), why);
	sim_ds2490_init(&usb.chip, &usb.net);
	TEST_ASSERT_EQUAL_INT(0, usb_request(0x00, 9, 1, 0, 0));
	TEST_ASSERT_EQUAL_INT(0, usb_request(0x01, 11, 3, 0, 0));
}

void usb_end(void)
{
	TEST_ASSERT_EQUAL_UINT64(usb.allowed, sim_ds2490_forbidden(&usb.chip));
	sim_net_clear(&usb.net);
}
