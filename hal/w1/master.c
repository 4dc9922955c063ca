/* SPDX-License-Identifier: MIT */
/* The kernel's masters, each a link, and the lists of their slaves. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/chips/find.h"
#include "hal/w1/w1.h"

void w1_master_name(unsigned number, char name[24])
{
	snprintf(name, 24, "w1_bus_master%u", number);
}

/* "w1_bus_masterN"; 0: it is none. */
static unsigned master_number(const char *text)
{
	static const char prefix[] = "w1_bus_master";
	char *end;

	if (strncmp(text, prefix, sizeof(prefix) - 1) != 0 || text[sizeof(prefix) - 1] < '1' ||
	    text[sizeof(prefix) - 1] > '9')
		return 0;
	unsigned long number = strtoul(text + sizeof(prefix) - 1, &end, 10);
	return *end || number > 9999 ? 0 : (unsigned)number;
}

static int take_where(struct w1_master *master, const char *where, char *why, size_t why_size)
{
	static const char root[] = "root=";
	const char *path = where + sizeof(root) - 1;

	snprintf(master->root, sizeof(master->root), "%s", W1_ROOT);
	if (!*where)
		return 0;
	if (strncmp(where, root, sizeof(root) - 1) != 0) {
		master->only = master_number(where);
		if (!master->only)
			snprintf(why, why_size,
			         "'w1:' is followed by nothing or by a master, as in "
			         "w1:w1_bus_master1");
		return master->only ? 0 : -EINVAL;
	}
	const char *slash = strrchr(path, '/');
	size_t len = strlen(path);
	master->only = slash ? master_number(slash + 1) : 0;
	if (master->only)
		len = (size_t)(slash - path);
	if (path[0] != '/' || len >= sizeof(master->root)) {
		snprintf(why, why_size, "'w1:root=' is followed by the whole path of a directory");
		return -EINVAL;
	}
	snprintf(master->root, sizeof(master->root), "%.*s", (int)len, path);
	return 0;
}

static int create(const char *where, const struct bus_env *env, struct link_master **out, char *why,
                  size_t why_size)
{
	struct w1_master *master = calloc(1, sizeof(*master));

	if (!master)
		return -ENOMEM;
	int err = take_where(master, where, why, why_size);
	if (err) {
		free(master);
		return err;
	}
	master->master = (struct link_master){.ops = &w1_master, .env = env};
	master->uevents = -1;
	*out = &master->master;
	return 0;
}

static void destroy(struct link_master *base)
{
	w1_uevents_close((struct w1_master *)base);
	free(base);
}

static bool has_link(const struct w1_master *master, unsigned number)
{
	for (unsigned i = 0; i < master->count; i++)
		if (master->links[i].number == number)
			return true;
	return false;
}

/* The kernel numbers its masters from 1 on and gives the lowest that is free. */
unsigned w1_look_for_masters(struct w1_master *master)
{
	unsigned first = master->only ? master->only : 1, before = master->count;
	unsigned last = master->only ? master->only : W1_MASTERS;
	char name[24];

	for (unsigned n = first; n <= last && master->count < W1_MASTERS; n++) {
		w1_master_name(n, name);
		if (has_link(master, n) || !w1_exists(master, name, ""))
			continue;
		struct w1_link *link = &master->links[master->count];
		*link = (struct w1_link){.link = {.ops = &w1_link_ops,
		                                  .env = master->master.env,
		                                  .chip = master->count,
		                                  .files = &w1_files},
		                         .master = master,
		                         .number = n};
		master->count++;
	}
	return master->count - before;
}

static int open_masters(struct link_master *base, char *why, size_t why_size)
{
	struct w1_master *master = (struct w1_master *)base;

	master->count = 0;
	master->slave_count = 0;
	master->told_rights = false;
	if (w1_look_for_masters(master)) {
		if (strcmp(master->root, W1_ROOT) == 0)
			w1_uevents_open(master);
		return 0;
	}
	if (master->only)
		snprintf(why, why_size, "the kernel has no w1_bus_master%u", master->only);
	else
		snprintf(why, why_size,
		         "no 1-Wire master in the kernel: modprobe its driver, or "
		         "dtoverlay=w1-gpio on a Raspberry Pi");
	return -ENODEV;
}

