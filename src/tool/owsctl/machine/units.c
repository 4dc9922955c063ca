/* SPDX-License-Identifier: MIT */
/* Asks systemd for the units of an instance. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "src/ground/text/shell.h"
#include "src/tool/owsctl/machine/seen.h"
#include "src/tool/owsctl/machine/units.h"

void units_load(struct doctor *d)
{
	char pattern[FACE_UNIT], *rest = d->text, *line;
	const char *const words[] = {"systemctl",   "list-units", "--all", "--plain",
	                             "--no-legend", pattern,      NULL};

	d->units = 0;
	snprintf(pattern, sizeof(pattern), "owsd*@%s.*", d->instance);
	if (!seen_output(d, "systemctl", words))
		return;
	while (d->units < UNITS && (line = strsep(&rest, "\n"))) {
		struct unit *unit = &d->unit[d->units];
		char load[16];

		if (sscanf(line, "%319s %15s %15s %23s", unit->id, load, unit->active, unit->sub) ==
		    4)
			d->units += !strcmp(load, "loaded");
	}
}

const struct unit *units_find(const struct doctor *d, const char *id)
{
	for (unsigned i = 0; i < d->units; i++)
		if (!strcmp(d->unit[i].id, id))
			return &d->unit[i];
	return NULL;
}

const struct unit *units_owsd(const struct doctor *d)
{
	char id[FACE_UNIT];

	snprintf(id, sizeof(id), "owsd@%s.service", d->instance);
	return units_find(d, id);
}

bool unit_is_active(const struct unit *unit)
{
	return unit && !strcmp(unit->active, "active");
}

/* Does owsd run, also where this person may not look at its signals? */
static bool does_run(const struct doctor *d)
{
	return d->alive || ((*d->root || d->err == -EACCES) && unit_is_active(units_owsd(d)));
}

const char *units_load_command(const struct doctor *d, char text[UNITS_COMMAND])
{
	char word[SHELL_WORD];

	if (does_run(d))
		snprintf(text, UNITS_COMMAND, "sudo owsctl -n %s reload", d->instance);
	else if (units_owsd(d))
		snprintf(text, UNITS_COMMAND, "sudo systemctl restart owsd@%s", d->instance);
	else
		snprintf(text, UNITS_COMMAND, "owsd -n %s -c %s", d->instance,
		         shell_word(d->file, word));
	return text;
}
