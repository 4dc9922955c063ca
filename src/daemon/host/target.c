/* SPDX-License-Identifier: MIT */
/* Checks targets and their options, and gives a bus the options of its Bus block. */
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>

#include "hal/bus/backends.h"
#include "hal/bus/bus.h"
#include "hal/gpio/line.h"
#include "src/config/check/check.h"
#include "src/config/read/buses.h"
#include "src/config/read/report.h"
#include "src/daemon/host/target.h"
#include "src/public/ows.h"

static int64_t target_now(void *ctx)
{
	(void)ctx;
	return ows_now();
}

static int no_wait(void *ctx, int fd, short events, int64_t until_ns)
{
	(void)ctx, (void)fd, (void)events, (void)until_ns;
	return -ECANCELED;
}

static void no_answer(void *ctx, const struct bus_answer *answer)
{
	(void)ctx, (void)answer;
}

static void no_event(void *ctx, const struct bus_event *event)
{
	(void)ctx, (void)event;
}

static const struct bus_env env = {
	.now = target_now, .wait = no_wait, .answer = no_answer, .event = no_event};

static struct place place_of(const struct config *config, const struct config_target *target)
{
	return (struct place){target->line ? config->file : NULL, target->line, target->column};
}

/* Make a bus of the target to see whether that works; reports why it does not. */
static int try_target(const char *target, struct place place, struct bus **bus,
                      struct config_report *report)
{
	char why[256] = "";
	int err = bus_create(target, &env, bus, why, sizeof(why));

	if (err)
		report_error(report, place, "target \"%s\": %s", target,
		             *why ? why : strerror(-err));
	return err;
}

int target_options(struct bus *bus, const struct config *config, const char *target, char *why,
                   size_t why_size)
{
	const struct config_bus *block = config_bus(config, target);

	for (unsigned i = 0; block && i < block->option_count; i++) {
		const struct config_option *option = &block->options[i];
		char reason[160];
		int err = bus_option(bus, option->key, option->text, reason, sizeof(reason));

		if (err) {
			snprintf(why, why_size, "%s: %s", option->key, reason);
			return err;
		}
	}
	return 0;
}

static int check_bus(const struct config *config, const struct config_bus *block,
                     struct config_report *report)
{
	struct bus *bus;
	char why[160];
	int worst = 0;
	int err = try_target(block->target,
	                     (struct place){config->file, block->line, block->column}, &bus,
	                     report);

	if (err)
		return err;
	for (unsigned i = 0; i < block->option_count; i++) {
		const struct config_option *option = &block->options[i];

		err = bus_option(bus, option->key, option->text, why, sizeof(why));
		if (err)
			report_error(report,
			             (struct place){config->file, option->line, option->column},
			             "%s: %s", option->key, why);
		worst = err ? err : worst;
	}
	bus_destroy(bus);
	return worst;
}

static struct place place_in(const struct config *config, struct config_spot spot)
{
	return (struct place){config->file, spot.line, spot.column};
}

static int check_line(struct place place, const char *key, const char *text,
                      struct config_report *report)
{
	struct gpio_spec spec;
	char why[160];
	int err = text ? gpio_spec_parse(text, &spec, why, sizeof(why)) : 0;

	if (err)
		report_error(report, place, "%s: %s", key, why);
	return err;
}

static int check_options(const struct config *config, struct config_report *report)
{
	struct place alarm = place_in(config, config->alarm_line_at);
	struct place heartbeat = place_in(config, config->heartbeat_line_at);
	int err = check_line(alarm, "AlarmLine", config->alarm_line, report);
	int other = check_line(heartbeat, "HeartbeatLine", config->heartbeat_line, report);

	err = err ? err : other;
	if (!err && config->alarm_line && config->heartbeat_line &&
	    strcmp(config->alarm_line, config->heartbeat_line) == 0) {
		report_error(report, heartbeat, "AlarmLine and HeartbeatLine are the same line");
		err = -EINVAL;
	}
	for (unsigned i = 0; i < config->bus_count; i++) {
		other = check_bus(config, &config->buses[i], report);
		err = err ? err : other;
	}
	return err;
}

