/* SPDX-License-Identifier: MIT */
/* The master of the target i2c:auto: every DS2482 of the machine. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>

#include "hal/ds2482/ds2482.h"
#include "hal/ds2482/every.h"

#define LINKS 64 /* as many as a native bus takes */

struct every_adapter {
	unsigned number;
	struct link_master *master;
	bool open;
	uint64_t failed_mark; /* the state of the chips when opening the adapter last failed */
};

struct every_master {
	struct link_master master; /* first */
	struct every_source source;
	struct every_adapter adapter[EVERY_ADAPTERS];
	unsigned count;
	struct link *link[LINKS];
	unsigned links;
};

static struct every_adapter *adapter_of(struct every_master *every, unsigned number)
{
	struct every_adapter *adapter = &every->adapter[every->count];

	for (unsigned i = 0; i < every->count; i++)
		if (every->adapter[i].number == number)
			return &every->adapter[i];
	if (every->count == EVERY_ADAPTERS)
		return NULL;
	*adapter = (struct every_adapter){.number = number};
	if (every->source.make(every->source.ctx, number, every->master.env, &adapter->master))
		return NULL;
	every->count++;
	return adapter;
}

/* Append the new links. Each chip gets its own number. */
static void take_links(struct every_master *every, const struct every_adapter *adapter)
{
	unsigned n = adapter->master->ops->channels(adapter->master);

	for (unsigned i = 0; i < n; i++) {
		struct link *link = adapter->master->ops->channel(adapter->master, i);
		unsigned at = 0;

		while (at < every->links && every->link[at] != link)
			at++;
		if (at < every->links || every->links == LINKS)
			continue;
		link->chip = (unsigned)(adapter - every->adapter) * DS2482_ADDRESSES +
		             link->chip % DS2482_ADDRESSES;
		every->link[every->links++] = link;
	}
}

static int open_one(struct every_master *every, struct every_adapter *adapter, char *why,
                    size_t why_size)
{
	int err = adapter->master->ops->open(adapter->master, why, why_size);

	adapter->open = !err;
	adapter->failed_mark = 0;
	if (err)
		(void)adapter->master->ops->visible(adapter->master, &adapter->failed_mark);
	else
		take_links(every, adapter);
	return err;
}

static void every_close(struct link_master *base)
{
	struct every_master *every = (struct every_master *)base;

	for (unsigned i = 0; i < every->count; i++) {
		if (every->adapter[i].open)
			every->adapter[i].master->ops->close(every->adapter[i].master);
		every->adapter[i].open = false;
	}
	every->links = 0;
}

/* Does the error state more than that no chip answers? */
static bool is_telling(int err)
{
	return err != -ENXIO && err != -EIO && err != -ENODEV;
}

static int every_open(struct link_master *base, char *why, size_t why_size)
{
	struct every_master *every = (struct every_master *)base;
	unsigned number[EVERY_ADAPTERS], n;
	char reason[128];
	int worst = -ENXIO;

	n = every->source.list(every->source.ctx, number, EVERY_ADAPTERS);
	if (!n) {
		snprintf(why, why_size,
		         "no /dev/i2c-*: switch I2C on (Raspberry Pi: "
		         "dtparam=i2c_arm=on), load the module i2c-dev");
		return -ENODEV;
	}
	snprintf(why, why_size, "no DS2482 answers at 0x18 to 0x1f on any of %u I2C adapters", n);
	for (unsigned i = 0; i < n; i++) {
		struct every_adapter *adapter = adapter_of(every, number[i]);
		int err = adapter ? open_one(every, adapter, reason, sizeof(reason)) : -ENOMEM;

		if (err == -ECANCELED || err == -ENOMEM) {
			every_close(base);
			return err;
		}
		if (!err || !is_telling(err) || is_telling(worst))
			continue;
		worst = err;
		snprintf(why, why_size, "%s", reason);
	}
	return every->links ? 0 : worst;
}

