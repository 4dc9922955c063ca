/* SPDX-License-Identifier: MIT */
/* The target w1:netlink on a model of the kernel's 1-Wire core (tests/unit/aid/w1_core.h). */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "hal/owfs/path.h"
#include "tests/endurance/part.h"
#include "tests/unit/aid/w1_core.h"

#define MASTERS 2

struct netlink_part {
	char root[40];
	struct host host;
	struct sim_slave *slave[FIELD_DEVICES];
	bool no_module;
};

static struct netlink_part *of(struct part *part)
{
	struct netlink_part *own = part->own;

	own->host.now = world_now();
	return own;
}

static struct sim_wire *wire_of(unsigned device)
{
	return &wire_net.wire[device % MASTERS];
}

static void show_masters(const struct netlink_part *own, bool yes)
{
	char path[120];

	for (unsigned i = 1; i <= MASTERS; i++) {
		snprintf(path, sizeof(path), "%s/w1_bus_master%u", own->root, i);
		if (yes)
			mkdir(path, 0755);
		else
			rmdir(path);
	}
}

static bool here(const struct part *part, unsigned device)
{
	return !field.device[device].away && field.device[device].wire == part->wire;
}

static void pins(struct part *part)
{
	struct netlink_part *own = of(part);
	int board = field_switch();

	for (unsigned pin = 0; board >= 0 && pin < 4; pin++) {
		char name[16];

		snprintf(name, sizeof(name), "pin.%u", 4 + pin);
		wire_set(own->slave[board], name, field_pins() >> pin & 1);
		sim_slave_advance(own->slave[board], world_now());
	}
}

static void add(struct part *part, unsigned device)
{
	struct netlink_part *own = of(part);
	const struct field_device *d = &field.device[device];
	uint8_t rom[8];
	struct sim_slave *slave;

	if (rom_parse(d->id, strlen(d->id), rom))
		abort();
	slave = sim_slave_create(sim_family_find(d->is_switch ? "DS2408" : "DS18B20", 0), rom + 1);
	if (!slave || sim_wire_add(wire_of(device), slave))
		abort();
	own->slave[device] = slave;
	slave->plugged = here(part, device);
	sim_slave_power_on(slave, world_now());
	if (!d->is_switch)
		slave->input[0] = (struct sim_curve){
			.shape = SIM_SINE,
			.a = d->mean,
			.b = d->swing,
			.span_ns = (d->span_s ? d->span_s : 1) * FIELD_S,
			.start_ns = field.start_ns,
		};
}

static void begin(struct part *part, char *target, unsigned size)
{
	struct netlink_part *own = calloc(1, sizeof(*own));

	if (!own)
		abort();
	part->own = own;
	strcpy(own->root, "/tmp/owsd-endurance-XXXXXX");
	if (!mkdtemp(own->root))
		abort();
	host_init_virtual(&own->host);
	own->host.now = world_now();
	wire_init(&own->host, MASTERS, MASTERS);
	w1_core_start(&own->host, MASTERS);
	show_masters(own, true);
	for (unsigned i = 0; i < field.devices; i++)
		add(part, i);
	pins(part);
	snprintf(target, size, "w1:netlink/root=%s", own->root);
}

static void end(struct part *part)
{
	struct netlink_part *own = of(part);

	w1_core_stop();
	wire_clear();
	show_masters(own, false);
	rmdir(own->root);
	free(own);
}

static int64_t ready(struct part *part, int fd, short events)
{
	struct netlink_part *own = of(part);

	return own->host.ready(own->host.ready_ctx, fd, events);
}

/* --- What goes wrong ------------------------------------------------------------------------- */

static void free_wires(void *ctx)
{
	(void)ctx;
	for (unsigned i = 0; i < MASTERS; i++)
		wire_net.wire[i].shorted = false;
}

static void clean(void *ctx)
{
	struct sim_slave *slave = ctx;

	slave->corrupt_every = 0;
	slave->corrupt_probability = 0;
}

static void return_module(void *ctx)
{
	struct netlink_part *own = ctx;

	own->no_module = false;
	w1_core.masters = MASTERS;
	show_masters(own, true);
}

static void return_master(void *ctx)
{
	(void)ctx;
	w1_core.gone = 0;
}

static void leave_alone(void *ctx)
{
	(void)ctx;
	w1_core.intrudes = w1_core.spreads = false;
}

static const char *fault(struct part *part, int64_t ns)
{
	struct netlink_part *own = of(part);
	struct sim_slave *slave = own->slave[world_random(field.devices)];
	unsigned n = 1 + world_random(8);

	switch (world_random(12)) {
	case 0:
		w1_core.silent = n;
		return "answers get lost";
	case 1:
		w1_core.late = n;
		return "answers come behind";
	case 2:
		w1_core.garbage = n;
		return "answers are cut short";
	case 3:
		w1_core.seed = world_random(1 << 24);
		w1_core.scrambles = n;
		return "answers are scrambled";
	case 4:
		w1_core.refuses = n;
		return "requests are refused";
	case 5:
		w1_core.intrudes = true;
		world_after(ns, leave_alone, NULL);
		return "another program is at it";
	case 6:
		w1_core.spreads = true;
		world_after(ns, leave_alone, NULL);
		return "answers in pieces";
	case 7:
		if (own->no_module)
			return "nothing";
		own->no_module = true;
		w1_core.masters = 0;
		show_masters(own, false);
		world_after(ns, return_module, own);
		return "the module goes";
	case 8:
		w1_core.gone = 1 + world_random(MASTERS);
		world_after(ns, return_master, NULL);
		return "a master goes";
	case 9:
		wire_net.wire[world_random(MASTERS)].shorted = true;
		world_after(ns, free_wires, NULL);
		return "short";
	case 10:
		sim_slave_brownout(slave, world_now());
		return "brownout";
	default:
		slave->corrupt_every = 1 + world_random(4);
		slave->corrupt_random = 1 + world_random(1000);
		world_after(ns, clean, slave);
		return "corrupt";
	}
}

static void restart(struct part *part, unsigned device)
{
	sim_slave_brownout(of(part)->slave[device], world_now());
}

static void plug(struct part *part, unsigned device, bool in)
{
	sim_wire_plug(wire_of(device), of(part)->slave[device], in, world_now());
}

const struct part_ops part_netlink = {
	.name = "netlink",
	.age_ns = FIELD_S,
	.begin = begin,
	.end = end,
	.fault = fault,
	.plug = plug,
	.restart = restart,
	.pins = pins,
	.ready = ready,
};
