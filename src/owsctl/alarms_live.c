/* SPDX-License-Identifier: MIT */
/* owsctl alarms: the alarms that stand. */
#include <errno.h>
#include <getopt.h>
#include <stdio.h>
#include <string.h>

#include "src/owsctl/alarms_live.h"
#include "src/owsctl/names.h"
#include "src/owsctl/rows.h"
#include "src/owsctl/table.h"
#include "src/owsctl/text.h"
#include "src/owsctl/who.h"
#include "src/signal/error.h"

/* One line of the live table. */
struct alarm {
	const char *name;
	const char *kind, *state;
	int64_t since_ns; /* 0: not known */
	uint32_t occurrences;
	bool device, polled;
	const struct ows_alarm_state *shelved; /* NULL: it is not shelved */
};

struct live {
	struct ows *h;
	struct when now;
	struct reading *reading;
	struct table *table; /* NULL: JSON */
	struct json json;
	bool ok;
};

static const struct table_column columns[] = {
	{"NAME"},
	{"ALARM"},
	{"STATE"},
	{"SINCE", .right = true},
	{"VALUE", .right = true, .most = 40},
	{"QUALITY"},
};
#define COLUMNS (sizeof(columns) / sizeof(columns[0]))

/* When the present alarm of a signal was raised, as far as the journal goes back; else 0. */
static int64_t raised(struct ows *h, int signal, uint8_t kind)
{
	struct ows_alarm alarm;
	int err;

	for (uint32_t number = ows_alarm_count(h); number-- > 0;) {
		err = ows_alarm(h, number, &alarm);
		if (err == -ENOENT)
			break;
		if (err || alarm.signal != signal || alarm.event != OWS_ALARM_RAISED)
			continue;
		if (alarm.kind == kind)
			return alarm.occurred_ns;
	}
	return 0;
}

static void add_row(struct live *live, const struct alarm *alarm)
{
	char value[128], words[READING_WORDS], span[WHEN_TEXT] = "-";

	reading_show(live->reading, value, sizeof(value));
	if (alarm->since_ns)
		when_span(live->now.boot - alarm->since_ns, span);
	if (!table_add(live->table,
	               (const char *const[]){alarm->name, alarm->kind, alarm->state, span, value,
	                                     reading_quality(live->reading, words)}))
		live->ok = false;
}

static void add_json(struct live *live, const struct alarm *alarm)
{
	struct json *json = &live->json;
	char text[WHEN_TEXT];

	json_object(json, NULL);
	json_string(json, "name", alarm->name);
	json_string(json, "alarm", alarm->kind);
	json_string(json, "state", alarm->state);
	json_bool(json, "device", alarm->device);
	json_bool(json, "polled", alarm->polled);
	json_string(json, "since",
	            alarm->since_ns ? when_iso(&live->now, alarm->since_ns, text) : NULL);
	if (alarm->device)
		json_uint(json, "occurrences", alarm->occurrences);
	if (alarm->shelved) {
		json_string(json, "until", when_iso(&live->now, alarm->shelved->until_ns, text));
		who_json(json, &alarm->shelved->who);
		json_string(json, "why", *alarm->shelved->why ? alarm->shelved->why : NULL);
	}
	reading_json(json, live->h, live->reading, &live->now);
	json_object_end(json);
}

static void add(struct live *live, const struct alarm *alarm)
{
	if (live->table)
		add_row(live, alarm);
	else
		add_json(live, alarm);
}

/* Why the alarm of the reading's signal is not armed, if no reading has failed since. */
static const char *why_unarmed(const struct ows_alarm_state *state, const struct reading *reading,
                               char words[ERROR_WORDS])
{
	const char *key = state->unarmed == 2 ? "PorAlarm" : "SetAlarm";
	int error = reading_good(reading) ? reading->value.err : 0;

	switch (-error) {
	case 0:
		snprintf(words, ERROR_WORDS, "cannot be armed");
		break;
	case EACCES:
		snprintf(words, ERROR_WORDS, "cannot be armed: %s cannot be written", key);
		break;
	case EBADRQC:
		snprintf(words, ERROR_WORDS, "cannot be armed: %s", error_text(error));
		break;
	case EUCLEAN:
		snprintf(words, ERROR_WORDS, "cannot be armed: %s is still set after 0 was written",
		         key);
		break;
	default:
		snprintf(words, ERROR_WORDS, "cannot be armed: %s: %s", key, error_text(error));
	}
	return words;
}

static void print_shelved(const struct live *live, const char *name,
                          const struct ows_alarm_state *state)
{
	char until[WHEN_TEXT], who[WHO_LINE], line[512], clean[512];

	snprintf(line, sizeof(line), "%s: shelved until %s by %s%s%s", name,
	         when_iso(&live->now, state->until_ns, until), who_line(&state->who, who),
	         *state->why ? ": " : "", state->why);
	text_clean(line, strlen(line), sizeof(clean), clean, sizeof(clean));
	puts(clean);
}

/* Print the reasons below the table, which they would make too wide. */
static void print_reasons(struct live *live, const struct rows *rows, char *const *patterns,
                          int pattern_count)
{
	struct ows_alarm_state state;
	char words[ERROR_WORDS];

	for (int i = 0; i < rows->count; i++) {
		state = (struct ows_alarm_state){0};
		if (!names_match(rows->row[i].name, patterns, pattern_count) ||
		    ows_alarm_state(live->h, rows->row[i].id, &state) == -EAGAIN)
			continue;
		if (state.shelved)
			print_shelved(live, rows->row[i].name, &state);
		if (!state.unarmed)
			continue;
		reading_get(live->h, rows->row[i].id, live->now.boot, live->reading);
		printf("%s: %s\n", rows->row[i].name, why_unarmed(&state, live->reading, words));
	}
}

