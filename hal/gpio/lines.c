/* SPDX-License-Identifier: MIT */
/* The lines of a GPIO chip as a bus reads and writes them, with the edges of inputs. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/gpio/lines.h"

int lines_option(struct bus *bus, const char *key, const char *text, char *why, size_t why_size)
{
	struct gpio_bus *gpio = (struct gpio_bus *)bus;

	for (int i = 0; i < GPIO_OPTIONS; i++) {
		if (strcmp(gpio_options[i].key, key) != 0)
			continue;
		if (!text[strspn(text, ", \t")]) {
			snprintf(why, why_size, "expected lines, as \"17,27\"");
			return -EINVAL;
		}
		free(gpio->option[i]);
		gpio->option[i] = strdup(text);
		return gpio->option[i] ? 0 : -ENOMEM;
	}
	return -ENOENT;
}

/* False: a line has one pull and one drive, and the setup has another. */
static bool set_option(struct gpio_setup *setup, const struct gpio_option *option)
{
	if ((option->bias && setup->bias && option->bias != setup->bias) ||
	    (option->drive && setup->drive && option->drive != setup->drive))
		return false;
	setup->active_low |= option->active_low;
	setup->bias |= option->bias;
	setup->drive |= option->drive;
	return true;
}

/* Refuse an unknown name: its line would work with the wrong sense. */
static int apply_option(struct gpio_bus *gpio, unsigned option, char *why, size_t why_size)
{
	const char *text = gpio->option[option];

	while (text && *text) {
		size_t len = strcspn(text, ", \t");
		int line = len ? gpio_offset(gpio->chip, text, len) : -1;

		if (len && line < 0) {
			snprintf(why, why_size, "%s: %s has no line %.*s; gpioinfo lists them",
			         gpio_options[option].key, gpio->where, (int)(len < 32 ? len : 32),
			         text);
			return -EINVAL;
		}
		if (len && !set_option(&gpio->line[line].setup, &gpio_options[option])) {
			snprintf(why, why_size,
			         "%s: line %.*s of %s has another pull or drive: name it once",
			         gpio_options[option].key, (int)(len < 32 ? len : 32), text,
			         gpio->where);
			return -EINVAL;
		}
		text += len + (text[len] != '\0');
	}
	return 0;
}

int lines_create(struct gpio_bus *gpio, char *why, size_t why_size)
{
	int err = 0;

	free(gpio->line);
	gpio->lines = gpio_api()->lines(gpio->chip);
	gpio->line = calloc(gpio->lines + 1, sizeof(*gpio->line));
	if (!gpio->line)
		return -ENOMEM;
	for (unsigned i = 0; i < gpio->lines; i++) {
		struct gpio_info info;

		if (gpio_api()->info(gpio->chip, i, &info) == 0)
			memcpy(gpio->line[i].name, info.name, sizeof(info.name));
	}
	for (unsigned i = 0; i < GPIO_OPTIONS && !err; i++)
		err = apply_option(gpio, i, why, why_size);
	return err;
}

void lines_release(struct gpio_bus *gpio)
{
	for (unsigned i = 0; gpio->line && i < gpio->lines; i++) {
		if (gpio->line[i].held)
			gpio_api()->release(gpio->line[i].held);
		gpio->line[i].held = NULL;
	}
}

int lines_find(const struct gpio_bus *gpio, const char *text)
{
	if (!text[strspn(text, "0123456789")])
		return gpio_offset(gpio->chip, text, strlen(text));
	for (unsigned i = 0; i < gpio->lines; i++)
		if (strcmp(gpio->line[i].name, text) == 0)
			return (int)i;
	return -ENOENT;
}

static int hold_line(struct gpio_bus *gpio, unsigned number, const struct gpio_setup *setup,
                     struct gpio_line **held, char *why, size_t why_size)
{
	struct line_state *line = &gpio->line[number];
	int err = gpio_request(gpio->chip, number, setup, held, why, why_size);

	if (!err) {
		line->told = false;
		return 0;
	}
	bus_count(&gpio->count[GPIO_REFUSED], 1);
	if (line->told)
		why[0] = '\0';
	line->told = true;
	switch (-err) {
	case EBUSY:
	case ENODEV:
	case ENXIO:
		return err;
	case EPERM:
	case EACCES:
		return -EACCES;
	default:
		return -EIO;
	}
}

static int line_error(int err)
{
	return err == -ENODEV || err == -ENXIO ? err : -EIO;
}

