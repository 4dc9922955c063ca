/* SPDX-License-Identifier: MIT */
/* owsctl alarms: the alarms that stand. */
#include <errno.h>
#include <getopt.h>
#include <stdio.h>
#include <string.h>

#include "src/faces/show/actor.h"
#include "src/faces/show/names.h"
#include "src/faces/show/present.h"
#include "src/faces/show/text.h"
#include "src/ground/signal/error.h"
#include "src/ground/signal/unarmed.h"
#include "src/ground/text/distance.h"
#include "src/tool/owsctl/alarms/alarms_live.h"
#include "src/tool/owsctl/rows.h"
#include "src/tool/owsctl/table.h"

struct live {
	struct ows *h;
	struct when now;
	struct reading *reading;
	struct table *table; /* NULL: JSON */
	struct json json;
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

static void alarms_live_add_row(struct live *live, const struct present *alarm)
{
	char value[128] = "-", words[READING_WORDS], span[WHEN_TEXT] = "-";
	const char *state = alarm->unarmed ? unarmed_text(alarm->unarmed) : alarm->state;

	reading_round(live->reading, alarm->decimals);
	/* nobody measured InitValue */
	if (live->reading->value.measured_ns || reading_good(live->reading))
		reading_show(live->reading, value, sizeof(value));
	if (alarm->since_ns)
		when_span(live->now.boot - alarm->since_ns, span);
	table_add(live->table, (const char *const[]){alarm->name, alarm->kind, state, span, value,
	                                             reading_quality(live->reading, words)});
}

static void alarms_live_add(void *ctx, const struct present *alarm)
{
	struct live *live = ctx;

	if (live->table) {
		alarms_live_add_row(live, alarm);
		return;
	}
	json_object(&live->json, NULL);
	present_json(&live->json, alarm, &live->now);
	reading_json(&live->json, live->h, live->reading, &live->now);
	json_object_end(&live->json);
}

static void print_line(const char *line)
{
	char clean[512];

	text_clean(line, strlen(line), sizeof(clean), clean, sizeof(clean));
	puts(clean);
}

static void print_shelved(const struct live *live, const char *name,
                          const struct ows_alarm_state *state)
{
	char until[WHEN_TEXT], who[ACTOR_LINE], line[512];

	snprintf(line, sizeof(line), "%s: shelved until %s by %s%s%s", name,
	         when_iso(&live->now, state->until_ns, until), actor_line(&state->who, who),
	         *state->why ? ": " : "", state->why);
	print_line(line);
}

/* Print the reasons below the table, which they would make too wide. */
static void print_reasons(struct live *live, const struct rows *rows, char *const *patterns,
                          int pattern_count)
{
	struct ows_alarm_state state;
	char words[ERROR_WORDS], line[512];

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
		snprintf(line, sizeof(line), "%s: %s", rows->row[i].name,
		         present_unarmed(&state, live->reading, words));
		print_line(line);
	}
}

/* rows: all signals of the table, in its order. */
static void alarms_live_show(struct ows *h, const struct rows *rows, bool json,
                             char *const *patterns, int pattern_count)
{
	static struct reading reading;
	struct table table;
	struct live live = {.h = h, .now = when_now(), .reading = &reading};

	table_init(&table, columns, COLUMNS);
	json_list(&live.json, stdout, json);
	if (!json)
		live.table = &table;
	for (int i = 0; i < rows->count; i++)
		if (names_match(rows->row[i].name, patterns, pattern_count))
			present_each(h, i, rows->row[i].id, live.now.boot, &reading,
			             alarms_live_add, &live);
	json_list_end(&live.json);
	if (!json) {
		table_print(&table, true);
		print_reasons(&live, rows, patterns, pattern_count);
	}
	table_free(&table);
}

/* The word that the pattern is but for a slip of the finger, or NULL. */
static const char *nearest_word(const char *pattern)
{
	for (const struct alarms_word *w = alarms_words; w->word; w++)
		if (text_distance(pattern, w->word) <= strlen(w->word) / 3)
			return w->word;
	return NULL;
}

bool alarms_known(struct ows *h, char *const *patterns, int count)
{
	const char *word;
	bool known = true;

	for (int i = 0; i < count; i++) {
		if (names_some(h, &patterns[i], 1))
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
	int status = CTL_DONE;

	ctl_option(ctl, argc, argv, "");
	h = ctl_open(ctl, OWS_READ);
	rows_collect(h, NULL, 0, false, &rows);
	ctl_alive(ctl, h, ows_now());
	if (!alarms_known(h, argv + optind, argc - optind))
		status = CTL_FAILED;
	else
		alarms_live_show(h, &rows, ctl->json, argv + optind, argc - optind);
	rows_free(&rows);
	ows_close(h);
	return status;
}
