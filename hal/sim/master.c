/* SPDX-License-Identifier: MIT */
/* The link master of scheme sim: the DS2482 driver over a simulated network from a file. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/ds2482/ds2482.h"
#include "hal/ds2482/master.h"
#include "hal/ds2482/power.h"
#include "hal/sim/adapter.h"
#include "hal/sim/button.h"
#include "hal/sim/master.h"
#include "hal/sim/scenario.h"

struct simulation {
	struct sim_net net;
	struct sim_adapter adapter;
	char name[];
};

static int open_adapter(void *ctx, const struct bus_env *env, struct i2c_adapter **adapter,
                        char *why, size_t why_size)
{
	struct simulation *simulation = ctx;

	sim_net_run(&simulation->net, env->now(env->ctx));
	if (!simulation->net.plugged) {
		snprintf(why, why_size, "the simulated adapter of %s is unplugged",
		         simulation->name);
		return -ENODEV;
	}
	sim_adapter_init(&simulation->adapter, &simulation->net, env);
	*adapter = &simulation->adapter.adapter;
	return 0;
}

static int sim_visible(void *ctx, const struct bus_env *env, uint8_t chips, uint64_t *mark)
{
	struct simulation *simulation = ctx;

	(void)chips, (void)mark;
	sim_net_run(&simulation->net, env->now(env->ctx));
	return simulation->net.plugged;
}

static void destroy_simulation(void *ctx)
{
	struct simulation *simulation = ctx;

	sim_net_clear(&simulation->net);
	free(simulation);
}

/* A file name may have colons: only ":0x.." at its end is a chip. */
static const char *behind_file(const char *where)
{
	const char *chip = strrchr(where, ':');

	return chip && strncmp(chip, ":0x", 3) == 0 ? chip : where + strlen(where);
}

static int sim_master_create(const char *where, const struct bus_env *env,
                             struct link_master **master, char *why, size_t why_size)
{
	const char *chip = behind_file(where);
	size_t len = (size_t)(chip - where);
	struct simulation *simulation = calloc(1, sizeof(*simulation) + len + 1);
	struct ds2482_source source = {.open = open_adapter,
	                               .visible = sim_visible,
	                               .destroy = destroy_simulation,
	                               .ctx = simulation};
	int err;

	if (!simulation)
		return -ENOMEM;
	if (!len) {
		snprintf(why, why_size, "expected a file, as in sim:house.sim");
		free(simulation);
		return -EINVAL;
	}
	memcpy(simulation->name, where, len);
	source.name = simulation->name;
	err = sim_scenario_read(simulation->name, &simulation->net, why, why_size);
	if (err) {
		free(simulation);
		return err == -ENOMEM ? err : -EINVAL;
	}
	return ds2482_create(&sim_master, env, &source, chip, master, why, why_size);
}

struct sim_net *sim_master_net(struct link_master *master)
{
	struct ds2482_master *driver = (struct ds2482_master *)master;

	return &((struct simulation *)driver->source.ctx)->net;
}

static bool master_own(struct link_master *master, struct bus_req *req, struct bus_answer *answer)
{
	return button_answer(sim_master_net(master), req, master->env->now(master->env->ctx),
	                     answer);
}

const struct link_master_ops sim_master = {
	.create = sim_master_create,
	.option = ds2482_option,
	.open = ds2482_open,
	.grow = ds2482_grow,
	.close = ds2482_close,
	.visible = ds2482_visible,
	.channels = ds2482_channels,
	.channel = ds2482_channel,
	.cost = ds2482_cost,
	.own = master_own,
	.destroy = ds2482_destroy,
	.simulated = true,
};
