/* SPDX-License-Identifier: MIT */
/*
 * families: what the tables say of the chip families, for docs/devices.py. A line each, with tabs:
 *   family CODE TYPE ALARMS SEVERAL     then what belongs to it:
 *   kind NUMBER TYPE                    a chip of those that have the code
 *   scan NAME WORD                      what a scan makes a signal of
 *   property NAME TYPE ACCESS HIDDEN LEAST MOST DECIMALS UNIT ALARM HOLDS SIZE
 *   simulated NAME                      a chip that the simulator has
 */
#include <stdio.h>

#include "hal/chips/find.h"
#include "hal/sim/slave.h"

static void print_property(const struct property *p)
{
	printf("property\t%s\t%c\t%d\t%d\t%g\t%g\t%d\t%s\t%d\t%d\t%u\n", p->name, p->type,
	       p->access, p->hidden, p->measures.least, p->measures.most, p->measures.decimals,
	       p->measures.unit, p->alarm, p->holds, p->size);
}

/* Those that some of its properties are of. */
static void print_kinds(const struct family *family)
{
	uint32_t kinds = 0;

	for (unsigned i = 0; family->types && i < family->count; i++)
		kinds |= family->properties[i].kinds;
	for (unsigned kind = 1; kind < 32; kind++)
		if (kinds & KIND(kind))
			printf("kind\t%u\t%s\n", kind, family->types[kind]);
}

int main(void)
{
	const struct family *family;

	for (unsigned n = 0; (family = family_nth(n)); n++) {
		printf("family\t%02X\t%s\t%d\t%d\n", family->code, family->type, family->alarms,
		       family->several);
		print_kinds(family);
		for (const struct family_scan *scan = family->scan; scan && scan->name; scan++)
			printf("scan\t%s\t%s\n", scan->name, scan->word);
		for (unsigned i = 0; i < family->count; i++)
			print_property(&family->properties[i]);
		for (const struct sim_family *const *sim = sim_families; *sim; sim++)
			if ((*sim)->code == family->code)
				printf("simulated\t%s\n", (*sim)->name);
	}
	return 0;
}
