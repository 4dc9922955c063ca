/* SPDX-License-Identifier: MIT */
/*
 * The bus "gpio": the lines of one GPIO chip. `gpio:gpiochip0`, `gpio:/dev/gpiochip0`,
 * `gpio:pinctrl-bcm2711`; paths /gpio/17 and /gpio/NAME. hal/gpio/lines.c has what a line does.
 *
 * The contract has no way to say that a path has news, so an edge waits in the kernel, with its
 * time, until its line is read: at the latest one period later.
 */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/time.h"
#include "hal/gpio/lines.h"

#define AGAIN_NS (NS_PER_S / 2)
#define LOOK_NS (5 * NS_PER_S)
#define DEPTH 64

static const char *const names[GPIO_COUNTS] = {
	[GPIO_EDGES] = "edges",
	[GPIO_PULSES] = "pulses",
	[GPIO_EDGES_UNSEEN] = "edges_unseen",
	[GPIO_REFUSED] = "lines_refused",
	[GPIO_OPENS] = "chip_opened",
};

static void gpio_destroy(struct bus *bus)
{
	struct gpio_bus *gpio = (struct gpio_bus *)bus;

	lines_release(gpio);
	gpio_close(gpio->chip);
	for (int i = 0; i < GPIO_OPTIONS; i++)
		free(gpio->option[i]);
	free(gpio->line);
	free(gpio);
}

static int gpio_create(const char *where, const struct bus_env *env, struct bus **bus, char *why,
                       size_t why_size)
{
	struct gpio_bus *gpio;

	if (!gpio_api()) {
		snprintf(why, why_size, "this owsd was built without libgpiod");
		return -EINVAL;
	}
	if (!*where || strlen(where) >= sizeof(gpio->where)) {
		snprintf(why, why_size, "expected a GPIO chip, as gpio:gpiochip0");
		return -EINVAL;
	}
	gpio = calloc(1, sizeof(*gpio));
	if (!gpio || bus_init(&gpio->bus, &gpio_bus, env)) {
		free(gpio);
		return -ENOMEM;
	}
	memcpy(gpio->where, where, strlen(where) + 1);
	for (int i = 0; i < GPIO_COUNTS; i++)
		gpio->count[i].name = names[i];
	*bus = &gpio->bus;
	return 0;
}

static void go_down_chip(struct gpio_bus *gpio, int err, const char *why)
{
	lines_release(gpio);
	gpio_close(gpio->chip);
	gpio->chip = NULL;
	gpio->next_ns = bus_now(gpio->bus.env) + AGAIN_NS;
	if (bus_loss_news(&gpio->loss, err == -ENODEV))
		bus_report(gpio->bus.env, BUS_DOWN, err, why);
}

static int bring_up(struct gpio_bus *gpio, char *why, size_t why_size)
{
	int err = gpio_open(gpio->where, &gpio->chip, why, why_size);

	if (err)
		return err;
	err = lines_create(gpio, why, why_size);
	if (!err)
		return 0;
	if (err == -ENOMEM)
		snprintf(why, why_size, "out of memory");
	gpio_close(gpio->chip);
	gpio->chip = NULL;
	return err;
}

/* Checks that the chip still exists, even when no signal is read. */
static int64_t gpio_step(struct bus *bus, int64_t now)
{
	struct gpio_bus *gpio = (struct gpio_bus *)bus;
	struct gpio_info info;
	char why[BUS_EVENT_TEXT] = "";
	int err;

	if (gpio->suspended)
		return INT64_MAX;
	if (now < gpio->next_ns)
		return gpio->next_ns;
	if (gpio->chip) {
		unsigned i = 0;

		/* a line that owsd holds needs no check */
		while (i + 1 < gpio->lines && gpio->line[i].held)
			i++;
		if (gpio_api()->info(gpio->chip, i, &info) == -ENODEV)
			go_down_chip(gpio, -ENODEV, "the chip is gone");
		else
			gpio->next_ns = now + LOOK_NS;
		return gpio->next_ns;
	}
	err = bring_up(gpio, why, sizeof(why));
	if (err) {
		go_down_chip(gpio, err, why);
		return gpio->next_ns;
	}
	gpio->loss = (struct bus_loss){0};
	gpio->next_ns = now + LOOK_NS;
	bus_count(&gpio->count[GPIO_OPENS], 1);
	bus_report(gpio->bus.env, BUS_UP, 0, "");
	return gpio->next_ns;
}

