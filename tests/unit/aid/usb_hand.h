/* SPDX-License-Identifier: MIT */
/* Works a simulated DS2490 by hand, as the host does: its transfers on a virtual clock. */
#pragma once

#include "hal/sim/usb/ds2490.h"

#define USB_US INT64_C(1000)
#define USB_MS INT64_C(1000000)

struct usb_hand {
	struct sim_net net;
	struct sim_ds2490 chip;
	int64_t now;
	uint8_t state[32], data[256]; /* what EP1, and what EP0 or EP3 gave last */
	uint64_t allowed;             /* of what is forbidden, by the test itself */
};
extern struct usb_hand usb;

/* On the wire of a scenario, configured, with alternate setting 3. */
void usb_begin(const char *scenario);
/* And nothing was forbidden but what the test allowed. */
void usb_end(void);
/* Of type setup[0]; its data are in usb.data. The bytes, or an error. */
int usb_request(uint8_t type, uint8_t request, unsigned value, unsigned index, unsigned len);
/* Those that the chip takes. */
void usb_control(unsigned code);
void usb_mode(unsigned code, unsigned value);
void usb_comm(unsigned code, unsigned parameter);
/* Asks EP1; the number of results, which stand in usb.state from DS2490_STATE on. */
int usb_look(void);
bool usb_has(uint8_t flag);
/* Until the chip is idle or waits; the time that it took. */
int64_t usb_finish(void);
void usb_out(const void *bytes, size_t n);
int usb_in(size_t room);
/* The command's result, which it has to have; whatever it has for EP3 stays there. */
uint8_t usb_result_of(unsigned code, unsigned parameter);
/* An event of the scenario, now. */
void usb_event(const char *text);
