/* SPDX-License-Identifier: MIT */
/*
 * GPIO lines, one small interface over libgpiod 1.6 (Debian 12) and 2.x (Debian 13, Raspberry Pi
 * OS). Calls do not block, but for what the chip's driver takes (a chip behind I2C: milliseconds).
 * Errors are negative errno. One thread at a time for each chip and its lines.
 */
#ifndef HAL_GPIO_LINE_H
#define HAL_GPIO_LINE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define GPIO_NAME_MAX 64 /* of a line, a consumer, a chip; with NUL */

enum gpio_direction {
	GPIO_AS_IT_IS, /* only look: nothing is changed */
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
	char consumer[GPIO_NAME_MAX]; /* who has it; "" unknown or nobody */
	bool used;
	bool output;
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
	/* -EBUSY somebody has it. consumer is what others see of us. */
	int (*request)(struct gpio_chip *chip, unsigned offset, const struct gpio_setup *setup,
	               const char *consumer, struct gpio_line **line);
	int (*set)(struct gpio_line *line, bool value);
	int (*get)(struct gpio_line *line); /* 0, 1; -ENODEV the chip is gone */
	int (*edge)(struct gpio_line *line, struct gpio_edge *edge); /* 1 one, 0 none is kept */
	int (*fd)(struct gpio_line *line); /* readable while an edge is kept */
	/* An output's level afterwards is the driver's affair. */
	void (*release)(struct gpio_line *line);
};

/* Edges that the kernel keeps for a line until they are taken. */
#define GPIO_EDGES_KEPT 16

/* The library of this build; NULL: none (LIBGPIOD=0). */
extern const struct gpio_api *const gpio_library;
/* What a test puts in its place, before any thread starts. */
extern const struct gpio_api *gpio_substitute;

static inline const struct gpio_api *gpio_api(void)
{
	return gpio_substitute ? gpio_substitute : gpio_library;
}

/*
 * Open a chip by name (gpiochip0), path (/dev/gpiochip0) or label (pinctrl-bcm2711). why gets what
 * to do about an error: -EOPNOTSUPP built without libgpiod, -ENODEV no such chip, -EACCES, -ENOTTY.
 */
int gpio_open(const char *name, struct gpio_chip **chip, char *why, size_t why_size);
void gpio_close(struct gpio_chip *chip);
/* The line's offset by its number or its name; -ENOENT. */
int gpio_offset(struct gpio_chip *chip, const char *text, size_t len);
/* Request a line; why tells of -EBUSY who has it. */
int gpio_request(struct gpio_chip *chip, unsigned offset, const struct gpio_setup *setup,
                 struct gpio_line **line, char *why, size_t why_size);

/*
 * One line with its chip, as options name it: CHIP/LINE, and behind it, each after a comma,
 * active-low, pull-up, pull-down, open-drain, open-source: "gpiochip0/22,active-low".
 */
struct gpio_spec {
	char chip[GPIO_NAME_MAX];
	char line[GPIO_NAME_MAX];
	struct gpio_setup setup;
};
/* 0, -EINVAL and why; -EOPNOTSUPP built without libgpiod. Touches nothing. */
int gpio_spec_parse(const char *text, struct gpio_spec *spec, char *why, size_t why_size);

/* An output and its chip. */
struct gpio_output {
	struct gpio_spec spec;
	struct gpio_chip *chip; /* NULL: not taken */
	struct gpio_line *line;
};
/* Take it with that value, if it is not taken yet. Errors as gpio_open() and gpio_request(). */
int gpio_output_take(struct gpio_output *output, bool value, char *why, size_t why_size);
int gpio_output_set(struct gpio_output *output, bool value);
void gpio_output_release(struct gpio_output *output);

#endif
