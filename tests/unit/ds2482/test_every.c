/* SPDX-License-Identifier: MIT */
/* Every DS2482 of every adapter as one master, over simulated adapters that come and go. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "hal/ds2482/master.h"
#include "unity.h"

#include "hal/ds2482/ds2482.h"
#include "hal/ds2482/every.h"
#include "hal/sim/adapter.h"
#include "hal/sim/scenario.h"
#include "tests/unit/aid/host.h"
#include "tests/unit/aid/parts.h"

#define ADAPTERS 3

struct rio_position {
	struct sim_net net;
	struct sim_adapter adapter;
	bool listed, taken;
	uint64_t mark;
	unsigned opens;
};

static struct host host;
static struct rio_position place[ADAPTERS];
static struct link_master *every;
static struct i2c_adapter_ops taken_ops;
static char why[BUS_EVENT_TEXT];

static int claim_in_vain(struct i2c_adapter *adapter, uint8_t address)
{
	(void)adapter;
	return address == 0x18 ? -EBUSY : 0;
}

static int open_dir(void *ctx, const struct bus_env *env, struct i2c_adapter **out, char *text,
                    size_t size)
{
	struct rio_position *p = ctx;

	(void)text, (void)size;
	p->opens++;
	sim_net_run(&p->net, env->now(env->ctx));
	sim_adapter_init(&p->adapter, &p->net, env);
	taken_ops = *p->adapter.adapter.ops;
	taken_ops.claim = claim_in_vain;
	if (p->taken)
		p->adapter.adapter.ops = &taken_ops;
	*out = &p->adapter.adapter;
	return 0;
}

static int see_place(void *ctx, const struct bus_env *env, uint8_t chips, uint64_t *mark)
{
	struct rio_position *p = ctx;

	(void)env, (void)chips;
	*mark += p->mark;
	return 1;
}

static void forget(void *ctx)
{
	(void)ctx;
}

static const struct link_master_ops place_ops = {
	.open = ds2482_open,
	.grow = ds2482_grow,
	.close = ds2482_close,
	.visible = ds2482_visible,
	.channels = ds2482_channels,
	.channel = ds2482_channel,
	.cost = ds2482_cost,
	.destroy = ds2482_destroy,
};

static unsigned list(void *ctx, unsigned *numbers, unsigned max)
{
	unsigned count = 0;

	(void)ctx;
	for (unsigned i = 0; i < ADAPTERS && count < max; i++)
		if (place[i].listed)
			numbers[count++] = i;
	return count;
}

static int make(void *ctx, unsigned number, const struct bus_env *env, struct link_master **master)
{
	const struct ds2482_source source = {.open = open_dir,
	                                     .visible = see_place,
	                                     .destroy = forget,
	                                     .name = "test",
	                                     .ctx = &place[number]};

	(void)ctx;
	return ds2482_create(&place_ops, env, &source, "", master, why, sizeof(why));
}

void setUp(void)
{
	const struct every_source source = {.list = list, .make = make};

	host_init_virtual(&host);
	memset(place, 0, sizeof(place));
	for (unsigned i = 0; i < ADAPTERS; i++)
		sim_net_init(&place[i].net);
	TEST_ASSERT_EQUAL_INT(0, every_create(&host.env, &source, &every));
}

void tearDown(void)
{
	every->ops->close(every);
	every->ops->destroy(every);
	for (unsigned i = 0; i < ADAPTERS; i++)
		sim_net_clear(&place[i].net);
}

/* An empty scenario: an adapter without chips. */
static void plug(unsigned number, const char *scenario)
{
	int err = 0;

	if (*scenario)
		err = sim_scenario_parse("test", scenario, &place[number].net, why, sizeof(why));

	TEST_ASSERT_EQUAL_INT_MESSAGE(0, err, why);
	place[number].listed = true;
	place[number].mark = 1 + number;
}

static int open_all(void)
{
	why[0] = '\0';
	return every->ops->open(every, why, sizeof(why));
}

static unsigned channels(void)
{
	return every->ops->channels(every);
}

static int presence(unsigned channel)
{
	struct link *link = every->ops->channel(every, channel);

	TEST_ASSERT_NOT_NULL(link);
	return part_reset(link);
}

static void test_the_chips_of_all_adapters_are_one_row_of_links(void)
{
	plug(0, "chip DS2482-100 0x18\nDS18B20 28.A0B1C2000028 temperature 20\n"
	        "chip DS2482-100 0x1a\n");
	plug(1, "");
	plug(2, "chip DS2482-800 0x1f\nchannel 7\nDS18B20 28.A0B1C2010028 temperature 20\n");
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, open_all(), why);
	TEST_ASSERT_EQUAL_UINT(10, channels());
	TEST_ASSERT_EQUAL_INT(1, presence(0));
	TEST_ASSERT_EQUAL_INT(0, presence(1));
	TEST_ASSERT_EQUAL_INT(0, presence(2));
	TEST_ASSERT_EQUAL_INT(1, presence(9));
	TEST_ASSERT_NULL(every->ops->channel(every, 10));
}

static void test_links_of_different_chips_have_different_numbers(void)
{
	plug(0, "chip DS2482-100 0x18\nchip DS2482-100 0x1a\n");
	plug(2, "chip DS2482-800 0x18\n");
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, open_all(), why);
	for (unsigned i = 0; i < 10; i++)
		for (unsigned k = 0; k < i; k++)
			TEST_ASSERT_EQUAL(i >= 2 && k >= 2,
			                  every->ops->channel(every, i)->chip ==
			                          every->ops->channel(every, k)->chip);
}

