/* SPDX-License-Identifier: MIT */
/* Reads an alias file of OWFS: "28.551DDF030000 = kitchen" in each line. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/owfs/path.h"
#include "src/owsctl/ctl.h"
#include "src/owsctl/scan_alias.h"
#include "src/show/text.h"

/* Name each device of this id; a device behind several ways is found several times. */
static bool name_devices(struct scan *scan, const uint8_t rom[ROM_LEN], const char *name,
                         size_t len)
{
	char id[ROM_TEXT_MAX];
	bool found = false;

	rom_print(rom, ROM_F_I, id);
	for (unsigned i = 0; i < scan->count; i++) {
		struct scan_device *device = &scan->device[i];

		if (strcmp(strrchr(device->path, '/') + 1, id) != 0)
			continue;
		text_clean(name, len, sizeof(device->alias), device->alias, sizeof(device->alias));
		found = true;
	}
	return found;
}

/* One line as owserver takes it: an id with or without a slash, blanks or '=', and the name. */
static void scan_alias_take(const char *file, unsigned number, char *line, struct scan *scan)
{
	uint8_t rom[ROM_LEN];
	char *id = line + strspn(line, " \t/"), *name;
	size_t len = strcspn(id, " \t=:\r\n"), end;

	if (!len || *id == '#')
		return;
	name = id + len + strspn(id + len, " \t=:");
	for (end = strlen(name); end && strchr(" \t\r\n", name[end - 1]);)
		end--;
	if (rom_parse(id, len, rom))
		ctl_fail("%s:%u: %.*s is no id of a device", file, number, (int)len, id);
	else if (!end)
		ctl_fail("%s:%u: %.*s has no name here", file, number, (int)len, id);
	else if (!name_devices(scan, rom, name, end))
		ctl_fail("%s:%u: %.*s was not found", file, number, (int)len, id);
}

int scan_aliases(const char *file, struct scan *scan)
{
	FILE *stream = fopen(file, "re");
	char *line = NULL;
	size_t room = 0;
	int err;

	if (!stream)
		return ctl_fail("%s: %s", file, strerror(errno));
	for (unsigned number = 1; getline(&line, &room, stream) >= 0; number++)
		scan_alias_take(file, number, line, scan);
	err = ferror(stream) ? errno : 0;
	free(line);
	fclose(stream);
	return err ? ctl_fail("%s: %s", file, strerror(err)) : CTL_DONE;
}
