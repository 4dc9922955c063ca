/* SPDX-License-Identifier: MIT */
/* Reads the Bus blocks. Only the form of a value is checked here; the backend knows its meaning. */
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "src/config/read/build.h"
#include "src/config/read/buses.h"
#include "src/config/read/options.h"
#include "src/config/read/targets.h"
#include "src/ground/signal/hash.h"

static void keep_option(struct build *build, struct config_bus *bus, enum option option,
                        const struct option_value *value)
{
	const char *text = value->text;

	if (option == OPT_BUS_SENSORS)
		text = relative_file(build, text, 0, &value->node->value_at);
	/* a backend knows these two words of all that mean them */
	if (option_table[option].kind == OPTION_FLAG)
		text = value->number ? "on" : "off";
	bus->options[bus->option_count++] = (struct config_option){
		.key = option_table[option].key,
		.text = build_keep(build, text, strlen(text)),
		.line = value->node->value_at.line,
		.column = value->node->value_at.column,
	};
}

static void bus_build(struct build *build, const struct rio_node *block)
{
	struct config *config = &build->box->config;
	struct config_bus *bus = &config->buses[config->bus_count];
	struct option_value values[OPTION_COUNT_ALL];
	const struct option_value *target = &values[OPT_BUS_TARGET];
	const char *text;

	options_read(build, block, PLACE_BUS, values, NULL);
	if (!target->given || !*target->text) {
		if (!block->broken && (!target->node || target->given))
			report_error(build->report, block->at, "expected a Target in this Bus");
		return;
	}
	text = target_of_file(build, target->text,
	                      (struct rio_position){.file = target->node->value_at.file});
	bus->target = build_keep(build, text, strlen(text));
	bus->line = target->node->value_at.line;
	bus->column = target->node->value_at.column;
	bus->options = build_take(build, OPTION_COUNT_ALL - OPT_BUS_TARGET, sizeof(*bus->options));
	for (int i = OPT_BUS_TARGET + 1; bus->options && i < OPTION_COUNT_ALL; i++)
		if (option_table[i].place == PLACE_BUS && values[i].given)
			keep_option(build, bus, (enum option)i, &values[i]);
	config->bus_count++;
}

void buses_build(struct build *build, const struct rio_node *driver)
{
	struct config *config = &build->box->config;
	unsigned count = options_blocks(driver, OPT_BUS);

	config->buses = build_take(build, count, sizeof(*config->buses));
	for (const struct rio_node *node = driver->first; node && config->buses; node = node->next)
		if (option_is_block(node, OPT_BUS))
			bus_build(build, node);
}

#define FILE_MAX 1000000

static uint64_t hash_of(const char *file)
{
	/* O_NONBLOCK: the name may lead to a pipe by now, which must not hold a reload */
	int fd = open(file, O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
	FILE *in = fd < 0 ? NULL : fdopen(fd, "r");
	uint64_t hash = HASH_BEGIN;

	for (int i = 0, c; in && i < FILE_MAX && (c = getc(in)) != EOF; i++)
		hash = hash_text(hash, &(char){(char)c}, 1);
	if (in)
		fclose(in);
	else if (fd >= 0)
		close(fd);
	return hash;
}

void config_hash_files(struct config *config)
{
	for (unsigned i = 0; i < config->bus_count; i++)
		for (unsigned k = 0; k < config->buses[i].option_count; k++) {
			struct config_option *option = &config->buses[i].options[k];

			if (strcmp(option->key, option_table[OPT_BUS_SENSORS].key) == 0)
				option->contents = hash_of(option->text);
		}
}
