/* SPDX-License-Identifier: MIT */
/* When to look for other programs on the adapter, and what the log has to say of them. */
#include <stdio.h>

#include "hal/base/time.h"
#include "hal/ds2482/ds2482.h"
#include "hal/ds2482/io.h"
#include "hal/ds2482/notice.h"
#include "hal/ds2482/rivals.h"

#define LOOK_NS (60 * NS_PER_S)
#define TOLD_NS (3600 * NS_PER_S)
/* So many errors between two looks are more than noise now and then. */
#define MANY 10

/* A chip that was changed is worth a look of its own, however short the last one is ago. */
static bool due(struct ds2482_master *master, int64_t now)
{
	int64_t *next = master->changed ? &master->changed_look_ns : &master->look_ns;

	if (now < *next)
		return false;
	*next = now + LOOK_NS;
	return true;
}

/* What was seen of it, where no program was. */
static void print_trouble(const struct ds2482_master *master, uint8_t changed, char *text,
                          size_t size)
{
	const char *name = master->source.name;

	if (changed)
		snprintf(text, size,
		         "0x%02x on %s was reset or changed by another program (owserver? the "
		         "kernel's driver?), or lost its supply: sudo owsd --board names programs",
		         changed, name);
	else
		snprintf(text, size,
		         "commands on %s fail again and again: does another program use it, as an "
		         "owserver? sudo owsd --board names programs",
		         name);
}

bool ds2482_notice(struct link_master *base, char *text, size_t size)
{
	struct ds2482_master *master = (struct ds2482_master *)base;
	int64_t now = ds2482_now(master);
	char who[RIVALS_TEXT];
	unsigned open, failures = ++master->failures;
	uint8_t changed = master->changed;

	if (!master->source.proc || !due(master, now))
		return false;
	master->changed = 0;
	master->failures = 0;
	open = rivals_find(master->source.proc, master->source.name, &master->rivals, who,
	                   sizeof(who));
	if (who[0]) {
		snprintf(text, size,
		         "%s is also open in %s: two programs on one DS2482 disturb each other",
		         master->source.name, who);
		return true;
	}
	if (open || (!changed && failures < MANY) || now < master->told_ns)
		return false;
	master->told_ns = now + TOLD_NS;
	print_trouble(master, changed, text, size);
	return true;
}
