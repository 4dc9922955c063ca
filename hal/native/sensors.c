/* SPDX-License-Identifier: MIT */
/* Reads the file that names the sensors behind bridges. */
#include <errno.h>
#include <stdlib.h>

#include "hal/base/file.h"
#include "hal/chips/bridges/bridge.h"
#include "hal/chips/bridges/sensor_table.h"
#include "hal/chips/find.h"
#include "hal/native/sensors.h"

#define FILE_MAX 100000

int sensors_read(struct sensor_table *table, const char *file, char *why, size_t why_size)
{
	int err;
	char *text = file_text(file, FILE_MAX, &err, why, why_size);

	sensor_table_free(table);
	if (!text)
		return err == -ENOMEM ? err : -EINVAL;
	err = sensor_table_parse(table, file, text, why, why_size);
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