static void test_links_keep_their_numbers_when_an_adapter_is_opened_again(void)
{
	plug(0, "chip DS2482-100 0x18\n");
	plug(2, "chip DS2482-100 0x18\n");
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, open_all(), why);
	struct link *link = every->ops->channel(every, 1);
	unsigned number = link->chip;
	every->ops->close(every);
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, open_all(), why);
	TEST_ASSERT_EQUAL_UINT(number, link->chip);
	TEST_ASSERT_TRUE(link->chip != every->ops->channel(every, 0)->chip);
}

static void test_the_cost_is_that_of_all_adapters(void)
{
	struct link_master_cost cost;

	plug(0, "chip DS2482-100 0x18\n");
	plug(2, "chip DS2482-800 0x18\n");
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, open_all(), why);
	for (unsigned i = 0; i < channels(); i++)
		presence(i);
	every->ops->cost(every, &cost);
	TEST_ASSERT_GREATER_THAN_UINT64(0, place[0].adapter.adapter.transfers);
	TEST_ASSERT_EQUAL_UINT64(place[0].adapter.adapter.transfers +
	                                 place[2].adapter.adapter.transfers,
	                         cost.transfers);
}

static void test_without_adapter_or_chip_it_says_what_is_missing(void)
{
	TEST_ASSERT_EQUAL_INT(-ENODEV, open_all());
	TEST_ASSERT_NOT_NULL_MESSAGE(strstr(why, "switch I2C on"), why);
	plug(0, "");
	plug(1, "");
	TEST_ASSERT_EQUAL_INT(-ENXIO, open_all());
	TEST_ASSERT_NOT_NULL_MESSAGE(strstr(why, "on any of 2 I2C adapters"), why);
}

static void test_a_chip_that_a_driver_has_is_the_reason_given(void)
{
	plug(0, "");
	plug(1, "chip DS2482-100 0x18\n");
	place[1].taken = true;
	TEST_ASSERT_EQUAL_INT(-EBUSY, open_all());
	TEST_ASSERT_NOT_NULL_MESSAGE(strstr(why, "a driver has 0x18"), why);
}

static void test_an_adapter_that_comes_later_is_taken_behind_the_others(void)
{
	plug(2, "chip DS2482-100 0x18\n");
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, open_all(), why);
	struct link *first = every->ops->channel(every, 0);
	TEST_ASSERT_EQUAL_INT(1, every->ops->grow(every, why, sizeof(why)));
	TEST_ASSERT_EQUAL_STRING("", why);
	TEST_ASSERT_EQUAL_UINT(1, channels());
	plug(0, "chip DS2482-100 0x19\nDS18B20 28.A0B1C2000028 temperature 20\n");
	TEST_ASSERT_EQUAL_INT(1, every->ops->grow(every, why, sizeof(why)));
	TEST_ASSERT_EQUAL_UINT(2, channels());
	TEST_ASSERT_EQUAL_PTR(first, every->ops->channel(every, 0));
	TEST_ASSERT_EQUAL_INT(1, presence(1));
}

/* Other parts live at these addresses: nobody writes to them every ten seconds. */
static void test_an_adapter_without_chip_is_not_probed_again_before_it_changes(void)
{
	plug(0, "");
	plug(1, "chip DS2482-100 0x18\n");
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, open_all(), why);
	for (unsigned i = 0; i < 5; i++)
		every->ops->grow(every, why, sizeof(why));
	TEST_ASSERT_EQUAL_UINT(1, place[0].opens);
	place[0].mark = 99;
	every->ops->grow(every, why, sizeof(why));
	TEST_ASSERT_EQUAL_UINT(2, place[0].opens);
}

static void test_what_is_seen_of_it_changes_with_each_adapter(void)
{
	uint64_t none = 0, one = 0, two = 0, again = 0;

	TEST_ASSERT_EQUAL_INT(0, every->ops->visible(every, &none));
	plug(1, "");
	TEST_ASSERT_EQUAL_INT(1, every->ops->visible(every, &one));
	plug(2, "");
	TEST_ASSERT_EQUAL_INT(1, every->ops->visible(every, &two));
	TEST_ASSERT_EQUAL_INT(1, every->ops->visible(every, &again));
	TEST_ASSERT_TRUE(none != one && one != two);
	TEST_ASSERT_EQUAL_UINT64(two, again);
	TEST_ASSERT_EQUAL_UINT(0, place[1].opens + place[2].opens);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_the_chips_of_all_adapters_are_one_row_of_links);
	RUN_TEST(test_links_of_different_chips_have_different_numbers);
	RUN_TEST(test_links_keep_their_numbers_when_an_adapter_is_opened_again);
	RUN_TEST(test_the_cost_is_that_of_all_adapters);
	RUN_TEST(test_without_adapter_or_chip_it_says_what_is_missing);
	RUN_TEST(test_a_chip_that_a_driver_has_is_the_reason_given);
	RUN_TEST(test_an_adapter_that_comes_later_is_taken_behind_the_others);
	RUN_TEST(test_an_adapter_without_chip_is_not_probed_again_before_it_changes);
	RUN_TEST(test_what_is_seen_of_it_changes_with_each_adapter);
	return UNITY_END();
}