/* Read a line that owsd does not hold: requested as it is, and released. */
static int peek(struct gpio_bus *gpio, unsigned number, bool *value, char *why, size_t why_size)
{
	struct gpio_setup setup = {.direction = GPIO_AS_IT_IS,
	                           .active_low = gpio->line[number].setup.active_low};
	struct gpio_line *held;
	int level, err = hold_line(gpio, number, &setup, &held, why, why_size);

	if (err)
		return err;
	level = gpio_api()->get(held);
	gpio_api()->release(held);
	*value = level > 0;
	return level < 0 ? line_error(level) : 0;
}

struct edges {
	unsigned count;
	int64_t last_ns[2]; /* of the last one to 0, to 1; 0: none */
	int64_t first_ns[2];
};

/* Take the edges that the kernel kept. When they are GPIO_EDGES_KEPT, others may be lost. */
static int take_edges(struct gpio_bus *gpio, struct line_state *line, struct edges *edges)
{
	struct gpio_edge edge;
	int n = 1;

	*edges = (struct edges){0};
	while (edges->count < 4 * GPIO_EDGES_KEPT &&
	       (n = gpio_api()->edge(line->held, &edge)) > 0) {
		edges->count++;
		edges->last_ns[edge.value] = edge.at_ns;
		if (!edges->first_ns[edge.value])
			edges->first_ns[edge.value] = edge.at_ns;
	}
	bus_count(&gpio->count[GPIO_EDGES], edges->count);
	return n < 0 ? n : 0;
}

/*
 * Show one change at a time: where the level left and came back between two reads, this read shows
 * that it left, and the next read that it is back.
 */
static int read_input(struct gpio_bus *gpio, struct line_state *line, bool *value,
                      int64_t *measured_ns)
{
	struct edges edges;
	int err = take_edges(gpio, line, &edges);
	int level = err ? err : gpio_api()->get(line->held);
	unsigned shown = 0;
	bool pulse;

	if (level < 0)
		return line_error(level);
	pulse = (level != 0) == line->shown && edges.first_ns[!line->shown];
	*value = pulse ? !line->shown : level != 0;
	if (pulse) {
		shown = 1;
		*measured_ns = edges.first_ns[*value];
		line->since_ns = edges.last_ns[level];
		bus_count(&gpio->count[GPIO_PULSES], 1);
		shown += line->since_ns != 0;
	} else if (*value != line->shown) {
		int64_t at_ns = edges.last_ns[*value] ? edges.last_ns[*value] : line->since_ns;

		shown = edges.count ? 1 : 0;
		if (at_ns && edges.count < GPIO_EDGES_KEPT)
			*measured_ns = at_ns;
		line->since_ns = 0;
	}
	if (edges.count > shown)
		bus_count(&gpio->count[GPIO_EDGES_UNSEEN], edges.count - shown);
	line->shown = *value;
	return 0;
}

int line_read(struct gpio_bus *gpio, unsigned number, bool guest, bool *value, int64_t *measured_ns,
              char *why, size_t why_size)
{
	struct line_state *line = &gpio->line[number];
	int level;

	if (!line->held && guest)
		return peek(gpio, number, value, why, why_size);
	if (line->held && line->setup.direction == GPIO_INPUT && !guest)
		return read_input(gpio, line, value, measured_ns);
	if (!line->held) {
		int err;

		line->setup.direction = GPIO_INPUT;
		err = hold_line(gpio, number, &line->setup, &line->held, why, why_size);
		if (err)
			return err;
		line->since_ns = 0;
	}
	level = gpio_api()->get(line->held);
	if (level < 0)
		return line_error(level);
	*value = level;
	if (!guest)
		line->shown = *value;
	return 0;
}

int line_write(struct gpio_bus *gpio, unsigned number, bool guest, bool value, char *why,
               size_t why_size)
{
	struct line_state *line = &gpio->line[number];
	bool output = line->held && line->setup.direction == GPIO_OUTPUT;

	if (guest && !output)
		return -EACCES;
	if (output) {
		int err = gpio_api()->set(line->held, value);

		return err ? line_error(err) : 0;
	}
	if (line->held)
		gpio_api()->release(line->held);
	line->held = NULL;
	line->setup.direction = GPIO_OUTPUT;
	line->setup.value = value;
	return hold_line(gpio, number, &line->setup, &line->held, why, why_size);
}
