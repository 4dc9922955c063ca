/* SPDX-License-Identifier: MIT */
/* A master: the chips of an adapter, opened, closed and opened again. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/rivals.h"
#include "hal/base/time.h"
#include "hal/bus/tap.h"
#include "hal/ds2482/detect.h"
#include "hal/ds2482/ds2482.h"
#include "hal/ds2482/io.h"
#include "hal/ds2482/link.h"
#include "hal/ds2482/master.h"
#include "hal/ds2482/power.h"
#include "hal/ds2482/select.h"

#define END_NS (5 * NS_PER_MS) /* a byte or a reset has ended by then */

static int parse_where(struct ds2482_master *master, const char *where, char *why, size_t why_size)
{
	char *end;

	master->address = master->channel = -1;
	if (!*where)
		return 0;
	if (*where != ':')
		goto wrong;
	master->address = (int)strtol(where + 1, &end, 16);
	if (end == where + 1 || master->address < DS2482_FIRST_ADDRESS ||
	    master->address >= DS2482_FIRST_ADDRESS + DS2482_ADDRESSES)
		goto wrong;
	if (!*end)
		return 0;
	if (*end != '.' || end[1] < '0' || end[1] > '7' || end[2])
		goto wrong;
	master->channel = end[1] - '0';
	return 0;
wrong:
	snprintf(why, why_size,
	         "\"%s\": expected \":0x18\" to \":0x1f\", with \".0\" to \".7\" for one channel",
	         where);
	return -EINVAL;
}

void ds2482_cost(const struct link_master *base, struct link_master_cost *cost)
{
	const struct ds2482_master *master = (const struct ds2482_master *)base;

	*cost = master->cost;
	if (!master->adapter)
		return;
	cost->transfers += master->adapter->transfers;
	cost->bytes += master->adapter->bytes;
	cost->syscalls += master->adapter->syscalls;
}

/* Nobody else would end a strong pull-up. A shutdown ends waits, and a busy chip takes nothing. */
static void leave_chip(struct ds2482_chip *chip)
{
	if (!(chip->config & DS2482_SPU) || !ds2482_claimed(chip) || chip->lost)
		return;
	if (ds2482_wait(chip->master, END_NS))
		clock_pause(END_NS);
	chip->free_at = 0;
	(void)ds2482_end_strong(chip);
}

static void close_adapter(struct ds2482_master *master)
{
	struct i2c_adapter *adapter = master->adapter;

	if (!adapter)
		return;
	for (unsigned i = 0; i < master->count; i++)
		leave_chip(&master->chip[i]);
	ds2482_cost(&master->master, &master->cost);
	master->adapter = NULL;
	adapter->ops->close(adapter);
}

static void explain(const struct ds2482_master *master, int err, int address, char *why,
                    size_t size)
{
	const char *name = master->source.name;
	char holder[64];

	switch (err) {
	case -EADDRINUSE:
		rivals_name(RIVALS_PROC, master->adapter->holder, holder, sizeof(holder));
		snprintf(why, size, "the chip at 0x%02x on %s is in use by %s", (unsigned)address,
		         name, holder);
		break;
	case -EBUSY:
		if (master->source.explain)
			master->source.explain(master->source.ctx, (uint8_t)address, why, size);
		else
			snprintf(why, size, "a driver has 0x%02x on %s", (unsigned)address, name);
		break;
	case -ENXIO:
	case -EIO:
		if (address >= 0)
			snprintf(why, size,
			         "no DS2482 answers at 0x%02x on %s: look at supply, "
			         "SDA, SCL, address pins",
			         (unsigned)address, name);
		else
			snprintf(why, size,
			         "no DS2482 answers at 0x18 to 0x1f on %s: look at its "
			         "supply, SDA and SCL",
			         name);
		break;
	case -ENODEV:
		snprintf(why, size, "the adapter %s is gone", name);
		break;
	case -ETIMEDOUT:
		snprintf(why, size, "%s is stuck: is SDA or SCL held low?", name);
		break;
	default:
		snprintf(why, size, "%s: %s", name, strerror(-err));
		break;
	}
}

/* Find and set up the chip at address. */
static int take_chip(struct ds2482_master *master, uint8_t address)
{
	struct ds2482_chip *chip = &master->chip[master->count];
	struct i2c_adapter *adapter = master->adapter;
	int err = adapter->ops->claim(adapter, address);

	chip->answered = false;
	if (err)
		return err;
	chip->master = master;
	chip->address = address;
	err = ds2482_detect(chip);
	if (!err)
		err = ds2482_setup(chip);
	if (err) {
		if (adapter->ops->release)
			adapter->ops->release(adapter, address);
		return err;
	}
	for (unsigned i = 0; i < chip->channels; i++)
		ds2482_link_init(chip, i);
	master->count++;
	return 0;
}

static bool is_known(const struct ds2482_master *master, uint8_t address)
{
	return memchr(master->order, address, master->known) != NULL;
}

static bool ends_all(int err)
{
	return err == -ENODEV || err == -ECANCELED;
}

/*
 * Call take_chip(), and note whether the chip is missing: it was here before, it answered at first,
 * or it failed in another way than an address without a chip does.
 */
static int try_chip(struct ds2482_master *master, uint8_t address)
{
	int err = take_chip(master, address);

	if (ends_all(err))
		return err;
	if (!err && !is_known(master, address))
		master->order[master->known++] = address;
	master->missing[address - DS2482_FIRST_ADDRESS] = err &&
	                                                  (is_known(master, address) ||
	                                                   master->chip[master->count].answered ||
	                                                   (err != -ENXIO && err != -EIO));
	return err;
}

