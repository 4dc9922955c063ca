/* SPDX-License-Identifier: MIT */
/*
 * GPIO lines, one small interface over libgpiod 1.6 (Debian 12) and 2.x (Debian 13, Raspberry Pi
 * OS). Calls do not block, but for what the chip's driver takes (a chip behind I2C: milliseconds).
 * Errors are negative errno. One thread at a time for each chip and its lines.
 *
 * Room hal/gpio: GPIO lines, alone or beside a chip.
 */
#pragma once

#include <stddef.h>

#include "hal/gpio/api.h"

/* The library of this build, or its substitute, which a test sets before any thread starts. */
extern const struct gpio_api *gpio_substitute;

static inline const struct gpio_api *gpio_api(void)
{
	return gpio_substitute ? gpio_substitute : gpio_library;
}

/*
 * Open a chip by name (gpiochip0), path (/dev/gpiochip0) or label (pinctrl-bcm2711). why gets the
 * remedy of an error: -EOPNOTSUPP: built without libgpiod; -ENODEV: no such chip; -EACCES; -ENOTTY.
 */
int gpio_open(const char *name, struct gpio_chip **chip, char *why, size_t why_size);
void gpio_close(struct gpio_chip *chip);
/* The line's offset by its number or its name; -ENOENT. */
int gpio_offset(struct gpio_chip *chip, const char *text, size_t len);
/* Request a line; on -EBUSY why names the holder. */
int gpio_request(struct gpio_chip *chip, unsigned offset, const struct gpio_setup *setup,
                 struct gpio_line **line, char *why, size_t why_size);

/* What a line can be, in the same order everywhere. */
struct gpio_option {
	const char *word; /* of a line with its chip */
	const char *key;  /* of a Bus block: a list of lines */
	bool active_low;
	uint8_t bias, drive;
};
#define GPIO_OPTIONS 5
extern const struct gpio_option gpio_options[GPIO_OPTIONS];

/*
 * One line with its chip, as options name it: CHIP/LINE, and behind it, each after a comma,
 * active-low, pull-up, pull-down, open-drain, open-source: "gpiochip0/22,active-low".
 */
struct gpio_spec {
	char chip[GPIO_NAME_MAX];
	char line[GPIO_NAME_MAX];
	struct gpio_setup setup;
};
/* 0; -EINVAL with the reason in why; -EOPNOTSUPP: built without libgpiod. Touches nothing. */
int gpio_spec_parse(const char *text, struct gpio_spec *spec, char *why, size_t why_size);

/* An output and its chip. */
struct gpio_output {
	struct gpio_spec spec;
	struct gpio_chip *chip; /* NULL: not taken */
	struct gpio_line *line;
};
/* Take the output with that value, unless it is taken. Errors as gpio_open() and gpio_request(). */
int gpio_output_take(struct gpio_output *output, bool value, char *why, size_t why_size);
int gpio_output_set(struct gpio_output *output, bool value);
void gpio_output_release(struct gpio_output *output);
