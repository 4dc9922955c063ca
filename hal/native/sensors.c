/* SPDX-License-Identifier: MIT */
/* Reads the file that names the sensors behind bridges. */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "hal/chips/bridges/bridge.h"
#include "hal/chips/bridges/sensor_table.h"
#include "hal/chips/find.h"
#include "hal/native/sensors.h"

#define FILE_MAX 100000

/*
 * At most FILE_MAX + 1 bytes into text. What is not regular might never open or end, as a pipe that
 * nobody writes, and owsd would wait for it.
 */
static int read_file(const char *file, char *text, size_t *n, char *why, size_t why_size)
{
	int fd = open(file, O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC), err = 0;
	struct stat st;
	ssize_t got = 1;

	if (fd < 0 || fstat(fd, &st))
		err = errno;
	else if (!S_ISREG(st.st_mode))
		err = S_ISDIR(st.st_mode) ? EISDIR : -1;
	while (!err && got > 0 && *n <= FILE_MAX) {
		got = read(fd, text + *n, FILE_MAX + 1 - *n);
		if (got < 0 && errno != EINTR)
			err = errno;
		*n += got > 0 ? (size_t)got : 0;
		got = got < 0 ? 1 : got;
	}
	if (fd >= 0)
		close(fd);
	if (err)
		snprintf(why, why_size, "%.80s: %s", file,
		         err < 0 ? "not a regular file" : strerror(err));
	return err ? -EINVAL : 0;
}

int sensors_read(struct sensor_table *table, const char *file, char *why, size_t why_size)
{
	char *text = calloc(1, FILE_MAX + 2);
	size_t n = 0;
	int err = text ? read_file(file, text, &n, why, why_size) : -ENOMEM;

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
