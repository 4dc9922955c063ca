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
#include "src/config/check/targets.h"
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

/* Make a bus of the target to see whether that works; reports why it does not. */
static int try_target(const char *target, struct rio_position position, struct bus **bus,
                      struct config_report *report)
{
	char why[256] = "";
	int err = bus_create(target, &env, bus, why, sizeof(why));

	if (err)
		report_error(report, position, "target \"%s\": %s", target,
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
	                     (struct rio_position){config->file, block->line, block->column}, &bus,
	                     report);

	if (err)
		return err;
	for (unsigned i = 0; i < block->option_count; i++) {
		const struct config_option *option = &block->options[i];

		err = bus_option(bus, option->key, option->text, why, sizeof(why));
		if (err)
			report_error(
				report,
				(struct rio_position){config->file, option->line, option->column},
				"%s: %s", option->key, why);
		worst = err ? err : worst;
	}
	bus_destroy(bus);
	return worst;
}

static struct rio_position position_in(const struct config *config, struct config_spot spot)
{
	return (struct rio_position){config->file, spot.line, spot.column};
}

static int check_line(struct rio_position position, const char *key, const char *text,
                      struct config_report *report)
{
	struct gpio_spec spec;
	char why[160];
	int err = text ? gpio_spec_parse(text, &spec, why, sizeof(why)) : 0;

	if (err)
		report_error(report, position, "%s: %s", key, why);
	return err;
}

static int check_options(const struct config *config, struct config_report *report)
{
	struct rio_position alarm = position_in(config, config->alarm_line_at);
	struct rio_position heartbeat = position_in(config, config->heartbeat_line_at);
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

	if (report->errors) {
		config_check_items(config, NULL, report);
		return -EINVAL;
	}
	for (unsigned i = 0; !err && i < config->target_count; i++) {
		const struct config_target *target = &config->targets[i];

		err = try_target(target->text, target_position(config, target), &bus, report);
		if (!err)
			bus_destroy(bus);
	}
	if (!err)
		err = check_options(config, report);
	return err ? err : config_check(config, report);
}

/* A chip has a label too, which only the chips themselves know. what: what names it. */
static void look_for_chip(const char *what, const char *name, struct rio_position position,
                          struct config_report *report)
{
	struct gpio_chip *chip;
	char why[160];
	int err = gpio_open(name, &chip, why, sizeof(why));

	gpio_close(chip);
	if (err == -ENOTTY)
		report_error(report, position, "%s: %s", what, why);
	else if (err == -ENODEV)
		report_warning(report, position,
		               "%s: %s is not on this machine: gpiodetect lists the chips", what,
		               name);
}

static void look_for_line(struct rio_position position, const char *key, const char *text,
                          struct config_report *report)
{
	struct gpio_spec spec;
	char why[160];

	if (text && gpio_spec_parse(text, &spec, why, sizeof(why)) == 0)
		look_for_chip(key, spec.chip, position, report);
}

static void look_for_path(const struct config_target *target, const char *name,
                          struct rio_position position, const struct bus_look *look,
                          struct config_report *report)
{
	char path[300];
	struct stat file;

	snprintf(path, sizeof(path), "%s%.*s", look->root, (int)strcspn(name, ":"), name);
	if (stat(path, &file) == 0) {
		if ((look->type && (file.st_mode & S_IFMT) != look->type) ||
		    (look->major && major(file.st_rdev) != look->major))
			report_error(report, position, "target \"%s\": %s is %s", target->text,
			             path, look->wrong);
	} else if (errno == ENOENT) {
		report_warning(report, position, "target \"%s\": %s is not on this machine: %s",
		               target->text, path, look->remedy);
	}
}

static void look_for_target(const struct config_target *target, struct rio_position position,
                            struct config_report *report)
{
	const char *where;
	const struct bus_ops *ops = bus_backend(target->text, &where);
	const struct bus_look *look = ops ? ops->looks : NULL;
	char what[300];

	snprintf(what, sizeof(what), "target \"%s\"", target->text);
	for (; look && look->begin; look++) {
		size_t after = look->after ? strlen(look->after) : 0;

		if (look->gpio_chip)
			look_for_chip(what, where, position, report);
		else if ((!after || !strncmp(where, look->after, after)) &&
		         !strncmp(where + after, look->begin, strlen(look->begin)))
			look_for_path(target, where + after, position, look, report);
	}
}

int target_look(const struct config *config, struct config_report *report)
{
	unsigned errors = report->errors;

	for (unsigned i = 0; i < config->target_count; i++) {
		const struct config_target *target = &config->targets[i];

		look_for_target(target, target_position(config, target), report);
	}
	look_for_line(position_in(config, config->alarm_line_at), "AlarmLine", config->alarm_line,
	              report);
	look_for_line(position_in(config, config->heartbeat_line_at), "HeartbeatLine",
	              config->heartbeat_line, report);
	return report->errors == errors ? 0 : -EINVAL;
}
