/* SPDX-License-Identifier: MIT */
/*
 * GPIO lines beside the chips: one that switches the supply of the wire (and perhaps of the chips),
 * one at the SLPZ pins of DS2482-101, DS2483 and DS2484.
 */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/ds2482/detect.h"
#include "hal/ds2482/ds2482.h"
#include "hal/ds2482/io.h"
#include "hal/ds2482/power.h"

/* 2 ms after SLPZ goes high a chip answers, by the data sheet of the DS2484. */
#define AWAKE_NS (5 * NS_PER_MS)

static bool is_given(const struct gpio_output *output)
{
	return output->spec.chip[0] != '\0';
}

int ds2482_option(struct link_master *base, const char *key, const char *text, char *why,
                  size_t why_size)
{
	struct ds2482_master *master = (struct ds2482_master *)base;
	char *end;
	long ms;

	if (strcmp(key, "PowerLine") == 0) {
		base->one_supply = true;
		return gpio_spec_parse(text, &master->power.spec, why, why_size);
	}
	if (strcmp(key, "SleepLine") == 0)
		return gpio_spec_parse(text, &master->sleep.spec, why, why_size);
	if (strcmp(key, "PowerOffMs") != 0)
		return -ENOENT;
	ms = strtol(text, &end, 0);
	if (*end || end == text || ms < 1 || ms > 60000) {
		snprintf(why, why_size, "\"%.40s\": expected milliseconds from 1 to 60000", text);
		return -EINVAL;
	}
	master->power_off_ns = ms * NS_PER_MS;
	return 0;
}

int ds2482_power_on(struct ds2482_master *master, char *why, size_t why_size)
{
	bool was_off = is_given(&master->power) && !master->power.line;
	int err = 0;

	if (was_off)
		err = gpio_output_take(&master->power, true, why, why_size);
	if (!err && was_off)
		err = ds2482_wait(master, DS2482_POWER_ON_NS);
	if (err || !is_given(&master->sleep))
		return err;
	if (master->sleep.line)
		err = gpio_output_set(&master->sleep, true);
	else
		err = gpio_output_take(&master->sleep, true, why, why_size);
	if (err && !*why)
		snprintf(why, why_size, "SleepLine: %s", strerror(-err));
	return err ? err : ds2482_wait(master, AWAKE_NS);
}

void ds2482_rest(struct ds2482_master *master)
{
	if (master->sleep.line)
		gpio_output_set(&master->sleep, false);
}

void ds2482_power_release(struct ds2482_master *master)
{
	ds2482_rest(master);
	gpio_output_release(&master->sleep);
	gpio_output_release(&master->power);
}

/* Set up all chips, because the line may switch their supply too. */
static int set_up_all(struct ds2482_master *master)
{
	int worst = 0;

	for (unsigned i = 0; i < master->count; i++) {
		int err = ds2482_setup(&master->chip[i]);

		worst = err ? err : worst;
	}
	return worst;
}

int ds2482_power_cycle(struct ds2482_master *master)
{
	int err, on;

	if (!master->power.line)
		return -EOPNOTSUPP;
	err = gpio_output_set(&master->power, false);
	if (!err)
		err = ds2482_wait(master, master->power_off_ns);
	/* switch on again after any error */
	on = gpio_output_set(&master->power, true);
	err = err ? err : on;
	if (err == -ENODEV) /* the GPIO chip is gone: the master looks for it when it opens again */
		gpio_output_release(&master->power);
	if (!err)
		err = ds2482_wait(master, DS2482_POWER_ON_NS);
	return err ? err : set_up_all(master);
}
