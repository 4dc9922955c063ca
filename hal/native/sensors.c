/* SPDX-License-Identifier: MIT */
/* Reads the file that names the sensors behind bridges. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/chips/bridge.h"
#include "hal/chips/find.h"
#include "hal/chips/sensor_table.h"
#include "hal/native/sensors.h"

#define FILE_MAX 100000

int sensors_read(struct sensor_table *table, const char *file, char *why, size_t why_size)
{
	char *text = calloc(1, FILE_MAX + 1);
	FILE *in = text ? fopen(file, "re") : NULL;
	size_t n = in ? fread(text, 1, FILE_MAX + 1, in) : 0;
	int err = !text ? -ENOMEM : !in || ferror(in) ? -EINVAL : 0;

	if (err == -EINVAL)
		snprintf(why, why_size, "%.80s: %s", file, strerror(errno));
	if (in)
		fclose(in);
	if (!err && (n > FILE_MAX || strlen(text) != n)) {
		snprintf(why, why_size, "%.80s: not a text of at most %d bytes", file, FILE_MAX);
		err = -EINVAL;
	}
	if (!err) {
		sensor_table_free(table);
		err = sensor_table_parse(table, file, text, why, why_size);
	}
	if (err)
		sensor_table_free(table);
	free(text);
	return err;
}

const struct family *sensors_family(const struct sensor_table *table, const uint8_t rom[8])
{
	const struct family *family = bridge_family(table, rom);

	return family ? family : family_of(rom[0]);
}

bool sensors_has(const struct sensor_table *table, uint8_t code)
{
	for (unsigned i = 0; i < table->bridge_count; i++)
		if (table->bridges[i].rom[0] == code)
			return true;
	return false;
}
