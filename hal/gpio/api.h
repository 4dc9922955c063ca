/* SPDX-License-Identifier: MIT */
/* The table of functions that each generation of libgpiod fills in. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#define GPIO_NAME_MAX 64 /* of a line, a consumer, a chip; with NUL */

enum gpio_direction {
	GPIO_AS_IT_IS, /* only read the line: nothing is changed */
	GPIO_INPUT,    /* both edges are kept for gpio_edge() */
	GPIO_OUTPUT,
};
enum gpio_bias { GPIO_BIAS_AS_IT_IS, GPIO_PULL_UP, GPIO_PULL_DOWN };
enum gpio_drive { GPIO_PUSH_PULL, GPIO_OPEN_DRAIN, GPIO_OPEN_SOURCE };

struct gpio_setup {
	uint8_t direction; /* enum gpio_direction */
	uint8_t bias;      /* enum gpio_bias */
	uint8_t drive;     /* enum gpio_drive */
	bool active_low;
	bool value; /* of an output from its first moment on */
};

struct gpio_edge {
	int64_t at_ns; /* when the kernel took the interrupt, CLOCK_BOOTTIME */
	bool value;    /* the level after it, active-low taken into account */
};

struct gpio_info {
	char name[GPIO_NAME_MAX];     /* "" when the board gave none */
	char consumer[GPIO_NAME_MAX]; /* the name of the line's holder; "": unknown or none */
};

struct gpio_chip;
struct gpio_line;

/* A generation of libgpiod, or what tests put in its place. */
struct gpio_api {
	const char *(*version)(void);
	/* path: "/dev/gpiochip0". -ENOENT, -EACCES, -ENOTTY no GPIO chip. */
	int (*open)(const char *path, struct gpio_chip **chip);
	void (*close)(struct gpio_chip *chip);
	const char *(*label)(struct gpio_chip *chip);
	unsigned (*lines)(struct gpio_chip *chip);
	int (*info)(struct gpio_chip *chip, unsigned offset, struct gpio_info *info);
	/*
	 * -EBUSY: another program has the line. consumer is the name that others see as the holder.
	 */
	int (*request)(struct gpio_chip *chip, unsigned offset, const struct gpio_setup *setup,
	               const char *consumer, struct gpio_line **line);
	int (*set)(struct gpio_line *line, bool value);
	int (*get)(struct gpio_line *line); /* 0, 1; -ENODEV the chip is gone */
	int (*edge)(struct gpio_line *line, struct gpio_edge *edge); /* 1 one, 0 none is kept */
	/* The chip's driver decides the level of an output afterwards. */
	void (*release)(struct gpio_line *line);
};

/* Edges that the kernel keeps for a line until they are taken. */
#define GPIO_EDGES_KEPT 16

/*
 * The error of open(), of a library that looks into /sys and reports -ENODEV or -ENOENT for a file
 * that is there and is no GPIO chip (libgpiod 2): -ENOTTY then, else err.
 */
int gpio_open_error(const char *path, int err);

/* A time of the kernel's, of CLOCK_MONOTONIC, which stands still in suspend, of CLOCK_BOOTTIME. */
int64_t gpio_boottime(int64_t monotonic_ns);

/* The library of this build; NULL: none (LIBGPIOD=0). */
extern const struct gpio_api *const gpio_library;
