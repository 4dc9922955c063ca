/* SPDX-License-Identifier: MIT */
/*
 * What a master does as a link: areas by the attributes of a slave's driver, lists of slaves and of
 * those in alarm. A slave without a driver has the attribute "rw" for commands: each is whole in
 * one write (reset, Match ROM, the command), and what is read then is its answer.
 */
#include <errno.h>
#include <string.h>

#include "hal/chips/area.h"
#include "hal/chips/find.h"
#include "hal/w1/driver.h"
#include "hal/w1/link.h"
#include "hal/w1/name.h"
#include "hal/w1/state.h"

#define MATCH_ROM 0x55

static struct w1_link *w1_link_of(struct link *link)
{
	return (struct w1_link *)link;
}

static struct w1_slave *slave_of(struct link *link, const uint8_t rom[8])
{
	return w1_slave_of(&w1_link_of(link)->master->slaves, rom);
}

/* --- Raw access --- */

static int raw_write(struct w1_link *link, const uint8_t *bytes, size_t n)
{
	if (link->slave || n < 9 || bytes[0] != MATCH_ROM)
		return -EOPNOTSUPP;
	struct w1_slave *slave = slave_of(&link->link, bytes + 1);
	if (w1_driver_of(slave))
		return -EOPNOTSUPP;
	link->slave = slave;
	return w1_slave_write(slave, "rw", 0, bytes + 9, n - 9);
}

static int w1_link_run(struct link *base, const struct link_part *part)
{
	struct w1_link *link = w1_link_of(base);
	int err = part->after == LINK_STRONG ? -EOPNOTSUPP : 0;

	if (part->reset)
		link->slave = NULL;
	if (!err && part->out_n)
		err = raw_write(link, part->out, part->out_n);
	if (err || !part->in_n)
		return err;
	return link->slave ? w1_slave_read(link->slave, "rw", 0, part->in, part->in_n)
	                   : -EOPNOTSUPP;
}

/* --- Drivers --- */

static bool has_driver(struct link *link, const uint8_t rom[8])
{
	return w1_driver_of(slave_of(link, rom)) != NULL;
}

static bool offers(struct link *link, const uint8_t rom[8], const char *property, int element)
{
	return w1_offers(slave_of(link, rom), property, element);
}

static int w1_read_area(struct link *link, const uint8_t rom[8], const struct area *area,
                        unsigned at, uint8_t *bytes, unsigned n)
{
	struct w1_slave *slave = slave_of(link, rom);
	const struct w1_part *part = w1_part_of(slave, area->name);

	return part && part->read ? part->read(slave, at, bytes, n) : -ENOENT;
}

static int w1_write_area(struct link *link, const uint8_t rom[8], const struct area *area,
                         unsigned at, const uint8_t *bytes, unsigned n)
{
	struct w1_slave *slave = slave_of(link, rom);
	const struct w1_part *part = w1_part_of(slave, area->name);

	return part && part->write ? part->write(slave, at, bytes, n) : -EOPNOTSUPP;
}

static int w1_link_convert(struct link *base, const uint8_t *rom, const char *what)
{
	struct w1_link *link = w1_link_of(base);

	if (!rom) {
		w1_convert_all(&link->master->slaves, &link->bulk);
		return 0;
	}
	struct w1_slave *slave = slave_of(base, rom);
	const struct w1_driver *driver = w1_driver_of(slave);
	return driver && driver->convert ? driver->convert(slave, what) : -EOPNOTSUPP;
}

/* --- Lists --- */

static bool all_gone(const struct w1_master *master)
{
	char name[W1_MASTER_NAME_MAX];

	for (unsigned i = 0; i < master->count; i++) {
		w1_master_name(master->links[i].bulk.number, name);
		if (w1_exists(&master->tree, name, ""))
			return false;
	}
	return true;
}

/* Without a list the master is gone, and its slaves with it; -ENODEV: so are all others. */
static int read_list(struct w1_link *link)
{
	char name[W1_MASTER_NAME_MAX];

	w1_master_name(link->bulk.number, name);
	int n = w1_slaves(&link->master->tree, name);
	if (n == -ENODEV || n == -ENOENT)
		return all_gone(link->master) ? -ENODEV : 0;
	return n;
}

/* The next slave of the list, of one family or (0) of all; NULL: no more. */
static struct w1_slave *next_slave(struct w1_link *link, uint8_t family, char **line, char *end)
{
	uint8_t rom[8];

	while (*line < end) {
		char *stop = memchr(*line, '\n', (size_t)(end - *line));
		size_t len = (size_t)((stop ? stop : end) - *line);
		bool is_rom = w1_name_parse(*line, len, rom);

		*line += len + 1;
		if (!is_rom || (family && rom[0] != family))
			continue;
		struct w1_slave *slave = w1_slave_of(&link->master->slaves, rom);
		slave->channel = link->bulk.channel;
		return slave;
	}
	return NULL;
}

/* Thermometers whose alarm is asked for convert at once, too, if there are several. */
static void convert_for_alarms(struct w1_link *link, uint8_t family, char *end)
{
	char *line = link->master->tree.lists;
	struct w1_slave *slave;
	unsigned count = 0;

	while ((slave = next_slave(link, family, &line, end)))
		count += w1_alarm_converts(slave);
	if (count > 1)
		w1_convert_all(&link->master->slaves, &link->bulk);
}

static int w1_link_search(struct link *base, bool alarm, uint8_t family, link_found *found,
                          void *ctx)
{
	struct w1_link *link = w1_link_of(base);
	char *line = link->master->tree.lists;
	int n = read_list(link), err = 0;
	bool told = false, hidden = false;
	struct w1_slave *slave;

	if (n < 0)
		return n;
	char *end = line + n;
	if (alarm)
		convert_for_alarms(link, family, end);
	while (!err && (slave = next_slave(link, family, &line, end))) {
		int in = alarm ? w1_in_alarm(slave) : 1;

		hidden |= in == -EOPNOTSUPP && family_of(slave->rom[0])->alarms;
		told |= in >= 0;
		err = in == 1 ? found(ctx, slave->rom) : 0;
	}
	if (err)
		return err;
	/* A list that leaves out those of which nothing can be told would hide their alarms. */
	return hidden && (family || !told) ? -EOPNOTSUPP : 0;
}

static int w1_link_verify(struct link *base, const uint8_t rom[8], bool alarm)
{
	struct w1_link *link = w1_link_of(base);
	char *line = link->master->tree.lists;
	struct w1_slave *slave;
	int n = read_list(link);

	if (n < 0)
		return n;
	while ((slave = next_slave(link, rom[0], &line, link->master->tree.lists + n)))
		if (memcmp(slave->rom, rom, 8) == 0)
			return alarm ? w1_in_alarm(slave) : 1;
	return 0;
}

const struct link_ops w1_link_ops = {
	.name = "w1",
	.run = w1_link_run,
	.search = w1_link_search,
	.verify = w1_link_verify,
};

/* The kernel's drivers see to the pull-up: those without one of their own are asked for none. */
const struct link_facts w1_link_facts = {.strong = true};

const struct driver_ops w1_driver_ops = {
	.has = has_driver,
	.offers = offers,
	.area_read = w1_read_area,
	.area_write = w1_write_area,
	.convert = w1_link_convert,
};
