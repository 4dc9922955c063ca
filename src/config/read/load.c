/* SPDX-License-Identifier: MIT */
/*
 * The configuration made from a .rio document: its driver block, its items, its targets. A part is
 * built although another has an error, so that one check reports all errors. ControlAllow comes
 * last: its patterns are compared with the names of the items.
 */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "src/config/read/allow.h"
#include "src/config/read/build.h"
#include "src/config/read/buses.h"
#include "src/config/read/identity.h"
#include "src/config/read/item.h"
#include "src/config/read/load.h"
#include "src/config/read/modbus.h"
#include "src/config/read/mqtt.h"
#include "src/config/read/options.h"
#include "src/config/read/recorder.h"
#include "src/config/read/rio_file.h"
#include "src/config/read/serve.h"
#include "src/config/read/targets.h"
#include "src/config/read/web.h"
#include "src/ground/signal/value.h"

#define DRIVER "OwsDrv"

/* The one OwsDrv block of the file; NULL after reporting what the file has instead. */
static const struct rio_node *find_driver(const struct rio *rio, const char *file,
                                          struct config_report *report)
{
	const struct rio_node *driver = NULL;

	for (const struct rio_node *node = rio->root.first; node; node = node->next) {
		if (strcmp(node->key, DRIVER)) {
			if (node->kind == RIO_BLOCK && *node->key)
				report_error(report, node->at,
				             "expected " DRIVER " {, found the block %s: is it the "
				             "file of another driver?",
				             node->key);
			else if (*node->key)
				report_error(report, node->at, "expected " DRIVER " {, found %s",
				             node->key);
		} else if (node->kind != RIO_BLOCK) {
			if (!node->broken)
				report_error(report, node->value_at, "expected { after " DRIVER);
		} else if (driver) {
			report_error(report, node->at, DRIVER " is given twice, first in line %d",
			             driver->at.line);
		} else {
			driver = node;
		}
	}
	if (!driver && !report->errors)
		report_error(report, (struct rio_position){file, 1, 1}, "expected " DRIVER " {");
	return driver;
}

static void build_driver(struct build *build, const struct option_value *values)
{
	struct config *config = &build->box->config;
	const struct option_value *target = &values[OPT_TARGET_NAME];
	int64_t version;

	if (!config->max_cons_alarms) {
		report_warning(build->report, values[OPT_MAX_CONS_ALARMS].node->value_at,
		               "MaxConsAlarms 0 counts as 1");
		config->max_cons_alarms = 1;
	}
	if (values[OPT_MAX_REQUESTS].number > 1)
		report_warning(build->report, values[OPT_MAX_REQUESTS].node->value_at,
		               "MaxRequests %s counts as 1", values[OPT_MAX_REQUESTS].text);
	if (config->alarm_period_ns > config->timeout_ns) {
		if (values[OPT_ALARM_PERIOD].given)
			report_error(build->report, values[OPT_ALARM_PERIOD].node->value_at,
			             "AlarmPeriod \"%s\": expected no more than Timeout, which is "
			             "%g s",
			             values[OPT_ALARM_PERIOD].text, values[OPT_TIMEOUT].number);
		config->alarm_period_ns = config->timeout_ns;
	}
	if (values[OPT_VERSION].given &&
	    (value_parse(OWS_DOUBLE, values[OPT_VERSION].text, &version) ||
	     value_number(OWS_DOUBLE, version) != 1))
		report_warning(build->report, values[OPT_VERSION].node->value_at,
		               "Version %s: only 1.00 is known", values[OPT_VERSION].text);
	serve_build(build, values);
	if (target->given)
		targets_add(build, target->text, target->node->value_at);
	else if (!target->node)
		targets_add(build, option_table[OPT_TARGET_NAME].preset, (struct rio_position){0});
}

static void notify_derive(struct build *build, const struct option_value *values)
{
	const struct config_notify *notify = &build->box->config.notify;
	const struct option_value *mail = &values[OPT_NOTIFY_ESCALATE_MAIL];

	if (notify->given && !notify->mail && !notify->url && !notify->command)
		report_error(build->report,
		             (struct rio_position){build->box->config.file, notify->at.line,
		                                   notify->at.column},
		             "Notify tells nobody: write Mail, Url or Command");
	if (notify->escalate_mail && !notify->escalate_ns)
		report_error(build->report, mail->node->value_at,
		             "EscalateMail without EscalateAfter: write after how many seconds");
}

/* A block that stands once: the keys one by one, then what follows from several of them. */
static void build_block(struct build *build, const struct option_def *def,
                        const struct rio_node *block)
{
	static block_derive *const derive[PLACE_COUNT] = {
		[PLACE_RECORDER] = recorder_derive, [PLACE_WEB] = web_derive,
		[PLACE_MQTT] = mqtt_derive,         [PLACE_NOTIFY] = notify_derive,
		[PLACE_MODBUS] = modbus_derive,
	};
	struct option_value values[OPTION_COUNT_ALL];

	options_read(build, block, def->inside, values, (char *)&build->box->config + def->offset);
	if (derive[def->inside])
		derive[def->inside](build, values);
}

