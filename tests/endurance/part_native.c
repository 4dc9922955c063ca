/* SPDX-License-Identifier: MIT */
/*
 * The native bus over two simulated DS2482: faults of wires, chips and the adapter, as lines of a
 * scenario. The simulation begins anew with each bus, as a chip does that was without power.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "hal/sim/event.h"
#include "hal/sim/net.h"
#include "tests/endurance/part.h"
#include "tests/unit/aid/plant.h"

/* clang-format off */
static const char *const faults[] = {
	"corrupt hot each 3 for",  "corrupt board chance 0.3 seed 5 for",
	"corrupt boiler each 2 for", "corrupt outside each 1 for",
	"short 0x18 for",          "short 0x19.3 for",
	"brownout hot",            "brownout outside",
	"stick 0x18",              "stick 0x19",
	"jam 0x18 for",            "jam 0x19 for",
	"reset 0x18",              "reset 0x19",
	"sleep 0x18 for",          "sleep 0x19 for",
	"refuse 0x18 each 7 for",  "refuse 0x19 for",
	"refuse-data 0x18 each 11 for", "refuse-data 0x19 each 5 for",
	"remove adapter for",
};
/* clang-format on */
#define FAULTS (sizeof(faults) / sizeof(faults[0]))

struct native_part {
	char file[40];
	struct sim_net *net;
};

static void begin(struct part *part, char *target, unsigned size)
{
	struct native_part *own = calloc(1, sizeof(*own));
	int fd;
	FILE *f;

	if (!own)
		abort();
	part->own = own;
	strcpy(own->file, "/tmp/owsd-endurance-XXXXXX");
	fd = mkstemp(own->file);
	f = fd < 0 ? NULL : fdopen(fd, "w");
	if (!f)
		abort();
	fputs("i2c speed 100 combine one-read\nchip DS2482-100 0x18\n", f);
	for (unsigned i = 0; i < field.devices; i++) {
		const struct field_device *d = &field.device[i];

		if (i == 2)
			fputs("chip DS2482-800 0x19\nchannel 3\n", f);
		else if (i == 3)
			fputs("channel 0\n", f);
		if (d->is_switch)
			fprintf(f, "DS2408 %s as %s\n", d->id, d->name);
		else
			fprintf(f, "DS18B20 %s as %s %s\n", d->id, d->name,
			        i == 2 ? "parasite" : "");
	}
	fclose(f);
	snprintf(target, size, "sim:%s", own->file);
}

static void end(struct part *part)
{
	struct native_part *own = part->own;

	unlink(own->file);
	free(own);
}

static void happen(struct part *part, const char *line)
{
	struct native_part *own = part->own;
	char why[200] = "";

	if (part->bus && sim_scenario_event(own->net, line, world_now(), why, sizeof(why)))
		abort();
}

static void pins(struct part *part)
{
	int board = field_switch();
	char line[60];

	for (unsigned pin = 0; board >= 0 && pin < 4; pin++) {
		snprintf(line, sizeof(line), "set %s pin.%u %u", field.device[board].name, 4 + pin,
		         field_pins() >> pin & 1);
		happen(part, line);
	}
}

static void plug(struct part *part, unsigned device, bool in)
{
	char line[60];

	snprintf(line, sizeof(line), "%s %s", in ? "plug" : "unplug", field.device[device].name);
	happen(part, line);
}

static void opened(struct part *part, struct bus *bus)
{
	struct native_part *own = part->own;

	own->net = plant_net(bus);
	sim_net_start(own->net, world_now());
	for (unsigned i = 0; i < field.devices; i++) {
		const struct field_device *d = &field.device[i];
		struct sim_slave *slave = sim_net_slave(own->net, d->name);

		if (!d->is_switch)
			slave->input[0] = (struct sim_curve){
				.shape = SIM_SINE,
				.a = d->mean,
				.b = d->swing,
				.span_ns = (d->span_s ? d->span_s : 1) * FIELD_S,
				.start_ns = field.start_ns - world_now(),
			};
		if (d->away || d->wire != part->wire)
			plug(part, i, false);
	}
	pins(part);
}

static const char *fault(struct part *part, int64_t ns)
{
	static char line[80];
	const char *text = faults[world_random(FAULTS)];
	size_t len = strlen(text);

	if (strcmp(text + len - 4, " for") == 0)
		snprintf(line, sizeof(line), "%s %us", text, (unsigned)(ns / FIELD_S));
	else
		snprintf(line, sizeof(line), "%s", text);
	happen(part, line);
	return line;
}

static void restart(struct part *part, unsigned device)
{
	char line[60];

	snprintf(line, sizeof(line), "brownout %s", field.device[device].name);
	happen(part, line);
}

const struct part_ops part_native = {
	.name = "native",
	.age_ns = FIELD_S,
	.begin = begin,
	.end = end,
	.opened = opened,
	.fault = fault,
	.plug = plug,
	.restart = restart,
	.pins = pins,
};
