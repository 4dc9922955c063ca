/* SPDX-License-Identifier: MIT */
/* Targets as they are written: lists with commas and bars, and auto. */
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "src/config/read/build.h"
#include "src/config/read/targets.h"

/* Is there such a file? What follows it in a simulated target, as :0x18, is no part of its name. */
static bool exists(const char *name)
{
	const char *chip = strstr(name, ":0x");
	char file[PATH_MAX];
	int n = snprintf(file, sizeof(file), "%.*s", chip ? (int)(chip - name) : INT_MAX, name);

	return n >= 0 && (size_t)n < sizeof(file) && access(file, F_OK) == 0;
}

/* The folder of a file: is it the working directory? Then a name stays as it is written. */
static bool is_here(const char *file, const char *slash)
{
	char folder[PATH_MAX];
	struct stat here, there;

	snprintf(folder, sizeof(folder), "%.*s", (int)(slash + 1 - file), file);
	return stat(folder, &there) == 0 && stat(".", &here) == 0 && here.st_dev == there.st_dev &&
	       here.st_ino == there.st_ino;
}

const char *relative_file(struct build *build, const char *text, size_t prefix,
                          const struct rio_position *position)
{
	const char *file = build->box->config.file, *name = text + prefix;
	const char *slash = strrchr(file, '/');
	char whole[PATH_MAX];
	int n;

	if (*name == '/' || !*name || !slash || is_here(file, slash))
		return build_keep(build, text, strlen(text));
	n = snprintf(whole, sizeof(whole), "%.*s%.*s%s", (int)prefix, text, (int)(slash + 1 - file),
	             file, name);
	if (n < 0 || (size_t)n >= sizeof(whole) || (!exists(whole + prefix) && exists(name))) {
		if (position)
			report_warning(build->report, *position,
			               "%s is taken from the working directory; a relative path "
			               "counts from the folder of this file, %.*s",
			               name, (int)(slash + 1 - file), file);
		return build_keep(build, text, strlen(text));
	}
	return build_keep(build, whole, (size_t)n);
}

#define DEFAULT_TARGET "localhost:4304"

#define AUTO "auto"

const char *config_auto_way(unsigned *row)
{
	static const char *const ways[] = {
#define BACKEND(name, automatic) automatic,
#include "hal/bus/schemes.h"
#undef BACKEND
	};

	while (*row < sizeof(ways) / sizeof(ways[0]))
		if (*ways[(*row)++])
			return ways[*row - 1];
	return NULL;
}

const char *target_of_file(struct build *build, const char *text, struct rio_position position)
{
	static const char *const schemes[] = {"sim:", "replay:"};

	/* on the command line the working directory counts */
	for (size_t i = 0; position.file && i < sizeof(schemes) / sizeof(schemes[0]); i++)
		if (strncmp(text, schemes[i], strlen(schemes[i])) == 0)
			return relative_file(build, text, strlen(schemes[i]),
			                     position.line ? &position : NULL);
	return text;
}

static void target_add(struct build *build, const char *text, size_t len,
                       enum config_relation relation, struct rio_position position)
{
	struct config *config = &build->box->config;
	struct config_target *target = &config->targets[config->target_count];

	if (!len) {
		report_error(build->report, position, "expected a target beside ',' or '|'");
		return;
	}
	if (len > TARGET_MAX) {
		report_error(build->report, position, "a target is longer than %d bytes",
		             TARGET_MAX);
		return;
	}
	if (config->target_count == CONFIG_TARGETS_MAX) {
		report_error(build->report, position,
		             "\"%.*s\" is one too many: owsd serves at most %d targets, ways "
		             "after a bar and those of auto counted",
		             (int)len, text, CONFIG_TARGETS_MAX);
		return;
	}
	target->text = target_of_file(build, build_keep(build, text, len), position);
	target->relation = config->target_count ? relation : CONFIG_FIRST;
	target->automatic = false;
	target->group = 0;
	if (strlen(target->text) > TARGET_MAX) {
		report_error(build->report, position, "a target is longer than %d bytes",
		             TARGET_MAX);
		return;
	}
	if (config->target_count)
		target->group = target[-1].group + (relation == CONFIG_COMMA);
	target->line = position.line;
	target->column = position.column;
	if (!strcmp(target->text, "owserver:"))
		report_warning(build->report, position, "owserver: names no host: %s is taken",
		               DEFAULT_TARGET);
	config->target_count++;
}

/* Add a target; auto becomes its ways, joined by bars, as --check shows. */
static void add_member(struct build *build, const char *text, size_t len,
                       enum config_relation relation, struct rio_position position)
{
	struct config *config = &build->box->config;
	unsigned errors = build->report->errors;
	const char *way;

	if (len != strlen(AUTO) || memcmp(text, AUTO, len) != 0) {
		target_add(build, text, len, relation, position);
		return;
	}
	for (unsigned row = 0; build->report->errors == errors && (way = config_auto_way(&row));) {
		target_add(build, way, strlen(way), relation, position);
		if (build->report->errors == errors)
			config->targets[config->target_count - 1].automatic = true;
		relation = CONFIG_BAR;
	}
}

void targets_add(struct build *build, const char *text, struct rio_position position)
{
	enum config_relation relation = CONFIG_COMMA;
	const char *rest = text, *part;
	size_t len;

	if (!text[strspn(text, " \t")]) {
		report_warning(build->report, position, "TargetName is empty: %s is taken",
		               DEFAULT_TARGET);
		rest = DEFAULT_TARGET;
	}
	while (build_part(&rest, ",|", &part, &len)) {
		add_member(build, part, len, relation, position);
		relation = rest && rest[-1] == '|' ? CONFIG_BAR : CONFIG_COMMA;
	}
}
