/* SPDX-License-Identifier: MIT */
/* Inside the bus "gpio": the chip's lines, and the state that the bus keeps for each. */
#pragma once

#include "hal/bus/bus.h"
#include "hal/gpio/line.h"

#define GPIO_DEVICE "gpio" /* of /gpio/17 */

enum gpio_count {
	GPIO_EDGES,        /* edges that came */
	GPIO_PULSES,       /* pulses shorter than the time between two reads, and shown */
	GPIO_EDGES_UNSEEN, /* edges between two reads that no reading showed */
	GPIO_REFUSED,      /* requests of lines that the kernel refused */
	GPIO_OPENS,        /* times the chip was opened */
	GPIO_COUNTS,
};

struct line_state {
	struct gpio_line *held;  /* NULL: not requested */
	struct gpio_setup setup; /* as requested, or to be */
	bool told;               /* the reason why the line cannot be used was reported */
	char name[GPIO_NAME_MAX];
	/* Of an input: what was answered last, and when the level after that began; 0: unknown. */
	bool shown;
	int64_t since_ns;
};

struct gpio_bus {
	struct bus bus; /* first */
	char where[GPIO_NAME_MAX];
	char *option[GPIO_OPTIONS]; /* lists of lines, as written; NULL: none */
	struct gpio_chip *chip;     /* NULL: down */
	unsigned lines;
	struct line_state *line;
	bool suspended;
	struct bus_loss loss;
	int64_t next_ns;
	struct bus_counter count[GPIO_COUNTS];
};

/* bus_ops.option */
int lines_option(struct bus *bus, const char *key, const char *text, char *why, size_t why_size);
/* The lines of the chip that was opened, as the options have them. 0; -EINVAL and why; -ENOMEM. */
int lines_create(struct gpio_bus *gpio, char *why, size_t why_size);
void lines_release(struct gpio_bus *gpio);
/* By number or name; -ENOENT. */
int lines_find(const struct gpio_bus *gpio, const char *text);

/*
 * A guest changes nothing: its read keeps no line and takes no edge, and its write is for lines
 * that are outputs already. Errors as struct bus_answer; -ENODEV: the chip is gone. why gets a
 * message for the log, once for each line, else stays "".
 */
int line_read(struct gpio_bus *gpio, unsigned line, bool guest, bool *value, int64_t *measured_ns,
              char *why, size_t why_size);
int line_write(struct gpio_bus *gpio, unsigned line, bool guest, bool value, char *why,
               size_t why_size);
