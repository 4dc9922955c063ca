/* SPDX-License-Identifier: MIT */
/* GPIO chips and lines over the library: opened, requested, and outputs named by an option. */
#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/rivals.h"
#include "hal/gpio/line.h"

#define CONSUMER "owsd"
#define DEV "/dev/"
#define PREFIX "gpiochip"

const struct gpio_api *gpio_substitute;

static int open_path(const char *path, struct gpio_chip **chip, char *why, size_t why_size)
{
	const struct rivals_device device = {path, path, "gpiodetect lists the chips there are",
	                                     "gpio"};
	int err = gpio_api()->open(path, chip);

	if (err == -ENOTTY || err == -EINVAL) {
		snprintf(why, why_size, "%s is not a GPIO chip: gpiodetect lists them", path);
		return -ENOTTY;
	}
	return err ? rivals_refused(err, &device, 0, why, why_size) : 0;
}

/* Open a chip by its label; looks at all chips. */
static int open_label(const char *label, struct gpio_chip **chip, char *why, size_t why_size)
{
	DIR *dir = opendir(DEV);
	struct dirent *entry;
	const struct rivals_device chips = {DEV PREFIX "*", DEV, "", "gpio"};
	int err = -ENODEV, refused = 0;

	while (err && dir && (entry = readdir(dir))) {
		char path[sizeof(DEV) + sizeof(entry->d_name)];
		int failed;

		if (strncmp(entry->d_name, PREFIX, strlen(PREFIX)) != 0)
			continue;
		snprintf(path, sizeof(path), DEV "%s", entry->d_name);
		failed = gpio_api()->open(path, chip);
		if (failed == -EACCES || failed == -EPERM)
			refused = failed;
		if (failed)
			continue;
		if (strcmp(gpio_api()->label(*chip), label) == 0) {
			err = 0;
		} else {
			gpio_api()->close(*chip);
			*chip = NULL;
		}
	}
	if (dir)
		closedir(dir);
	if (err && refused)
		return rivals_refused(refused, &chips, 0, why, why_size);
	if (err)
		snprintf(why, why_size,
		         "no chip is labelled %s: gpiodetect lists the chips there are", label);
	return err;
}

static bool is_digits(const char *text, size_t len)
{
	for (size_t i = 0; i < len; i++)
		if (!isdigit((unsigned char)text[i]))
			return false;
	return len > 0;
}

int gpio_open(const char *name, struct gpio_chip **chip, char *why, size_t why_size)
{
	size_t prefix = strlen(PREFIX);
	char path[sizeof(DEV PREFIX) + GPIO_NAME_MAX];

	*chip = NULL;
	if (!gpio_api()) {
		snprintf(why, why_size, "this owsd was built without libgpiod");
		return -EOPNOTSUPP;
	}
	if (name[0] == '/')
		return open_path(name, chip, why, why_size);
	if (strncmp(name, PREFIX, prefix) != 0 || !is_digits(name + prefix, strlen(name + prefix)))
		return open_label(name, chip, why, why_size);
	snprintf(path, sizeof(path), DEV "%s", name);
	return open_path(path, chip, why, why_size);
}

void gpio_close(struct gpio_chip *chip)
{
	if (chip)
		gpio_api()->close(chip);
}

int gpio_offset(struct gpio_chip *chip, const char *text, size_t len)
{
	unsigned lines = gpio_api()->lines(chip);
	struct gpio_info info;

	if (is_digits(text, len)) {
		unsigned long number = len > 6 ? lines : strtoul(text, NULL, 10);

		return number < lines ? (int)number : -ENOENT;
	}
	for (unsigned i = 0; len > 0 && i < lines; i++)
		if (gpio_api()->info(chip, i, &info) == 0 && strlen(info.name) == len &&
		    memcmp(info.name, text, len) == 0)
			return (int)i;
	return -ENOENT;
}

int gpio_request(struct gpio_chip *chip, unsigned offset, const struct gpio_setup *setup,
                 struct gpio_line **line, char *why, size_t why_size)
{
	struct gpio_info info = {0};
	int err = gpio_api()->request(chip, offset, setup, CONSUMER, line);

