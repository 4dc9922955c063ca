/* SPDX-License-Identifier: MIT */
/* The GPIO calls by libgpiod 2.x. */
#include "hal/gpio/api.h"

#if defined(OWSD_LIBGPIOD) && OWSD_LIBGPIOD == 2
#include <errno.h>
#include <gpiod.h>
#include <stdio.h>
#include <stdlib.h>

struct gpio_chip {
	struct gpiod_chip *chip;
	unsigned lines;
	char label[GPIO_NAME_MAX];
};
struct gpio_line {
	struct gpiod_line_request *request;
	struct gpiod_edge_event_buffer *edges; /* NULL: keeps none */
	unsigned offset;
};

static int library_error(void)
{
	return errno ? -errno : -EIO;
}

static void close_chip(struct gpio_chip *chip)
{
	if (chip->chip)
		gpiod_chip_close(chip->chip);
	free(chip);
}

static int open_chip(const char *path, struct gpio_chip **out)
{
	struct gpio_chip *chip = calloc(1, sizeof(*chip));
	struct gpiod_chip_info *info;
	int err;

	if (!chip)
		return -ENOMEM;
	errno = 0;
	chip->chip = gpiod_chip_open(path);
	info = chip->chip ? gpiod_chip_get_info(chip->chip) : NULL;
	if (!info) {
		err = gpio_open_error(path, library_error());
		close_chip(chip);
		return err;
	}
	chip->lines = (unsigned)gpiod_chip_info_get_num_lines(info);
	snprintf(chip->label, sizeof(chip->label), "%s", gpiod_chip_info_get_label(info));
	gpiod_chip_info_free(info);
	*out = chip;
	return 0;
}

static const char *chip_label(struct gpio_chip *chip)
{
	return chip->label;
}

static unsigned chip_lines(struct gpio_chip *chip)
{
	return chip->lines;
}

static int line_info(struct gpio_chip *chip, unsigned offset, struct gpio_info *info)
{
	struct gpiod_line_info *line;
	const char *name, *consumer;

	errno = 0;
	line = gpiod_chip_get_line_info(chip->chip, offset);
	if (!line)
		return library_error();
	name = gpiod_line_info_get_name(line);
	consumer = gpiod_line_info_get_consumer(line);
	snprintf(info->name, sizeof(info->name), "%s", name ? name : "");
	snprintf(info->consumer, sizeof(info->consumer), "%s", consumer ? consumer : "");
	gpiod_line_info_free(line);
	return 0;
}

static int fill_settings(struct gpiod_line_settings *to, const struct gpio_setup *setup, bool edges)
{
	static const enum gpiod_line_direction directions[] = {
		[GPIO_AS_IT_IS] = GPIOD_LINE_DIRECTION_AS_IS,
		[GPIO_INPUT] = GPIOD_LINE_DIRECTION_INPUT,
		[GPIO_OUTPUT] = GPIOD_LINE_DIRECTION_OUTPUT,
	};
	static const enum gpiod_line_bias biases[] = {
		[GPIO_BIAS_AS_IT_IS] = GPIOD_LINE_BIAS_AS_IS,
		[GPIO_PULL_UP] = GPIOD_LINE_BIAS_PULL_UP,
		[GPIO_PULL_DOWN] = GPIOD_LINE_BIAS_PULL_DOWN,
	};
	static const enum gpiod_line_drive drives[] = {
		[GPIO_PUSH_PULL] = GPIOD_LINE_DRIVE_PUSH_PULL,
		[GPIO_OPEN_DRAIN] = GPIOD_LINE_DRIVE_OPEN_DRAIN,
		[GPIO_OPEN_SOURCE] = GPIOD_LINE_DRIVE_OPEN_SOURCE,
	};
	int err = gpiod_line_settings_set_direction(to, directions[setup->direction]);

	gpiod_line_settings_set_active_low(to, setup->active_low);
	/* The kernel refuses the others without a direction. */
	if (!err && setup->direction != GPIO_AS_IT_IS)
		err = gpiod_line_settings_set_bias(to, biases[setup->bias]);
	if (!err && setup->direction == GPIO_OUTPUT) {
		err = gpiod_line_settings_set_drive(to, drives[setup->drive]);
		if (!err)
			err = gpiod_line_settings_set_output_value(
				to,
				setup->value ? GPIOD_LINE_VALUE_ACTIVE : GPIOD_LINE_VALUE_INACTIVE);
	}
	if (!err && edges)
		err = gpiod_line_settings_set_edge_detection(to, GPIOD_LINE_EDGE_BOTH);
	return err;
}