static int grow_one(struct every_master *every, struct every_adapter *adapter, char *why,
                    size_t why_size)
{
	uint64_t mark = 0;
	int left;

	if (adapter->open) {
		left = adapter->master->ops->grow(adapter->master, why, why_size);
		if (left >= 0)
			take_links(every, adapter);
		return left;
	}
	if (adapter->master->ops->visible(adapter->master, &mark) <= 0 ||
	    mark == adapter->failed_mark)
		return 0;
	left = open_one(every, adapter, why, why_size);
	why[0] = '\0';
	return left == -ECANCELED ? left : 0;
}

/* One more adapter may always come. */
static int every_grow(struct link_master *base, char *why, size_t why_size)
{
	struct every_master *every = (struct every_master *)base;
	unsigned number[EVERY_ADAPTERS];
	unsigned n = every->source.list(every->source.ctx, number, EVERY_ADAPTERS);
	char reason[128] = "";

	why[0] = '\0';
	for (unsigned i = 0; i < n; i++) {
		struct every_adapter *adapter = adapter_of(every, number[i]);
		int left = adapter ? grow_one(every, adapter, reason, sizeof(reason)) : 0;

		if (left)
			snprintf(why, why_size, "%s", reason);
		if (left < 0)
			return left;
	}
	return 1;
}

static int every_visible(struct link_master *base, uint64_t *mark)
{
	struct every_master *every = (struct every_master *)base;
	unsigned number[EVERY_ADAPTERS];
	unsigned n = every->source.list(every->source.ctx, number, EVERY_ADAPTERS);
	int there = 0;

	for (unsigned i = 0; i < n; i++) {
		struct every_adapter *adapter = adapter_of(every, number[i]);

		if (adapter)
			there |= adapter->master->ops->visible(adapter->master, mark);
		*mark = (*mark ^ number[i]) * 31;
	}
	return there > 0;
}

/* That of all adapters, one after the other. */
static void every_trouble(struct link_master *base, bool failed, char *text, size_t size)
{
	struct every_master *every = (struct every_master *)base;
	size_t len = 0;

	text[0] = '\0';
	for (unsigned i = 0; i < every->count && len < size; i++) {
		struct link_master *master = every->adapter[i].master;
		char one[BUS_EVENT_TEXT] = "";

		if (every->adapter[i].open && master->ops->trouble)
			master->ops->trouble(master, failed, one, sizeof(one));
		if (*one)
			len += (size_t)snprintf(text + len, size - len, "%s%s", len ? "; " : "",
			                        one);
	}
}

static unsigned every_channels(struct link_master *base)
{
	return ((struct every_master *)base)->links;
}

static struct link *every_channel(struct link_master *base, unsigned n)
{
	struct every_master *every = (struct every_master *)base;

	return n < every->links ? every->link[n] : NULL;
}

static void every_cost(const struct link_master *base, struct link_master_cost *cost)
{
	const struct every_master *every = (const struct every_master *)base;

	*cost = (struct link_master_cost){0};
	for (unsigned i = 0; i < every->count; i++) {
		const struct link_master *master = every->adapter[i].master;
		struct link_master_cost one;

		master->ops->cost(master, &one);
		cost->transfers += one.transfers;
		cost->bytes += one.bytes;
		cost->syscalls += one.syscalls;
	}
}

static void every_destroy(struct link_master *base)
{
	struct every_master *every = (struct every_master *)base;

	for (unsigned i = 0; i < every->count; i++)
		every->adapter[i].master->ops->destroy(every->adapter[i].master);
	free(every);
}

static const struct link_master_ops every_ops = {
	.open = every_open,
	.grow = every_grow,
	.close = every_close,
	.trouble = every_trouble,
	.visible = every_visible,
	.channels = every_channels,
	.channel = every_channel,
	.cost = every_cost,
	.destroy = every_destroy,
};

int every_create(const struct bus_env *env, const struct every_source *source,
                 struct link_master **master)
{
	struct every_master *every = calloc(1, sizeof(*every));

	if (!every)
		return -ENOMEM;
	every->master = (struct link_master){.ops = &every_ops, .env = env};
	every->source = *source;
	*master = &every->master;
	return 0;
}
