/* SPDX-License-Identifier: MIT */
/* The GPIO calls by libgpiod 1.6. */
#include "hal/base/time.h"
#include "hal/gpio/api.h"

#if defined(OWSD_LIBGPIOD) && OWSD_LIBGPIOD == 1
#include <errno.h>
#include <gpiod.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>

struct gpio_chip {
	struct gpiod_chip *chip;
};
struct gpio_line {
	struct gpiod_line *line;
	bool edges;
};

static int library_error(void)
{
	return errno ? -errno : -EIO;
}

static int open_chip(const char *path, struct gpio_chip **out)
{
	struct gpio_chip *chip = malloc(sizeof(*chip));

	if (!chip)
		return -ENOMEM;
	errno = 0;
	chip->chip = gpiod_chip_open(path);
	if (!chip->chip) {
		int err = library_error();

		free(chip);
		return err;
	}
	*out = chip;
	return 0;
}

static void close_chip(struct gpio_chip *chip)
{
	gpiod_chip_close(chip->chip);
	free(chip);
}

static const char *chip_label(struct gpio_chip *chip)
{
	return gpiod_chip_label(chip->chip);
}

static unsigned chip_lines(struct gpio_chip *chip)
{
	return gpiod_chip_num_lines(chip->chip);
}

static int line_info(struct gpio_chip *chip, unsigned offset, struct gpio_info *info)
{
	struct gpiod_line *line;
	const char *name, *consumer;

	errno = 0;
	line = gpiod_chip_get_line(chip->chip, offset);
	/* It may be held, and then what is known of it is what was known before. */
	if (!line || (!gpiod_line_is_requested(line) && gpiod_line_update(line)))
		return library_error();
	name = gpiod_line_name(line);
	consumer = gpiod_line_consumer(line);
	snprintf(info->name, sizeof(info->name), "%s", name ? name : "");
	snprintf(info->consumer, sizeof(info->consumer), "%s", consumer ? consumer : "");
	return 0;
}

static int flags_of(const struct gpio_setup *setup)
{
	static const int bias[] = {
		[GPIO_BIAS_AS_IT_IS] = 0,
		[GPIO_PULL_UP] = GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_UP,
		[GPIO_PULL_DOWN] = GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_DOWN,
	};
	static const int drive[] = {
		[GPIO_PUSH_PULL] = 0,
		[GPIO_OPEN_DRAIN] = GPIOD_LINE_REQUEST_FLAG_OPEN_DRAIN,
		[GPIO_OPEN_SOURCE] = GPIOD_LINE_REQUEST_FLAG_OPEN_SOURCE,
	};
	int flags = setup->active_low ? GPIOD_LINE_REQUEST_FLAG_ACTIVE_LOW : 0;

	if (setup->direction == GPIO_AS_IT_IS)
		return flags; /* the kernel refuses the others without a direction */
	flags |= bias[setup->bias];
	return setup->direction == GPIO_OUTPUT ? flags | drive[setup->drive] : flags;
}

static int request_line(struct gpio_chip *chip, unsigned offset, const struct gpio_setup *setup,
                        const char *consumer, struct gpio_line **out)
{
	static const int types[] = {
		[GPIO_AS_IT_IS] = GPIOD_LINE_REQUEST_DIRECTION_AS_IS,
		[GPIO_INPUT] = GPIOD_LINE_REQUEST_EVENT_BOTH_EDGES,
		[GPIO_OUTPUT] = GPIOD_LINE_REQUEST_DIRECTION_OUTPUT,
	};
	struct gpiod_line_request_config config = {
		.consumer = consumer,
		.request_type = types[setup->direction],
		.flags = flags_of(setup),
	};
	struct gpio_line *line = malloc(sizeof(*line));
	int err;

	if (!line)
		return -ENOMEM;
	errno = 0;
	line->edges = setup->direction == GPIO_INPUT;
	line->line = gpiod_chip_get_line(chip->chip, offset);
	err = line->line ? gpiod_line_request(line->line, &config, setup->value) : -1;
	/* A line without an interrupt can still be read: request it without edges. */
	if (err && line->line && line->edges && errno != EBUSY && errno != EPERM &&
	    errno != ENODEV) {
		line->edges = false;
		config.request_type = GPIOD_LINE_REQUEST_DIRECTION_INPUT;
		errno = 0;
		err = gpiod_line_request(line->line, &config, 0);
	}
	if (err) {
		err = library_error();
		free(line);
		return err;
	}
	*out = line;
	return 0;
}

static int set_line(struct gpio_line *line, bool value)
{
	errno = 0;
	return gpiod_line_set_value(line->line, value) ? library_error() : 0;
}

static int get_line(struct gpio_line *line)
{
	int value;

	errno = 0;
	value = gpiod_line_get_value(line->line);
	return value < 0 ? library_error() : value;
}

static int next_edge(struct gpio_line *line, struct gpio_edge *edge)
{
	struct pollfd ready = {.events = POLLIN};
	struct gpiod_line_event event;

	if (!line->edges)
		return 0;
	ready.fd = gpiod_line_event_get_fd(line->line);
	if (poll(&ready, 1, 0) <= 0)
		return 0;
	errno = 0;
	if (!(ready.revents & POLLIN) || gpiod_line_event_read_fd(ready.fd, &event))
		return ready.revents & POLLIN ? library_error() : -ENODEV;
	/* of CLOCK_MONOTONIC from kernel 5.7 on */
	edge->at_ns = gpio_boottime(event.ts.tv_sec * NS_PER_S + event.ts.tv_nsec);
	edge->value = event.event_type == GPIOD_LINE_EVENT_RISING_EDGE;
	return 1;
}

static void release_line(struct gpio_line *line)
{
	gpiod_line_release(line->line);
	free(line);
}

static const struct gpio_api library = {
	.version = gpiod_version_string,
	.open = open_chip,
	.close = close_chip,
	.label = chip_label,
	.lines = chip_lines,
	.info = line_info,
	.request = request_line,
	.set = set_line,
	.get = get_line,
	.edge = next_edge,
	.release = release_line,
};
const struct gpio_api *const gpio_library = &library;
#elif !defined(OWSD_LIBGPIOD)
const struct gpio_api *const gpio_library;
#endif