static struct gpiod_line_request *request_with(struct gpio_chip *chip, unsigned offset,
                                               const struct gpio_setup *setup, const char *consumer,
                                               bool edges)
{
	struct gpiod_line_settings *settings = gpiod_line_settings_new();
	struct gpiod_line_config *lines_config = gpiod_line_config_new();
	struct gpiod_request_config *config = gpiod_request_config_new();
	struct gpiod_line_request *request = NULL;
	int kept;

	errno = 0;
	if (settings && lines_config && config && !fill_settings(settings, setup, edges) &&
	    !gpiod_line_config_add_line_settings(lines_config, &offset, 1, settings)) {
		gpiod_request_config_set_consumer(config, consumer);
		gpiod_request_config_set_event_buffer_size(config, GPIO_EDGES_KEPT);
		request = gpiod_chip_request_lines(chip->chip, config, lines_config);
	}
	kept = errno;
	gpiod_request_config_free(config);
	gpiod_line_config_free(lines_config);
	gpiod_line_settings_free(settings);
	errno = kept;
	return request;
}

static void release_line(struct gpio_line *line)
{
	if (line->request)
		gpiod_line_request_release(line->request);
	gpiod_edge_event_buffer_free(line->edges);
	free(line);
}

static int request_line(struct gpio_chip *chip, unsigned offset, const struct gpio_setup *setup,
                        const char *consumer, struct gpio_line **out)
{
	struct gpio_line *line = calloc(1, sizeof(*line));
	bool edges = setup->direction == GPIO_INPUT;
	int err;

	if (!line)
		return -ENOMEM;
	line->offset = offset;
	line->request = request_with(chip, offset, setup, consumer, edges);
	/* A line without an interrupt can still be read: request it without edges. */
	if (!line->request && edges && errno != EBUSY && errno != EPERM && errno != ENODEV) {
		edges = false;
		line->request = request_with(chip, offset, setup, consumer, false);
	}
	if (line->request && edges)
		line->edges = gpiod_edge_event_buffer_new(1);
	if (!line->request || (edges && !line->edges)) {
		err = library_error();
		release_line(line);
		return err;
	}
	*out = line;
	return 0;
}

static int set_line(struct gpio_line *line, bool value)
{
	errno = 0;
	return gpiod_line_request_set_value(line->request, line->offset,
	                                    value ? GPIOD_LINE_VALUE_ACTIVE
	                                          : GPIOD_LINE_VALUE_INACTIVE)
	               ? library_error()
	               : 0;
}

static int get_line(struct gpio_line *line)
{
	errno = 0;
	switch (gpiod_line_request_get_value(line->request, line->offset)) {
	case GPIOD_LINE_VALUE_ACTIVE:
		return 1;
	case GPIOD_LINE_VALUE_INACTIVE:
		return 0;
	case GPIOD_LINE_VALUE_ERROR:
		break;
	}
	return library_error();
}

static int next_edge(struct gpio_line *line, struct gpio_edge *edge)
{
	struct gpiod_edge_event *event;
	int n;

	errno = 0;
	n = line->edges ? gpiod_line_request_wait_edge_events(line->request, 0) : 0;
	if (n > 0)
		n = gpiod_line_request_read_edge_events(line->request, line->edges, 1);
	if (n <= 0)
		return n < 0 ? library_error() : 0;
	event = gpiod_edge_event_buffer_get_event(line->edges, 0);
	edge->at_ns = gpio_boottime((int64_t)gpiod_edge_event_get_timestamp_ns(event));
	edge->value = gpiod_edge_event_get_event_type(event) == GPIOD_EDGE_EVENT_RISING_EDGE;
	return 1;
}

static const struct gpio_api library = {
	.version = gpiod_api_version,
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
#endif
