/* SPDX-License-Identifier: MIT */
/* A GPIO library with one fake chip. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "tests/unit/aid/fake_gpio.h"

struct fake_gpio fake_gpio;

/* The code under test only gets the addresses of these. */
struct gpio_chip {
	char none;
};
struct gpio_line {
	struct fake_line *line;
};
static struct gpio_chip the_chip;
static struct gpio_line handles[FAKE_LINES];

static const char *version(void)
{
	return "fake";
}

static int open_chip(const char *path, struct gpio_chip **chip)
{
	if (fake_gpio.open_err)
		return fake_gpio.open_err;
	if (strcmp(path, "/dev/gpiochip0") != 0)
		return -ENOENT;
	fake_gpio.open++;
	*chip = &the_chip;
	return 0;
}

static void close_chip(struct gpio_chip *chip)
{
	TEST_ASSERT_EQUAL_PTR(&the_chip, chip);
	TEST_ASSERT_GREATER_THAN_UINT(0, fake_gpio.open);
	fake_gpio.open--;
}

static const char *label(struct gpio_chip *chip)
{
	(void)chip;
	return "fake";
}

static unsigned lines(struct gpio_chip *chip)
{
	(void)chip;
	return FAKE_LINES;
}

static int info(struct gpio_chip *chip, unsigned offset, struct gpio_info *info)
{
	const struct fake_line *line = &fake_gpio.line[offset];

	(void)chip;
	if (fake_gpio.gone)
		return -ENODEV;
	memcpy(info->name, line->name, sizeof(info->name));
	memcpy(info->consumer, line->consumer, sizeof(info->consumer));
	return 0;
}

static void drive(struct fake_line *line, bool value)
{
	line->high = value != line->setup.active_low;
	if (fake_gpio.driven)
		fake_gpio.driven((unsigned)(line - fake_gpio.line), line->high);
}

static int request(struct gpio_chip *chip, unsigned offset, const struct gpio_setup *setup,
                   const char *consumer, struct gpio_line **out)
{
	struct fake_line *line = &fake_gpio.line[offset];

	(void)chip;
	if (fake_gpio.gone)
		return -ENODEV;
	if (line->consumer[0])
		return -EBUSY;
	snprintf(line->consumer, sizeof(line->consumer), "%s", consumer);
	line->setup = *setup;
	line->held = true;
	line->requests++;
	line->edges = 0;
	handles[offset].line = line;
	*out = &handles[offset];
	if (setup->direction == GPIO_OUTPUT)
		drive(line, setup->value);
	return 0;
}

static int set(struct gpio_line *handle, bool value)
{
	TEST_ASSERT_EQUAL_UINT8(GPIO_OUTPUT, handle->line->setup.direction);
	if (fake_gpio.gone)
		return -ENODEV;
	handle->line->sets++;
	drive(handle->line, value);
	return 0;
}

static int get(struct gpio_line *handle)
{
	return fake_gpio.gone ? -ENODEV : handle->line->high != handle->line->setup.active_low;
}

static int edge(struct gpio_line *handle, struct gpio_edge *edge)
{
	struct fake_line *line = handle->line;

	TEST_ASSERT_EQUAL_UINT8(GPIO_INPUT, line->setup.direction);
	if (fake_gpio.gone)
		return -ENODEV;
	if (!line->edges)
		return 0;
	*edge = line->kept[0];
	memmove(line->kept, line->kept + 1, --line->edges * sizeof(line->kept[0]));
	return 1;
}

static void release(struct gpio_line *handle)
{
	TEST_ASSERT_TRUE(handle->line->held);
	handle->line->held = false;
	handle->line->consumer[0] = '\0';
}

static const struct gpio_api api = {
	.version = version,
	.open = open_chip,
	.close = close_chip,
	.label = label,
	.lines = lines,
	.info = info,
	.request = request,
	.set = set,
	.get = get,
	.edge = edge,
	.release = release,
};

void fake_gpio_begin(void)
{
	memset(&fake_gpio, 0, sizeof(fake_gpio));
	gpio_substitute = &api;
}

void fake_gpio_end(void)
{
	gpio_substitute = NULL;
	TEST_ASSERT_EQUAL_UINT_MESSAGE(0, fake_gpio.open, "a chip was left open");
	for (unsigned i = 0; i < FAKE_LINES; i++)
		TEST_ASSERT_FALSE_MESSAGE(fake_gpio.line[i].held, "a line was not given back");
}

void fake_gpio_level(unsigned number, bool high, int64_t at_ns)
{
	struct fake_line *line = &fake_gpio.line[number];

	if (line->high == high)
		return;
	line->high = high;
	if (line->held && line->setup.direction == GPIO_INPUT && line->edges < GPIO_EDGES_KEPT)
		line->kept[line->edges++] = (struct gpio_edge){
			.at_ns = at_ns, .value = high != line->setup.active_low};
}
