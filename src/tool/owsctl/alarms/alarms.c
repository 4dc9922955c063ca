/* SPDX-License-Identifier: MIT */
/*
 * owsctl alarms: lists the present alarms, or does what the word after it says: acknowledges,
 * shelves and unshelves limit alarms, or lists those of before.
 */
#include <errno.h>
#include <getopt.h>
#include <stdio.h>
#include <string.h>

#include "hal/base/time.h"
#include "src/faces/show/actor.h"
#include "src/faces/show/names.h"
#include "src/faces/show/present.h"
#include "src/faces/show/text.h"
#include "src/faces/show/when.h"
#include "src/ground/signal/error.h"
#include "src/ground/signal/unarmed.h"
#include "src/ground/text/distance.h"
#include "src/public/ows.h"
#include "src/tool/owsctl/alarms/alarms.h"
#include "src/tool/owsctl/ctl.h"
#include "src/tool/owsctl/rows.h"
#include "src/tool/owsctl/table.h"
#include "src/tool/owsctl/verbs.h"

/* --- Acknowledge ----------------------------------------------------------------------------- */

/* owsd takes an acknowledgement at once; an owsd that takes longer hangs. */
#define PATIENCE_NS (2 * NS_PER_S)

static bool unacknowledged(struct ows *h, int id)
{
	struct ows_alarm_state state = {0};

	ows_alarm_state(h, id, &state);
	return standing_unacknowledged(&state);
}

/* The id of an alarm to acknowledge; -1 after printing why there is none. */
static int alarms_ack_find(struct ows *h, const char *name)
{
	struct ows_alarm_state state = {0};
	int id = ows_find(h, name);

	if (id < 0) {
		ctl_unknown(h, name);
		return -1;
	}
	ows_alarm_state(h, id, &state);
	if (!state.limits) {
		ctl_fail("%s has no limit alarms", name);
		return -1;
	}
	return id;
}

static int acknowledge(struct ows *h, const char *name, int id)
{
	int64_t until = ows_now() + PATIENCE_NS, left;
	uint32_t news = 0;
	int err;

	if (!unacknowledged(h, id))
		return CTL_DONE;
	err = ows_acknowledge(h, id);
	if (err)
		return ctl_fail("cannot acknowledge %s: %s", name, strerror(-err));
	while (unacknowledged(h, id)) {
		left = until - ows_now();
		if (left <= 0)
			return ctl_fail("owsd did not take the acknowledgement of %s", name);
		ctl_sleep(h, &news, left);
	}
	return CTL_DONE;
}

static int acknowledge_all(struct ows *h)
{
	int status = CTL_DONE;

	for (int i = 0; i < ows_count(h); i++) {
		struct ows_info info;

		if (ows_info(h, i, &info) == 0 && acknowledge(h, info.name, ows_find(h, info.name)))
			status = CTL_FAILED;
	}
	return status;
}

static int acknowledge_names(struct ows *h, int count, char **names)
{
	int status = CTL_DONE;

	for (int i = 0; i < count; i++)
		if (alarms_ack_find(h, names[i]) < 0)
			status = CTL_FAILED;
	for (int i = 0; status == CTL_DONE && i < count; i++)
		status = acknowledge(h, names[i], ows_find(h, names[i]));
	return status;
}

static int alarms_ack(struct ctl *ctl, int argc, char **argv)
{
	bool all = false;
	struct ows *h;
	int status;

	while (ctl_option(ctl, argc, argv, "a") != -1)
		all = true;
	if (all != (optind == argc))
		return ctl_usage(ctl, "alarms ack takes names or -a");
	h = ctl_open(ctl, OWS_CONTROL);
	if (!ctl_alive(ctl, h, ows_now()))
		status = CTL_FAILED;
	else if (all)
		status = acknowledge_all(h);
	else
		status = acknowledge_names(h, argc - optind, argv + optind);
	ows_close(h);
	return status;
}

/* --- Shelve and unshelve --------------------------------------------------------------------- */

