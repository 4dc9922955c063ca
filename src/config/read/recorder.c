/* SPDX-License-Identifier: MIT */
/* The Recorder block and the key Record: what is kept of a signal's history, and for how long. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "src/config/read/build.h"
#include "src/config/read/options.h"
#include "src/config/read/recorder.h"
#include "src/ground/signal/value.h"

#define BLANK " \t"
#define DAY 86400.0
#define EXPECTED "expected change, deadband NUMBER, interval SECONDS, raw, or off alone"

/* A word of a part, NUL-terminated; "" if there is none, or if it is too long to be one. */
static const char *take_word(const char *text, char *word, size_t size)
{
	size_t len;

	text += strspn(text, BLANK);
	len = strcspn(text, BLANK);
	snprintf(word, size, "%.*s", len < size ? (int)len : 0, text);
	return text + len;
}

static bool parse_positive(const char *text, double most, double *number)
{
	int64_t value;

	if (value_parse(OWS_DOUBLE, text, &value))
		return false;
	*number = value_number(OWS_DOUBLE, value);
	return *number > 0 && *number <= most;
}

static int recorder_refuse(char *why, size_t size, const char *reason)
{
	snprintf(why, size, "%s", reason);
	return -EINVAL;
}

/* A part with a number; *given: it stands there already. */
static int take_number(const char *word, const char *number, bool given, double most, double *to,
                       char *why, size_t size)
{
	if (given) {
		snprintf(why, size, "%s is given twice", word);
		return -EINVAL;
	}
	if (parse_positive(number, most, to))
		return 0;
	if (most > 1e300)
		snprintf(why, size, "expected a number above 0 after %s", word);
	else
		snprintf(why, size, "expected seconds above 0 and up to %.0f after %s", most, word);
	return -EINVAL;
}

static int take_flag(const char *word, const char *rest, bool *flag, char *why, size_t size)
{
	if (*rest || *flag) {
		snprintf(why, size, *rest ? "%s takes no number" : "%s is given twice", word);
		return -EINVAL;
	}
	*flag = true;
	return 0;
}

static int take_part(const char *part, struct config_record *record, char *why, size_t size)
{
	char word[16], number[40];
	double seconds = 0;
	int err;

	part = take_word(part, word, sizeof(word));
	part = take_word(part, number, sizeof(number));
	if (part[strspn(part, BLANK)])
		return recorder_refuse(why, size, EXPECTED);
	if (!strcmp(word, "off"))
		return take_flag(word, number, &record->off, why, size);
	if (!strcmp(word, "change"))
		return take_flag(word, number, &record->change, why, size);
	if (!strcmp(word, "raw"))
		return take_flag(word, number, &record->raw, why, size);
	if (!strcmp(word, "deadband"))
		return take_number(word, number, record->deadband > 0, HUGE_VAL, &record->deadband,
		                   why, size);
	if (strcmp(word, "interval") != 0)
		return recorder_refuse(why, size, EXPECTED);
	err = take_number(word, number, record->interval_ns > 0, DAY, &seconds, why, size);
	record->interval_ns = (int64_t)(seconds * 1e9 + 0.5);
	return err;
}

int record_parse(const char *text, struct config_record *record, char *why, size_t size)
{
	char part[RECORD_TEXT_MAX + 1];
	bool occasion;

	*record = (struct config_record){0};
	if (strlen(text) > RECORD_TEXT_MAX)
		return recorder_refuse(why, size, EXPECTED);
	for (;;) {
		size_t len = strcspn(text, ",");

		snprintf(part, sizeof(part), "%.*s", (int)len, text);
		if (take_part(part, record, why, size))
			return -EINVAL;
		if (!text[len])
			break;
		text += len + 1;
	}
	occasion = record->change || record->deadband > 0 || record->interval_ns > 0;
	if (record->off && (occasion || record->raw))
		return recorder_refuse(why, size, "off stands alone");
	if (record->change && record->deadband > 0)
		return recorder_refuse(why, size, "change and deadband exclude each other");
	if (!record->off && !occasion)
		record->change = true; /* "raw" alone */
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

void recorder_derive(struct build *build, const struct rio_node *block,
                     const struct option_value *values)
{
	struct config_recorder *recorder = &build->box->config.recorder;

	(void)block;
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