int target_check_config(struct config *config, struct config_report *report)
{
	struct bus *bus;
	int err = 0;

	for (unsigned i = 0; !err && i < config->target_count; i++) {
		const struct config_target *target = &config->targets[i];

		err = try_target(target->text, place_of(config, target), &bus, report);
		if (!err)
			bus_destroy(bus);
	}
	if (!err)
		err = check_options(config, report);
	return err ? err : config_check(config, report);
}

#define I2C_MAJOR 89 /* Linux Documentation/admin-guide/devices.txt */

static bool is_adapter(const struct stat *file)
{
	return S_ISCHR(file->st_mode) && major(file->st_rdev) == I2C_MAJOR;
}

static bool is_socket(const struct stat *file)
{
	return S_ISSOCK(file->st_mode);
}

/* How a target names what it is on: the path is root and the text after the scheme. */
static const struct way {
	const char *scheme, *begin, *root, *remedy;
	bool (*fits)(const struct stat *file);
	const char *what; /* that does not fit */
} ways[] = {
	{"i2c:", "/", "", "ls /dev/i2c-* lists the adapters, owsd --board names what is missing",
         is_adapter, "no I2C adapter: ls /dev/i2c-* lists them"},
	{"w1:", "w1_bus_master", "/sys/bus/w1/devices/", "ls /sys/bus/w1/devices lists the masters",
         NULL, NULL},
	{"w1:netlink/", "w1_bus_master", "/sys/bus/w1/devices/",
         "ls /sys/bus/w1/devices lists the masters", NULL, NULL},
	{"owserver:", "/", "", "the other owsd makes the socket when it runs", is_socket,
         "no socket"},
};

static void look_for_path(const struct config_target *target, struct place place,
                          const struct way *way, struct config_report *report)
{
	const char *where = target->text + strlen(way->scheme);
	char path[300];
	struct stat file;

	if (strncmp(target->text, way->scheme, strlen(way->scheme)) != 0 ||
	    strncmp(where, way->begin, strlen(way->begin)) != 0)
		return;
	snprintf(path, sizeof(path), "%s%.*s", way->root, (int)strcspn(where, ":"), where);
	if (stat(path, &file) == 0) {
		if (way->fits && !way->fits(&file))
			report_error(report, place, "target \"%s\": %s is %s", target->text, path,
			             way->what);
	} else if (errno == ENOENT) {
		report_warning(report, place, "target \"%s\": %s is not on this machine: %s",
		               target->text, path, way->remedy);
	}
}

/* A chip has a label too, which only the chips themselves know. what: what names it. */
static void look_for_chip(const char *what, const char *name, struct place place,
                          struct config_report *report)
{
	struct gpio_chip *chip;
	char why[160];
	int err = gpio_open(name, &chip, why, sizeof(why));

	gpio_close(chip);
	if (err == -ENOTTY)
		report_error(report, place, "%s: %s", what, why);
	else if (err == -ENODEV)
		report_warning(report, place,
		               "%s: %s is not on this machine: gpiodetect lists the chips", what,
		               name);
}

static void look_for_line(struct place place, const char *key, const char *text,
                          struct config_report *report)
{
	struct gpio_spec spec;
	char why[160];

	if (text && gpio_spec_parse(text, &spec, why, sizeof(why)) == 0)
		look_for_chip(key, spec.chip, place, report);
}

int target_look(const struct config *config, struct config_report *report)
{
	static const char gpio[] = "gpio:";
	unsigned errors = report->errors;

	for (unsigned i = 0; i < config->target_count; i++) {
		const struct config_target *target = &config->targets[i];
		struct place place = place_of(config, target);
		char what[300];

		snprintf(what, sizeof(what), "target \"%s\"", target->text);
		if (strncmp(target->text, gpio, strlen(gpio)) == 0)
			look_for_chip(what, target->text + strlen(gpio), place, report);
		for (unsigned k = 0; k < sizeof(ways) / sizeof(ways[0]); k++)
			look_for_path(target, place, &ways[k], report);
	}
	look_for_line(place_in(config, config->alarm_line_at), "AlarmLine", config->alarm_line,
	              report);
	look_for_line(place_in(config, config->heartbeat_line_at), "HeartbeatLine",
	              config->heartbeat_line, report);
	return report->errors == errors ? 0 : -EINVAL;
}
