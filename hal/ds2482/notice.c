/* SPDX-License-Identifier: MIT */
/* When to look for other programs on the adapter, and what to say of them. */
#include <stdio.h>

#include "hal/base/rivals.h"
#include "hal/base/time.h"
#include "hal/ds2482/ds2482.h"
#include "hal/ds2482/io.h"
#include "hal/ds2482/notice.h"

#define LOOK_NS (60 * NS_PER_S)
#define QUIET_NS (600 * NS_PER_S) /* so long after its last sign, what was not seen has gone */
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
static void print_change(struct ds2482_master *master, uint8_t changed)
{
	const char *name = master->source.name;

	if (changed)
		snprintf(master->trouble, sizeof(master->trouble),
		         "0x%02x on %s was reset or changed by another program (owserver? the "
		         "kernel's driver?), or lost its supply: sudo owsd --board names programs",
		         changed, name);
	else
		snprintf(master->trouble, sizeof(master->trouble),
		         "commands on %s fail again and again: does another program use it, as an "
		         "owserver? sudo owsd --board names programs",
		         name);
}

static void look(struct ds2482_master *master, int64_t now)
{
	char who[RIVALS_TEXT];
	bool was_named = master->named;
	bool seen = master->changed || master->failures >= MANY;

	master->named = rivals_find(master->source.proc, master->source.name, who, sizeof(who)) > 0;
	if (master->named) {
		snprintf(master->trouble, sizeof(master->trouble),
		         "%s is also open in %s: two programs on one DS2482 disturb each other",
		         master->source.name, who);
	} else if (seen) {
		if (was_named || !*master->trouble)
			print_change(master, master->changed);
		master->trouble_ns = now;
	} else if (was_named || now - master->trouble_ns >= QUIET_NS) {
		master->trouble[0] = '\0';
	}
	master->changed = 0;
	master->failures = 0;
}

void ds2482_trouble(struct link_master *base, bool failed, char *text, size_t size)
{
	struct ds2482_master *master = (struct ds2482_master *)base;
	int64_t now = ds2482_now(master);

	master->failures += failed;
	if (master->source.proc && due(master, now))
		look(master, now);
	snprintf(text, size, "%s", master->trouble);
}