/*
 * Take the known chips first and in their order: an adapter opened again keeps its channels'
 * places.
 */
static int take_all(struct ds2482_master *master, char *why, size_t why_size)
{
	int worst = -ENXIO, at = -1;
	unsigned known = master->known;

	for (unsigned i = 0; i < known + DS2482_ADDRESSES; i++) {
		uint8_t address = i < known ? master->order[i]
		                            : (uint8_t)(DS2482_FIRST_ADDRESS + i - known);
		int err;

		if (i >= known && memchr(master->order, address, known))
			continue;
		err = try_chip(master, address);
		if (ends_all(err)) {
			explain(master, err, address, why, why_size);
			return err;
		}
		if (err && err != -ENXIO && err != -EIO) {
			worst = err;
			at = address;
		}
	}
	if (master->count > 0)
		return 0;
	explain(master, worst, at, why, why_size);
	return worst;
}

int ds2482_grow(struct link_master *base, char *why, size_t why_size)
{
	struct ds2482_master *master = (struct ds2482_master *)base;
	int64_t byte_ns = master->byte_ns;
	int left = 0;

	for (int i = 0; master->address < 0 && i < DS2482_ADDRESSES; i++) {
		int address = DS2482_FIRST_ADDRESS + i, err;

		if (!master->missing[i])
			continue;
		err = try_chip(master, (uint8_t)address);
		if (!err)
			continue;
		master->byte_ns = byte_ns;
		explain(master, err, address, why, why_size);
		if (ends_all(err))
			return err;
		left = 1;
	}
	return left;
}

int ds2482_open(struct link_master *base, char *why, size_t why_size)
{
	struct ds2482_master *master = (struct ds2482_master *)base;
	int err = ds2482_power_on(master, why, why_size);

	if (!err)
		err = master->source.open(master->source.ctx, base->env, &master->adapter, why,
		                          why_size);
	if (err)
		return err;
	if (base->env->tap && base->env->tap->adapter)
		master->adapter = base->env->tap->adapter(base->env->tap, base->env,
		                                          master->adapter);
	if (!master->adapter)
		return -ENOMEM;
	master->count = 0;
	if (master->address < 0) {
		err = take_all(master, why, why_size);
	} else {
		err = take_chip(master, (uint8_t)master->address);
		if (err)
			explain(master, err, master->address, why, why_size);
	}
	if (!err && master->channel >= (int)master->chip[0].channels) {
		snprintf(why, why_size, "the chip at 0x%02x on %s has one channel only",
		         master->chip[0].address, master->source.name);
		err = -ENXIO;
	}
	if (err)
		close_adapter(master);
	return err;
}

void ds2482_close(struct link_master *base)
{
	close_adapter((struct ds2482_master *)base);
	ds2482_rest((struct ds2482_master *)base);
}

int ds2482_create(const struct link_master_ops *ops, const struct bus_env *env,
                  const struct ds2482_source *source, const char *where, struct link_master **out,
                  char *why, size_t why_size)
{
	struct ds2482_master *master = calloc(1, sizeof(*master));
	int err;

	if (!master) {
		source->destroy(source->ctx);
		return -ENOMEM;
	}
	master->master.ops = ops;
	master->master.env = env;
	master->source = *source;
	master->active_pullup = true;
	master->power_off_ns = DS2482_POWER_OFF_NS;
	err = parse_where(master, where, why, why_size);
	if (err) {
		ds2482_destroy(&master->master);
		return err;
	}
	*out = &master->master;
	return 0;
}

int ds2482_visible(struct link_master *base, uint64_t *mark)
{
	struct ds2482_master *master = (struct ds2482_master *)base;
	unsigned chips = 0;

	if (!master->source.visible)
		return 1;
	if (master->address >= DS2482_FIRST_ADDRESS)
		chips = 1u << (master->address - DS2482_FIRST_ADDRESS);
	for (unsigned i = 0; master->address < 0 && i < DS2482_ADDRESSES; i++)
		if (master->missing[i] || is_known(master, (uint8_t)(DS2482_FIRST_ADDRESS + i)))
			chips |= 1u << i;
	return master->source.visible(master->source.ctx, base->env, (uint8_t)chips, mark);
}

unsigned ds2482_channels(struct link_master *base)
{
	struct ds2482_master *master = (struct ds2482_master *)base;
	unsigned channels = 0;

	if (master->channel >= 0)
		return master->count > 0;
	for (unsigned i = 0; i < master->count; i++)
		channels += master->chip[i].channels;
	return channels;
}

struct link *ds2482_channel(struct link_master *base, unsigned n)
{
	struct ds2482_master *master = (struct ds2482_master *)base;

	if (n >= ds2482_channels(base))
		return NULL;
	if (master->channel >= 0)
		return &master->chip[0].link[master->channel].link;
	for (unsigned i = 0; i < master->count; i++) {
		if (n < master->chip[i].channels)
			return &master->chip[i].link[n].link;
		n -= master->chip[i].channels;
	}
	return NULL;
}

void ds2482_destroy(struct link_master *base)
{
	struct ds2482_master *master = (struct ds2482_master *)base;

	close_adapter(master);
	ds2482_power_release(master);
	master->source.destroy(master->source.ctx);
	free(master);
}