static void close_masters(struct link_master *base)
{
	struct w1_master *master = (struct w1_master *)base;

	master->count = 0;
	w1_uevents_close(master);
}

/* Directories say what is there without a look at any wire. */
static int there(struct link_master *base, uint64_t *mark)
{
	const struct w1_master *master = (const struct w1_master *)base;
	unsigned first = master->only ? master->only : 1;
	unsigned last = master->only ? master->only : W1_MASTERS;
	char name[24];

	for (unsigned n = first; n <= last; n++) {
		w1_master_name(n, name);
		if (w1_exists(master, name, ""))
			*mark |= UINT64_C(1) << n % 64;
	}
	return *mark != 0;
}

static unsigned channels(struct link_master *base)
{
	return ((struct w1_master *)base)->count;
}

static struct link *channel(struct link_master *base, unsigned n)
{
	return &((struct w1_master *)base)->links[n].link;
}

struct w1_slave *w1_slave_of(struct w1_master *master, const uint8_t rom[8])
{
	for (unsigned i = 0; i < master->slave_count; i++)
		if (memcmp(master->slaves[i].rom, rom, 7) == 0)
			return &master->slaves[i];
	/* Full of those that came and went: what is known of them can be read again. */
	if (master->slave_count == DEVICE_MAX)
		master->slave_count = 0;
	struct w1_slave *slave = &master->slaves[master->slave_count++];
	*slave = (struct w1_slave){.condition_ns = 0};
	memcpy(slave->rom, rom, 8);
	return slave;
}

static bool all_gone(const struct w1_master *master)
{
	char name[24];

	for (unsigned i = 0; i < master->count; i++) {
		w1_master_name(master->links[i].number, name);
		if (w1_exists(master, name, ""))
			return false;
	}
	return true;
}

/* Without a list the master is gone, and its slaves with it; -ENODEV: so are all others. */
static int read_list(struct w1_link *link)
{
	struct w1_master *master = link->master;
	char name[24];

	w1_master_name(link->number, name);
	int n = w1_slaves(master, name);
	if (n == -ENODEV || n == -ENOENT)
		return all_gone(master) ? -ENODEV : 0;
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
		struct w1_slave *slave = w1_slave_of(link->master, rom);
		slave->channel = (uint8_t)(link - link->master->links);
		return slave;
	}
	return NULL;
}

/* Thermometers whose alarm is asked for convert at once, too, if there are several. */
static void convert_for_alarms(struct w1_link *link, uint8_t family, char *end)
{
	char *line = link->master->lists;
	struct w1_slave *slave;
	unsigned count = 0;

	while ((slave = next_slave(link, family, &line, end)))
		count += w1_alarm_converts(link->master, slave);
	if (count > 1)
		w1_convert_all(link);
}

static int search(struct link *base, bool alarm, uint8_t family, link_found *found, void *ctx)
{
	struct w1_link *link = (struct w1_link *)base;
	struct w1_master *master = link->master;
	int n = read_list(link), err = 0;
	bool told = false, hidden = false;
	char *line = master->lists;
	struct w1_slave *slave;

	if (n < 0)
		return n;
	if (alarm)
		convert_for_alarms(link, family, line + n);
	while (!err && (slave = next_slave(link, family, &line, master->lists + n))) {
		int in = alarm ? w1_in_alarm(master, slave) : 1;

		hidden |= in == -EOPNOTSUPP && family_of(slave->rom[0])->alarms;
		told |= in >= 0;
		err = in == 1 ? found(ctx, slave->rom) : 0;
	}
	if (err)
		return err;
	/* A list that leaves out those of which nothing can be told would hide their alarms. */
	return hidden && (family || !told) ? -EOPNOTSUPP : 0;
}

const struct link_files w1_files = {.property = w1_property, .search = search};

const struct link_master_ops w1_master = {
	.create = create,
	.open = open_masters,
	.close = close_masters,
	.there = there,
	.channels = channels,
	.channel = channel,
	.destroy = destroy,
};