static int alarms_shelve_fail(const char *name, bool shelve, int err)
{
	const char *verb = shelve ? "shelve" : "unshelve";

	switch (-err) {
	case EOPNOTSUPP:
		return ctl_fail("%s has no limit alarms", name);
	case ENOSPC:
		return ctl_fail("cannot shelve %s: as many alarms are shelved as can be", name);
	case EAGAIN:
		return ctl_fail("cannot %s %s: too many requests; try again in a second", verb,
		                name);
	case ETIMEDOUT:
		return ctl_fail("owsd did not %s %s", verb, name);
	}
	return ctl_fail("cannot %s %s: %s", verb, name, strerror(-err));
}

/* seconds 0: unshelve. */
static int shelve_names(struct ctl *ctl, int count, char **names, uint32_t seconds, const char *why)
{
	struct ows *h = ctl_open(ctl, OWS_CONTROL);
	int status = CTL_DONE, id, err;

	if (!ctl_alive(ctl, h, ows_now()))
		status = CTL_FAILED;
	for (int i = 0; status == CTL_DONE && i < count; i++)
		if (ows_find(h, names[i]) < 0)
			status = ctl_unknown(h, names[i]);
	for (int i = 0; status == CTL_DONE && i < count; i++) {
		id = ows_find(h, names[i]);
		err = ows_shelve(h, id, seconds, why);
		if (err)
			status = alarms_shelve_fail(names[i], seconds > 0, err);
	}
	ows_close(h);
	return status;
}

static int alarms_shelve(struct ctl *ctl, int argc, char **argv)
{
	int64_t ns;

	ctl_option(ctl, argc, argv, "");
	if (argc - optind != 2 && argc - optind != 3)
		return ctl_usage(ctl, "alarms shelve takes a name, a time and perhaps a reason");
	if (!when_parse(argv[optind + 1], &ns) || ns < NS_PER_S || ns > OWS_SHELVE_MAX * NS_PER_S)
		return ctl_usage(ctl,
		                 "%s is no time to shelve an alarm: seconds, or as 30m, 8h or 2d; "
		                 "at most 7d",
		                 ctl_word(argv[optind + 1]));
	return shelve_names(ctl, 1, argv + optind, (uint32_t)(ns / NS_PER_S),
	                    argc - optind == 3 ? argv[optind + 2] : "");
}

static int alarms_unshelve(struct ctl *ctl, int argc, char **argv)
{
	ctl_option(ctl, argc, argv, "");
	if (optind == argc)
		return ctl_usage(ctl, "alarms unshelve takes names");
	return shelve_names(ctl, argc - optind, argv + optind, 0, "");
}

/* --- The words ------------------------------------------------------------------------------- */

/* The words of `owsctl alarms` that are no patterns. */
static const struct {
	const char *word;
	int (*run)(struct ctl *ctl, int argc, char **argv); /* argv[0] is the word */
} deeds[] = {
	{"history", journal_alarms},
	{"ack", alarms_ack},
	{"shelve", alarms_shelve},
	{"unshelve", alarms_unshelve},
};
#define DEEDS (sizeof(deeds) / sizeof(deeds[0]))

/* --- The present alarms ---------------------------------------------------------------------- */

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
	char value[128], words[READING_WORDS], span[WHEN_TEXT] = "-";
	const char *state = alarm->unarmed ? unarmed_text(alarm->unarmed) : alarm->state;

	reading_round(live->reading, alarm->decimals);
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
	for (size_t i = 0; i < DEEDS; i++)
		if (text_distance(pattern, deeds[i].word) <= strlen(deeds[i].word) / 3)
			return deeds[i].word;
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

static int alarms_live(struct ctl *ctl, int argc, char **argv)
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

int verb_alarms(struct ctl *ctl, int argc, char **argv)
{
	for (size_t i = 0; argc > 1 && i < DEEDS; i++)
		if (strcmp(argv[1], deeds[i].word) == 0)
			return deeds[i].run(ctl, argc - 1, argv + 1);
	return alarms_live(ctl, argc, argv);
}
