/* SPDX-License-Identifier: MIT */
/* Which spellings of targets mean the same one, and what a configuration has of it twice. */
#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "src/config/check/targets.h"

#define DEFAULT_PORT "4304"

/* Schemes and bare words that are no host; the scheme of an owserver may be left out. */
static bool is_scheme(const char *text, size_t len)
{
	static const char *const schemes[] = {
#define BACKEND(name, automatic) #name,
#include "hal/bus/schemes.h"
#undef BACKEND
		"sim", "replay", NULL};

	for (int i = 0; schemes[i]; i++)
		if (strlen(schemes[i]) == len && !memcmp(schemes[i], text, len))
			return true;
	return false;
}

void target_canonical(const char *text, char out[TARGET_CANONICAL])
{
	static const char prefix[] = "owserver:";
	const char *colon, *host = text;

	colon = strchr(text, ':');
	if (!strncmp(text, prefix, strlen(prefix)))
		host += strlen(prefix);
	else if (is_scheme(text, colon ? (size_t)(colon - text) : strlen(text)) ||
	         (strchr(text, '/') && *text != '['))
		host = NULL;
	if (!host || *host == '/') {
		snprintf(out, TARGET_CANONICAL, "%s", text);
		return;
	}
	colon = strrchr(host, ':');
	if (*host == '[' && colon && strchr(colon, ']'))
		colon = NULL;
	snprintf(out, TARGET_CANONICAL, "%s%s%s", prefix, *host ? host : "localhost",
	         colon ? "" : ":" DEFAULT_PORT);
	for (char *p = out; *p; p++)
		*p = (char)tolower((unsigned char)*p);
}

bool target_same(const char *a, const char *b)
{
	char text_a[TARGET_CANONICAL], text_b[TARGET_CANONICAL];

	target_canonical(a, text_a);
	target_canonical(b, text_b);
	return !strcmp(text_a, text_b);
}

struct rio_position target_position(const struct config *config, const struct config_target *target)
{
	return (struct rio_position){target->line ? config->file : NULL, target->line,
	                             target->column};
}

const struct config_bus *config_bus(const struct config *config, const char *target)
{
	for (unsigned i = 0; i < config->bus_count; i++)
		if (target_same(config->buses[i].target, target))
			return &config->buses[i];
	return NULL;
}

/* Is the target configured? With auto always, since its ways are not known here. */
static bool is_served(const struct config *config, const char *target)
{
	for (unsigned i = 0; i < config->target_count; i++)
		if (target_same(config->targets[i].text, target) ||
		    !strncmp(config->targets[i].text, "auto", 4))
			return true;
	return false;
}

static void check_target(const struct config *config, unsigned n, struct config_report *report)
{
	const struct config_target *target = &config->targets[n];

	for (unsigned i = 0; i < n; i++)
		if (target_same(config->targets[i].text, target->text)) {
			report_error(report, target_position(config, target),
			             "the target \"%s\" is given twice; the first is \"%s\"",
			             target->text, config->targets[i].text);
			return;
		}
}

int config_check_targets(const struct config *config, struct config_report *report)
{
	unsigned before = report->errors;

	for (unsigned i = 0; i < config->target_count; i++)
		check_target(config, i, report);
	for (unsigned i = 0; i < config->bus_count; i++) {
		const struct config_bus *bus = &config->buses[i];
		struct rio_position position = {config->file, bus->line, bus->column};

		if (config_bus(config, bus->target) != bus)
			report_error(report, position, "there is a Bus for \"%s\" already",
			             bus->target);
		if (!is_served(config, bus->target))
			report_warning(report, position,
			               "no target is \"%s\": this Bus has no effect", bus->target);
	}
	return report->errors == before ? 0 : -EINVAL;
}
