/* SPDX-License-Identifier: MIT */
/* The data files of boards: reads them, lists them, and finds the one of this machine. */
#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "src/ground/board/data.h"

#define SUFFIX ".board"
#define KHZ_MAX 5000
#define ADAPTERS (1 << 20)

/* A key with a text, or with the first text of several that is free. */
struct text_key {
	const char *name;
	size_t at;
	unsigned room;
};

static const struct text_key text_keys[] = {
	{"Name", offsetof(struct board_data, name), 1},
	{"Model", offsetof(struct board_data, model), BOARD_MODELS},
	{"HatVendor", offsetof(struct board_data, hat_vendor), 1},
	{"HatProduct", offsetof(struct board_data, hat_product), 1},
	{"Pins", offsetof(struct board_data, pins), 1},
	{"Combine", offsetof(struct board_data, combine), 1},
	{"GpioChip", offsetof(struct board_data, gpio_chip), 1},
	{"Enable", offsetof(struct board_data, enable), 1},
	{"OnLine", offsetof(struct board_data, on_line), 1},
	{"SpeedLine", offsetof(struct board_data, speed_line), 1},
	{"WireLine", offsetof(struct board_data, wire_line), 1},
	{"Chip", offsetof(struct board_data, chip), 1},
	{"Note", offsetof(struct board_data, note), BOARD_NOTES},
};

static int set_text(struct board_data *data, const char *key, const char *value, char *why,
                    size_t why_size)
{
	for (size_t i = 0; i < sizeof(text_keys) / sizeof(text_keys[0]); i++) {
		char *text = (char *)data + text_keys[i].at;
		unsigned n = 0;

		if (strcmp(text_keys[i].name, key))
			continue;
		while (n < text_keys[i].room && text[n * BOARD_TEXT])
			n++;
		if (n == text_keys[i].room) {
			snprintf(why, why_size, "%s is given too often", key);
			return -EINVAL;
		}
		if (strlen(value) >= BOARD_TEXT) {
			snprintf(why, why_size, "%s is longer than %d characters", key,
			         BOARD_TEXT - 1);
			return -EINVAL;
		}
		snprintf(text + n * BOARD_TEXT, BOARD_TEXT, "%s", value);
		return 0;
	}
	snprintf(why, why_size, "unknown key %.40s", key);
	return -EINVAL;
}

static int set_number(const char *key, const char *value, long max, long *number, char *why,
                      size_t why_size)
{
	char *end;

	*number = strtol(value, &end, 10);
	if (end == value || *end || *number < 0 || *number > max) {
		snprintf(why, why_size, "%s: a number from 0 to %ld expected", key, max);
		return -EINVAL;
	}
	return 0;
}

/* Parse a line without its newline. The line is changed. */
static int take_data_line(struct board_data *data, char *line, char *why, size_t why_size)
{
	char *key = line + strspn(line, " \t"), *value;
	size_t len;
	long number = 0;
	int err;

	if (!*key || *key == '#')
		return 0;
	value = key + strcspn(key, " \t");
	if (*value)
		*value++ = '\0';
	value += strspn(value, " \t");
	for (len = strlen(value); len && isspace((unsigned char)value[len - 1]); len--)
		value[len - 1] = '\0';
	if (!*value) {
		snprintf(why, why_size, "%.40s has no value", key);
		return -EINVAL;
	}
	if (!strcmp(key, "I2C")) {
		err = set_number(key, value, ADAPTERS, &number, why, why_size);
		data->i2c = (int)number;
		return err;
	}
	if (!strcmp(key, "KHz")) {
		err = set_number(key, value, KHZ_MAX, &number, why, why_size);
		data->khz = (unsigned)number;
		return err;
	}
	if (!strcmp(key, "Combine") && strcmp(value, "any") && strcmp(value, "one-read")) {
		snprintf(why, why_size, "Combine: any or one-read expected");
		return -EINVAL;
	}
	return set_text(data, key, value, why, why_size);
}