static struct rio_position name_position(const struct rio_node *block)
{
	const struct rio_node *name = rio_child(block, option_table[OPT_NAME].key);

	return name ? name->value_at : block->at;
}

static void build_items(struct build *build, const struct rio_node *driver,
                        const struct option_value *count)
{
	struct config *config = &build->box->config;
	unsigned items = options_blocks(driver, OPT_ITEM);
	struct rio_position *names;

	if (items > CONFIG_ITEMS_MAX) {
		report_error(build->report, driver->at, "more than %d items", CONFIG_ITEMS_MAX);
		return;
	}
	config->items = build_take(build, items, sizeof(*config->items));
	names = calloc(items + 1, sizeof(*names));
	if (!names || !config->items) {
		build->no_memory = true;
		free(names);
		return;
	}
	for (const struct rio_node *node = driver->first; node; node = node->next)
		if (option_is_block(node, OPT_ITEM)) {
			unsigned before = build->report->errors;
			struct config_item *item = &config->items[config->item_count];

			names[config->item_count++] = name_position(node);
			item_build(build, node, item);
			item->wrong = build->report->errors > before;
		}
	items_check(build, names);
	if (count->given && count->number != items)
		report_warning(build->report, count->node->value_at,
		               "ItemCount is %s, but there %s %u item%s", count->text,
		               items == 1 ? "is" : "are", items, items == 1 ? "" : "s");
	free(names);
}

static void build_config(struct build *build, const struct rio *rio, const char *file)
{
	struct option_value values[OPTION_COUNT_ALL];
	struct config *config = &build->box->config;
	const struct rio_node *driver;

	config->file = build_keep(build, file, strlen(file));
	config->targets = build_take(build, CONFIG_TARGETS_MAX, sizeof(*config->targets));
	driver = find_driver(rio, file, build->report);
	if (!driver || build->no_memory)
		return;
	options_read(build, driver, PLACE_DRIVER, values, config);
	build_driver(build, values);
	buses_build(build, driver);
	for (int i = 0; i < OPTION_COUNT_ALL; i++)
		if (option_table[i].inside)
			build_block(build, &option_table[i], values[i].node);
	build_items(build, driver, &values[OPT_ITEM_COUNT]);
	allow_build(build, driver);
}

static void leave_out_wrong_items(struct config *config)
{
	unsigned count = config->item_count;

	config->item_count = 0;
	for (unsigned i = 0; i < count; i++)
		if (!config->items[i].wrong)
			config->items[config->item_count++] = config->items[i];
}

int config_parse(const char *file, const char *text, size_t len, struct config_report *report,
                 struct config **config)
{
	struct build build = {.report = report};
	unsigned before = report->errors;
	struct rio *rio;
	int err;

	*config = NULL;
	err = rio_parse(file, text, len, report, &rio);
	if (err)
		return err == -ENOMEM ? err : -EINVAL;
	build.box = calloc(1, sizeof(*build.box));
	if (build.box)
		build_config(&build, rio, file);
	if (!build.box || build.no_memory)
		err = -ENOMEM;
	else if (report->errors > before)
		err = -EINVAL;
	rio_free(rio);
	if (err == -EINVAL && report->keeps_wrong && build.box->config.period_ns > 0)
		leave_out_wrong_items(*config = &build.box->config);
	else if (!err)
		*config = &build.box->config;
	else if (build.box)
		config_free(&build.box->config);
	return err;
}

int config_load(const char *file, struct config_report *report, struct config **config)
{
	char *text;
	size_t len;
	int err;

	*config = NULL;
	err = rio_read(file, report, &text, &len);
	if (err)
		return err == -EFBIG ? -EINVAL : err;
	err = config_parse(file, text, len, report, config);
	free(text);
	if (err == -ENOMEM)
		report_error(report, (struct rio_position){file, 0, 0}, "no memory");
	return err;
}

static struct config_box *box_of(struct config *config)
{
	return (struct config_box *)(void *)((char *)config - offsetof(struct config_box, config));
}

int config_set_targets(struct config *config, const char *const *texts, unsigned count,
                       struct config_report *report)
{
	struct build build = {.box = box_of(config), .report = report};
	struct config_target *old = config->targets;
	unsigned before = report->errors, old_count = config->target_count;

	config->target_count = 0;
	config->targets = build_take(&build, CONFIG_TARGETS_MAX, sizeof(*config->targets));
	for (unsigned i = 0; i < count && !build.no_memory; i++)
		targets_add(&build, texts[i], (struct rio_position){0});
	if (!build.no_memory && report->errors == before)
		return 0;
	config->targets = old;
	config->target_count = old_count;
	return build.no_memory ? -ENOMEM : -EINVAL;
}

int config_set_listens(struct config *config, const char *const *texts, unsigned count,
                       struct config_report *report)
{
	struct build build = {.box = box_of(config), .report = report};

	return serve_listens(&build, texts, count);
}

void config_free(struct config *config)
{
	struct config_box *box;

	if (!config)
		return;
	box = box_of(config);
	arena_free(&box->arena);
	free(box);
}