/* The line of a path: its number, -1 the chip itself, -2 the root, or an error. */
#define IS_CHIP (-1)
#define IS_ROOT (-2)
static int line_of(const struct gpio_bus *gpio, const char *path, int *line)
{
	const char *name = strrchr(gpio->where, '/');
	const char *own = name ? name + 1 : gpio->where;
	size_t len;

	*line = IS_ROOT;
	path += *path == '/';
	if (!*path)
		return 0;
	len = strcspn(path, "/");
	if (!(len == strlen(GPIO_DEVICE) && memcmp(path, GPIO_DEVICE, len) == 0) &&
	    !(len == strlen(own) && memcmp(path, own, len) == 0))
		return -ENODEV;
	*line = IS_CHIP;
	path += len + (path[len] == '/');
	if (!*path)
		return 0;
	if (strchr(path, '/'))
		return -ENOENT;
	*line = lines_find(gpio, path);
	return *line < 0 ? -ENOENT : 0;
}

static int gpio_list(const struct gpio_bus *gpio, int line, struct bus_req *req, uint32_t *used)
{
	if (line >= 0)
		return -ENOTDIR;
	for (unsigned i = 0; i < (line == IS_ROOT ? 1 : gpio->lines); i++) {
		char path[32];
		int n = line == IS_ROOT ? snprintf(path, sizeof(path), "/" GPIO_DEVICE "\n")
		                        : snprintf(path, sizeof(path), "/" GPIO_DEVICE "/%u\n", i);

		if (*used + (uint32_t)n > req->len)
			return -EMSGSIZE;
		memcpy(req->data + *used, path, (size_t)n);
		*used += (uint32_t)n;
	}
	return 0;
}

static int access_line(struct gpio_bus *gpio, int line, struct bus_req *req,
                       struct bus_answer *answer, char *why, size_t why_size)
{
	bool guest = req->prio == BUS_GUEST, value;
	int err;

	if (line < 0)
		return -EISDIR;
	if (req->op == BUS_READ) {
		if (req->len < 1)
			return -EMSGSIZE;
		err = line_read(gpio, (unsigned)line, guest, &value, &answer->measured_ns, why,
		                why_size);
		if (err)
			return err;
		req->data[0] = value ? '1' : '0';
		answer->len = 1;
		answer->kind = BUS_NUMBER;
		answer->number = value;
		return 0;
	}
	err = bus_write_switch(req, &value);
	if (!err)
		err = line_write(gpio, (unsigned)line, guest, value, why, why_size);
	if (!err)
		answer->len = bus_write_text(req);
	return err;
}

static void gpio_exec(struct bus *bus, struct bus_req *req, struct bus_answer *answer)
{
	struct gpio_bus *gpio = (struct gpio_bus *)bus;
	char why[100] = "";
	int line;

	answer->kind = BUS_TEXT;
	answer->measured_ns = bus_now(gpio->bus.env);
	if (!gpio->chip) {
		answer->err = -ENOTCONN;
		return;
	}
	if (req->op == BUS_DIR && strncmp(req->path, "/alarm", strlen("/alarm")) == 0) {
		answer->err = -EOPNOTSUPP;
		return;
	}
	answer->err = line_of(gpio, req->path, &line);
	if (answer->err || req->op == BUS_PROBE)
		return;
	if (req->op == BUS_DIR) {
		answer->err = gpio_list(gpio, line, req, &answer->len);
		return;
	}
	answer->err = access_line(gpio, line, req, answer, why, sizeof(why));
	if (answer->err == -ENODEV || answer->err == -ENXIO) {
		go_down_chip(gpio, -ENODEV, "the chip is gone");
		answer->err = -ECONNRESET;
	} else if (*why) {
		bus_report(gpio->bus.env, BUS_NOTE, answer->err, why);
	}
}

static void gpio_suspend(struct bus *bus, bool yes)
{
	struct gpio_bus *gpio = (struct gpio_bus *)bus;

	gpio->suspended = yes;
	gpio->loss = (struct bus_loss){0};
	gpio->next_ns = 0;
	if (!yes)
		return;
	lines_release(gpio);
	gpio_close(gpio->chip);
	gpio->chip = NULL;
}

static const struct bus_counter *gpio_counters(struct bus *bus, size_t *n)
{
	*n = GPIO_COUNTS;
	return ((struct gpio_bus *)bus)->count;
}

static const struct bus_look looks[] = {{.begin = "", .gpio_chip = true}, {0}};

const struct bus_ops gpio_bus = {
	.scheme = "gpio",
	.summary = "lines of a GPIO chip",
	.depth = DEPTH,
	.looks = looks,
	.create = gpio_create,
	.destroy = gpio_destroy,
	.option = lines_option,
	.exec = gpio_exec,
	.step = gpio_step,
	.suspend = gpio_suspend,
	.counters = gpio_counters,
};