/* The length of a file's name without the suffix; that of all of it where it has none. */
static size_t stem_length(const char *name)
{
	size_t len = strlen(name), tail = strlen(SUFFIX);

	return len > tail && !strcmp(name + len - tail, SUFFIX) ? len - tail : len;
}

int board_data_read(const char *file, struct board_data *data, char *why, size_t why_size)
{
	char line[256], reason[100] = "";
	unsigned number = 0;
	int err = 0;
	FILE *in;

	*data = (struct board_data){.i2c = -1};
	snprintf(data->id, sizeof(data->id), "%.*s", (int)stem_length(basename(file)),
	         basename(file));
	in = fopen(file, "re");
	if (!in) {
		err = -errno;
		snprintf(why, why_size, "%s: %s", file, strerror(-err));
		return err;
	}
	while (!err && fgets(line, sizeof(line), in)) {
		number++;
		if (!strchr(line, '\n') && !feof(in)) {
			snprintf(reason, sizeof(reason), "longer than %zu characters",
			         sizeof(line) - 2);
			err = -EINVAL;
			break;
		}
		line[strcspn(line, "\r\n")] = '\0';
		err = take_data_line(data, line, reason, sizeof(reason));
	}
	if (!err && ferror(in)) {
		err = -EIO;
		snprintf(reason, sizeof(reason), "%s", strerror(EIO));
	}
	fclose(in);
	if (!err && !data->name[0]) {
		snprintf(reason, sizeof(reason), "no Name");
		err = -EINVAL;
	}
	if (err)
		snprintf(why, why_size, "%s:%u: %s", file, number, reason);
	return err;
}

static int by_id(const void *a, const void *b)
{
	return strcmp(((const struct board_data *)a)->id, ((const struct board_data *)b)->id);
}

int board_data_list(const char *folder, struct board_data *data, unsigned max, char *why,
                    size_t why_size)
{
	unsigned count = 0;
	char file[512];
	DIR *dir = opendir(folder);
	int err = 0;

	if (!dir) {
		err = -errno;
		snprintf(why, why_size, "%s: %s", folder, strerror(-err));
		return err;
	}
	for (struct dirent *entry; !err && (entry = readdir(dir));) {
		if (entry->d_name[0] == '.' || !entry->d_name[stem_length(entry->d_name)])
			continue;
		if (count == max) {
			snprintf(why, why_size, "%s: more than %u boards", folder, max);
			err = -E2BIG;
			break;
		}
		snprintf(file, sizeof(file), "%s/%s", folder, entry->d_name);
		err = board_data_read(file, &data[count], why, why_size);
		count += !err;
	}
	closedir(dir);
	if (err)
		return err;
	qsort(data, count, sizeof(*data), by_id);
	return (int)count;
}

const struct board_data *board_data_model(const struct board_data *data, unsigned count,
                                          const char *model)
{
	const struct board_data *best = NULL;
	size_t longest = 0;

	for (unsigned i = 0; i < count; i++)
		for (unsigned m = 0; m < BOARD_MODELS; m++) {
			size_t len = strlen(data[i].model[m]);

			if (len > longest && !strncmp(model, data[i].model[m], len)) {
				longest = len;
				best = &data[i];
			}
		}
	return best;
}

const struct board_data *board_data_hat(const struct board_data *data, unsigned count,
                                        const char *vendor, const char *product)
{
	for (unsigned i = 0; i < count; i++)
		if (data[i].hat_product[0] && !strcmp(data[i].hat_product, product) &&
		    (!data[i].hat_vendor[0] || !strcmp(data[i].hat_vendor, vendor)))
			return &data[i];
	return NULL;
}

const struct board_data *board_data_id(const struct board_data *data, unsigned count,
                                       const char *id)
{
	for (unsigned i = 0; i < count; i++)
		if (!strcmp(data[i].id, id))
			return &data[i];
	return NULL;
}
