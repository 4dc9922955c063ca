// SPDX-License-Identifier: MIT
// OneWireHub's own classes as coroutines: what waits there for an edge of the pin waits here for the
// next slot of the simulator's wire. The four functions of OneWireHub that watch a pin are defined
// here; those of its own object file are made weak.
#include <stdlib.h>
#include <string.h>
#include <ucontext.h>

#define private public // its hub has no interface to one slot
#include "DS2413.h"
#include "DS2438.h"
#undef private

#include "hub.h"

namespace
{
const int64_t HIGH_NS = 15000000; // OneWireHub gives a slot up after that

enum Wants { RESET, RECEIVE, SEND };
} // namespace

struct hub {
	OneWireHub hub{8};
	OneWireItem *item;
	bool monitor;
	ucontext_t outside, inside;
	Wants wants;
	bool line, reset, late;
	int64_t last_ns, now_ns;
	char stack[1 << 16];

	void await(Wants what)
	{
		wants = what;
		swapcontext(&inside, &outside);
	}
	void resume() { swapcontext(&outside, &inside); }
	// True: the slot does not come.
	bool given_up(Error *error)
	{
		if (late)
			*error = Error::AWAIT_TIMESLOT_TIMEOUT_HIGH;
		else if (reset)
			*error = Error::RESET_IN_PROGRESS;
		else
			return false;
		late = false;
		return true;
	}
	void expire(int64_t at_ns)
	{
		now_ns = at_ns;
		while (wants != RESET && at_ns - last_ns > HIGH_NS) {
			last_ns += HIGH_NS;
			late = true;
			resume();
		}
	}
};

// The hub is the first member.
static struct hub *around(OneWireHub *hub)
{
	return reinterpret_cast<struct hub *>(hub);
}

bool OneWireHub::recvBit()
{
	struct hub *h = around(this);

	if (!h->reset)
		h->await(RECEIVE);
	return h->given_up(&_error) || h->line;
}

bool OneWireHub::sendBit(const bool value)
{
	struct hub *h = around(this);

	h->line = value;
	if (!h->reset)
		h->await(SEND);
	return h->given_up(&_error);
}

bool OneWireHub::checkReset()
{
	struct hub *h = around(this);

	while (!h->reset)
		h->await(RESET);
	h->reset = false;
	_error = Error::NO_ERROR;
	return false;
}

bool OneWireHub::showPresence()
{
	around(this)->last_ns = around(this)->now_ns;
	return false;
}

static struct hub *starting;

static void run(void)
{
	struct hub *h = starting;

	for (;;)
		h->hub.poll();
}

struct hub *hub_new(const char *chip, const uint8_t r[8])
{
	bool monitor = strcmp(chip, "DS2438-EMULATED") == 0;

	if (!monitor && strcmp(chip, "DS2413-EMULATED") != 0)
		return nullptr;
	struct hub *h = new hub();
	h->monitor = monitor;
	if (monitor)
		h->item = new DS2438(r[0], r[1], r[2], r[3], r[4], r[5], r[6]);
	else
		h->item = new DS2413(r[0], r[1], r[2], r[3], r[4], r[5], r[6]);
	if (memcmp(h->item->ID, r, 8))
		abort();
	h->hub.attach(*h->item);
	getcontext(&h->inside);
	h->inside.uc_stack.ss_sp = h->stack;
	h->inside.uc_stack.ss_size = sizeof(h->stack);
	h->inside.uc_link = nullptr;
	makecontext(&h->inside, run, 0);
	starting = h;
	h->resume();
	return h;
}

void hub_free(struct hub *h)
{
	if (!h)
		return;
	h->hub.detach(*h->item);
	if (h->monitor)
		delete static_cast<DS2438 *>(h->item);
	else
		delete static_cast<DS2413 *>(h->item);
	delete h;
}

void hub_reset(struct hub *h, int64_t now_ns)
{
	h->expire(now_ns);
	h->reset = true;
	h->resume();
}

bool hub_output(struct hub *h, int64_t now_ns)
{
	h->expire(now_ns);
	return h->wants != SEND || h->line;
}

void hub_slot(struct hub *h, bool line, int64_t now_ns)
{
	h->last_ns = h->now_ns = now_ns;
	if (h->wants == RESET)
		return;
	if (h->wants == RECEIVE)
		h->line = line;
	h->resume();
}

void hub_set(struct hub *h, const double *in)
{
	if (!h->monitor) {
		static_cast<DS2413 *>(h->item)->setPinState(0, in[0] != 0);
		static_cast<DS2413 *>(h->item)->setPinState(1, in[1] != 0);
		return;
	}
	DS2438 *monitor = static_cast<DS2438 *>(h->item);
	double current = in[3] / 0.2441;
	monitor->setTemperature(static_cast<float>(in[0]));
	monitor->setVDDVoltage(static_cast<uint16_t>(in[1] * 100 + 0.5));
	monitor->setVADVoltage(static_cast<uint16_t>(in[2] * 100 + 0.5));
	monitor->setCurrent(static_cast<int16_t>(current + (current < 0 ? -0.5 : 0.5)));
}

const uint8_t *hub_memory(const struct hub *h)
{
	return static_cast<const DS2438 *>(h->item)->memory;
}
