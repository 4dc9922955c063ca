/* SPDX-License-Identifier: MIT */
/* The Recorder block and the key Record: what is kept of a signal's history, and for how long. */
#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "src/config/read/options.h"
#include "src/config/read/recorder.h"
#include "src/ground/signal/value.h"

#define DAY 86400.0
#define EXPECTED "expected change, deadband NUMBER, interval SECONDS, raw, or off alone"

/* The words of a Record, and the most of the number that follows one; 0: none does. */
enum { WORD_OFF, WORD_CHANGE, WORD_RAW, WORD_DEADBAND, WORD_INTERVAL, WORDS };
static const struct {
	const char *text;
	double most;
} words[WORDS] = {
	[WORD_OFF] = {"off", 0},
	[WORD_CHANGE] = {"change", 0},
	[WORD_RAW] = {"raw", 0},
	[WORD_DEADBAND] = {"deadband", HUGE_VAL},
	[WORD_INTERVAL] = {"interval", DAY},
};

static int __attribute__((format(printf, 3, 4)))
refuse(char *why, size_t size, const char *format, ...)
{
	va_list args;

	va_start(args, format);
	vsnprintf(why, size, format, args);
	va_end(args);
	return -EINVAL;
}

/* The number of a word; 0: the text is none, or too large. */
static double parse_positive(const char *text, double most)
{
	int64_t value;
	double number;

	if (value_parse(OWS_DOUBLE, text, &value))
		return 0;
	number = value_number(OWS_DOUBLE, value);
	return number > 0 && number <= most ? number : 0;
}

/* A part, as "deadband 0.1": the number of its word, 1 without a number, goes into given. */
static int take_part(const char *part, double given[WORDS], char *why, size_t size)
{
	char word[16] = "", number[40] = "", more[2] = "";
	int i = 0;

	sscanf(part, "%15s %39s %1s", word, number, more);
	while (i < WORDS && strcmp(word, words[i].text) != 0)
		i++;
	if (i == WORDS || *more)
		return refuse(why, size, EXPECTED);
	if (!words[i].most && *number)
		return refuse(why, size, "%s takes no number", word);
	if (given[i] > 0)
		return refuse(why, size, "%s is given twice", word);
	given[i] = words[i].most > 0 ? parse_positive(number, words[i].most) : 1;
	if (given[i] > 0)
		return 0;
	if (i == WORD_DEADBAND)
		return refuse(why, size, "expected a number above 0 after %s", word);
	return refuse(why, size, "expected seconds above 0 and up to %.0f after %s", DAY, word);
}

int record_parse(const char *text, struct config_record *record, char *why, size_t size)
{
	char part[RECORD_TEXT_MAX + 1];
	double given[WORDS] = {0};

	*record = (struct config_record){0};
	if (strlen(text) > RECORD_TEXT_MAX)
		return refuse(why, size, EXPECTED);
	for (size_t len; text; text = text[len] ? text + len + 1 : NULL) {
		len = strcspn(text, ",");
		snprintf(part, sizeof(part), "%.*s", (int)len, text);
		if (take_part(part, given, why, size))
			return -EINVAL;
	}
	if (given[WORD_OFF] > 0 && given[WORD_OFF] + given[WORD_CHANGE] + given[WORD_RAW] +
	                                           given[WORD_DEADBAND] + given[WORD_INTERVAL] >
	                                   1)
		return refuse(why, size, "off stands alone");
	if (given[WORD_CHANGE] > 0 && given[WORD_DEADBAND] > 0)
		return refuse(why, size, "change and deadband exclude each other");
	*record = (struct config_record){
		.off = given[WORD_OFF] > 0,
		.raw = given[WORD_RAW] > 0,
		.deadband = given[WORD_DEADBAND],
		.interval_ns = (int64_t)(given[WORD_INTERVAL] * 1e9 + 0.5),
	};
	/* "raw" alone is of each change */
	record->change = given[WORD_CHANGE] > 0 ||
	                 !(record->off || record->deadband > 0 || record->interval_ns > 0);
	return 0;
}

/* Parse and report; false: it cannot be used. */
static bool take_record(struct build *build, const struct option_value *value,
                        struct config_record *record)
{
	char why[128] = "";

	if (!record_parse(value->text, record, why, sizeof(why)))
		return true;
	report_error(build->report, value->node->value_at, "Record \"%s\": %s", value->text, why);
	return false;
}

void recorder_derive(struct build *build, const struct option_value *values)
{
	struct config_recorder *recorder = &build->box->config.recorder;

	recorder->record.change = true;
	if (values[OPT_RECORDER_RECORD].given)
		take_record(build, &values[OPT_RECORDER_RECORD], &recorder->record);
}

static bool has_distance(const struct config_item *item)
{
	return item->type != OWS_STRING && item->type != OWS_BOOL;
}

void record_build(struct build *build, const struct option_value *value, bool known,
                  struct config_item *item)
{
	if (!value->given || !take_record(build, value, &item->record))
		return;
	if (known && item->record.deadband > 0 && !has_distance(item))
		report_error(build->report, value->node->value_at,
		             "Record \"%s\": a %s has no deadband; write change", value->text,
		             value_type_name(item->type));
}

struct config_record config_record_of(const struct config *config, const struct config_item *item)
{
	struct config_record record = config->recorder.record;

	if (item->record_text)
		return item->record;
	if (record.deadband > 0 && !has_distance(item)) {
		record.deadband = 0;
		record.change = true;
	}
	return record;
}