static void look_at_limit(struct live *live, int signal, const char *name,
                          const struct ows_alarm_state *state)
{
	struct alarm alarm = {
		.name = name,
		.kind = ows_alarm_kind_text(state->limit_kind),
		.state = ows_limit_state_text(state->limit_state),
	};

	if (state->shelved) {
		alarm.state = "shelved";
		alarm.since_ns = state->since_ns;
		alarm.shelved = state;
		add(live, &alarm);
	} else if (state->limit_state != OWS_LIMIT_NORMAL) {
		alarm.since_ns = raised(live->h, signal, state->limit_kind);
		add(live, &alarm);
	}
}

static void look_at(struct live *live, int signal, const struct row *row)
{
	struct ows_alarm_state state = {0};
	struct alarm alarm = {.name = row->name};
	char unarmed[ERROR_WORDS];

	if (ows_alarm_state(live->h, row->id, &state) == -EAGAIN)
		return;
	reading_get(live->h, row->id, live->now.boot, live->reading);
	if (live->table)
		reading_round(live->reading, row_decimals(row));
	if (state.stands || state.polled) {
		alarm.kind = ows_alarm_kind_text(OWS_ALARM_DEVICE);
		alarm.state = state.stands ? "stands" : "no alarm search there: read as an input";
		alarm.device = true;
		alarm.polled = state.polled;
		alarm.occurrences = state.occurrences;
		if (state.stands)
			alarm.since_ns = raised(live->h, signal, OWS_ALARM_DEVICE);
		add(live, &alarm);
	}
	if (state.unarmed) {
		alarm = (struct alarm){
			.name = row->name,
			.kind = ows_alarm_kind_text(OWS_ALARM_DEVICE),
			.state = live->table ? "cannot be armed"
		                             : why_unarmed(&state, live->reading, unarmed),
			.device = true,
			.polled = state.polled,
			.occurrences = state.occurrences,
		};
		add(live, &alarm);
	}
	look_at_limit(live, signal, row->name, &state);
}

/* rows: all signals of the table, in its order. */
static bool show(struct ows *h, const struct rows *rows, bool json, char *const *patterns,
                 int pattern_count)
{
	static struct reading reading;
	struct table table;
	struct live live = {.h = h, .now = when_now(), .reading = &reading, .ok = true};
	char line[2048];

	table_init(&table, columns, COLUMNS);
	if (json) {
		json_open(&live.json, stdout);
		json_array(&live.json, NULL);
	} else {
		live.table = &table;
	}
	for (int i = 0; live.ok && i < rows->count; i++)
		if (names_match(rows->row[i].name, patterns, pattern_count))
			look_at(&live, i, &rows->row[i]);
	if (json) {
		json_array_end(&live.json);
		json_end(&live.json);
	}
	table_fit(&table, 0);
	for (int i = -1; !json && live.ok && i < (int)table.rows; i++) {
		table_line(&table, i, line, sizeof(line));
		puts(line);
	}
	if (!json && live.ok)
		print_reasons(&live, rows, patterns, pattern_count);
	table_free(&table);
	return live.ok;
}

/* The words that `owsctl alarms` does not take for patterns. */
static const char *const words[] = {ALARMS_HISTORY, ALARMS_ACK, ALARMS_SHELVE, ALARMS_UNSHELVE};
#define WORDS (sizeof(words) / sizeof(words[0]))

/* The word that the pattern is but for a slip of the finger, or NULL. */
static const char *nearest_word(const char *pattern)
{
	for (size_t i = 0; i < WORDS; i++)
		if (names_distance(pattern, words[i]) <= strlen(words[i]) / 3)
			return words[i];
	return NULL;
}

static bool matches(struct ows *h, char *const *pattern)
{
	struct ows_info info;

	for (int i = 0; i < ows_count(h); i++)
		if (ows_info(h, i, &info) == 0 && names_match(info.name, pattern, 1))
			return true;
	return false;
}

bool alarms_known(struct ows *h, char *const *patterns, int count)
{
	const char *word;
	bool known = true;

	for (int i = 0; i < count; i++) {
		if (matches(h, &patterns[i]))
			continue;
		known = false;
		word = nearest_word(patterns[i]);
		if (word)
			ctl_fail("there is no %s; did you mean alarms %s?", patterns[i], word);
		else if (strpbrk(patterns[i], "*?["))
			ctl_fail("no signal matches %s", patterns[i]);
		else
			ctl_unknown(h, patterns[i]);
	}
	return known;
}

int alarms_live(struct ctl *ctl, int argc, char **argv)
{
	struct rows rows;
	struct ows *h;
	int status;

	ctl_options();
	if (ctl_option(ctl, argc, argv, "") != -1)
		return CTL_USAGE;
	status = ctl_open(ctl, OWS_READ, &h);
	if (status)
		return status;
	if (rows_collect(h, NULL, 0, false, &rows) != 0) {
		ows_close(h);
		return ctl_fail("no memory");
	}
	ctl_alive(ctl, h, ows_now());
	if (!alarms_known(h, argv + optind, argc - optind))
		status = CTL_FAILED;
	else if (!show(h, &rows, ctl->json, argv + optind, argc - optind))
		status = ctl_fail("no memory");
	rows_free(&rows);
	ows_close(h);
	return status;
}