	if (err == -EBUSY && gpio_api()->info(chip, offset, &info) == 0 && info.consumer[0])
		snprintf(why, why_size, "line %u of %s is in use by \"%s\"", offset,
		         gpio_api()->label(chip), info.consumer);
	else if (err == -EBUSY)
		snprintf(why, why_size, "line %u of %s is in use: gpioinfo shows the user", offset,
		         gpio_api()->label(chip));
	else if (err)
		snprintf(why, why_size, "line %u of %s: %s", offset, gpio_api()->label(chip),
		         strerror(-err));
	return err;
}

const struct gpio_option gpio_options[GPIO_OPTIONS] = {
	{"active-low", "ActiveLow", .active_low = true},
	{"pull-up", "PullUp", .bias = GPIO_PULL_UP},
	{"pull-down", "PullDown", .bias = GPIO_PULL_DOWN},
	{"open-drain", "OpenDrain", .drive = GPIO_OPEN_DRAIN},
	{"open-source", "OpenSource", .drive = GPIO_OPEN_SOURCE},
};

static bool apply_word(struct gpio_setup *setup, const char *word, size_t len)
{
	for (size_t i = 0; i < GPIO_OPTIONS; i++) {
		const struct gpio_option *option = &gpio_options[i];

		if (strlen(option->word) != len || memcmp(option->word, word, len) != 0)
			continue;
		setup->active_low |= option->active_low;
		setup->bias |= option->bias;
		setup->drive |= option->drive;
		return true;
	}
	return false;
}

int gpio_spec_parse(const char *text, struct gpio_spec *spec, char *why, size_t why_size)
{
	size_t len = strcspn(text, ","), chip = len;
	const char *word;

	*spec = (struct gpio_spec){.setup.direction = GPIO_OUTPUT};
	if (!gpio_api()) {
		snprintf(why, why_size, "this owsd was built without libgpiod");
		return -EOPNOTSUPP;
	}
	while (chip > 0 && text[chip - 1] != '/')
		chip--;
	if (chip < 2 || chip == len || chip > sizeof(spec->chip) ||
	    len - chip >= sizeof(spec->line)) {
		snprintf(why, why_size, "\"%.80s\": expected CHIP/LINE, as gpiochip0/22", text);
		return -EINVAL;
	}
	memcpy(spec->chip, text, chip - 1);
	memcpy(spec->line, text + chip, len - chip);
	for (word = text + len; *word; word += len) {
		word++;
		len = strcspn(word, ",");
		if (!apply_word(&spec->setup, word, len)) {
			snprintf(why, why_size,
			         "\"%.*s\": expected active-low, pull-up, pull-down, "
			         "open-drain or open-source",
			         (int)(len < 40 ? len : 40), word);
			return -EINVAL;
		}
	}
	if (spec->setup.bias == (GPIO_PULL_UP | GPIO_PULL_DOWN) ||
	    spec->setup.drive == (GPIO_OPEN_DRAIN | GPIO_OPEN_SOURCE)) {
		snprintf(why, why_size, "\"%.80s\": only one pull and one drive", text);
		return -EINVAL;
	}
	return 0;
}

int gpio_output_take(struct gpio_output *output, bool value, char *why, size_t why_size)
{
	struct gpio_setup setup = output->spec.setup;
	int err, offset;

	if (output->line)
		return 0;
	err = gpio_open(output->spec.chip, &output->chip, why, why_size);
	if (err)
		return err;
	offset = gpio_offset(output->chip, output->spec.line, strlen(output->spec.line));
	if (offset < 0) {
		snprintf(why, why_size, "%s has no line %s: gpioinfo lists them", output->spec.chip,
		         output->spec.line);
		err = -ENODEV;
	} else {
		setup.value = value;
		err = gpio_request(output->chip, (unsigned)offset, &setup, &output->line, why,
		                   why_size);
	}
	if (err)
		gpio_output_release(output);
	return err;
}

int gpio_output_set(struct gpio_output *output, bool value)
{
	return output->line ? gpio_api()->set(output->line, value) : -ENODEV;
}

void gpio_output_release(struct gpio_output *output)
{
	if (output->line)
		gpio_api()->release(output->line);
	output->line = NULL;
	gpio_close(output->chip);
	output->chip = NULL;
}
