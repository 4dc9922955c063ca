/* SPDX-License-Identifier: MIT */
/* Sets up the DS2482 driver over the simulated chip. */
#include <errno.h>
#include <string.h>

#include "hal/ds2482/master.h"
#include "unity.h"

#include "hal/sim/crc.h"
#include "hal/sim/event.h"
#include "hal/sim/scenario.h"
#include "tests/unit/aid/ds2482_scene.h"
#include "tests/unit/aid/parts.h"

struct ds ds;

void ds_begin(void)
{
	host_init_virtual(&ds.host);
	ds.closes = 0;
}

void ds_end(void)
{
	if (ds.master)
		ds.master->ops->destroy(ds.master);
	ds.master = NULL;
	sim_net_clear(&ds.net);
}

int ds_open_adapter(void *ctx, const struct bus_env *env, struct i2c_adapter **out, char *text,
                    size_t size)
{
	(void)ctx, (void)text, (void)size;
	sim_net_run(&ds.net, env->now(env->ctx));
	if (!ds.net.plugged)
		return -ENODEV;
	sim_adapter_init(&ds.adapter, &ds.net, env);
	*out = &ds.adapter.adapter;
	return 0;
}

void ds_forget(void *ctx)
{
	(void)ctx;
	ds.closes++;
}

const struct link_master_ops ds_ops = {
	.open = ds2482_open,
	.grow = ds2482_grow,
	.close = ds2482_close,
	.channels = ds2482_channels,
	.channel = ds2482_channel,
	.cost = ds2482_cost,
	.destroy = ds2482_destroy,
};

int ds_try_open(const char *scenario, const char *where)
{
	const struct ds2482_source source = {
		.open = ds_open_adapter, .destroy = ds_forget, .name = "test"};
	int err = sim_scenario_parse("test", scenario, &ds.net, ds.why, sizeof(ds.why));

	TEST_ASSERT_EQUAL_INT_MESSAGE(0, err, ds.why);
	TEST_ASSERT_EQUAL_INT(0, ds2482_create(&ds_ops, &ds.host.env, &source, where, &ds.master,
	                                       ds.why, sizeof(ds.why)));
	return ds.master->ops->open(ds.master, ds.why, sizeof(ds.why));
}

void ds_start(const char *scenario)
{
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, ds_try_open(scenario, ""), ds.why);
	ds.wire = ds.master->ops->channel(ds.master, 0);
}

void ds_event(const char *text)
{
	TEST_ASSERT_EQUAL_INT_MESSAGE(
		0, sim_scenario_event(&ds.net, text, ds.host.now, ds.why, sizeof(ds.why)), ds.why);
}

int ds_read_scratchpad(const char *name, uint8_t scratchpad[9])
{
	uint8_t out[10] = {0x55};
	int err = part_reset(ds.wire);

	if (err < 0)
		return err;
	memcpy(out + 1, sim_net_slave(&ds.net, name)->rom, 8);
	out[9] = 0xBE;
	err = part_write(ds.wire, out, 10, LINK_IDLE);
	return err ? err : part_read(ds.wire, scratchpad, 9);
}

void ds_check_scratchpad(void)
{
	static const uint8_t expect[5] = {0x50, 0x05, 75, 70, 0x7F};
	uint8_t scratchpad[9];

	TEST_ASSERT_EQUAL_INT(0, ds_read_scratchpad("t", scratchpad));
	TEST_ASSERT_EQUAL_HEX8_ARRAY(expect, scratchpad, 5);
	TEST_ASSERT_EQUAL_HEX8(0, sim_crc8(0, scratchpad, 9));
}

const char *const ds_kinds[DS_KINDS] = {
	"i2c speed 400 combine any\nchip DS2482-100 0x18\nDS18B20 28.000000000001 as t",
	"i2c speed 400 combine one-read\nchip DS2482-100 0x18\nDS18B20 28.000000000001 as t",
	"i2c speed 100 combine any\nchip DS2482-100 0x18\nDS18B20 28.000000000001 as t",
	"i2c speed 100 combine one-read\nchip DS2482-100 0x18\nDS18B20 28.000000000001 as t",
	"i2c speed 100 combine smbus\nchip DS2482-100 0x18\nDS18B20 28.000000000001 as t",
	"i2c speed 400 combine smbus\nchip DS2482-100 0x18\nDS18B20 28.000000000001 as t",
	"i2c speed 400 combine any messages 5\nchip DS2484 0x18\nDS18B20 28.000000000001 as t",
	"i2c speed 50 combine one-read\nchip DS2482-800 0x1f\nDS18B20 28.000000000001 as t",
};
