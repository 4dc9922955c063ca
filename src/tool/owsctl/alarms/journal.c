/* SPDX-License-Identifier: MIT */
/*
 * owsctl journal: which program did what, and when; alarms and commands, of owsd's memory and of
 * the disk, merged, and followed as they come.
 */
#include <errno.h>
#include <getopt.h>
#include <stdio.h>
#include <string.h>

#include "hal/base/time.h"
#include "src/faces/show/actor.h"
#include "src/faces/show/journal_entry.h"
#include "src/faces/show/journal_past.h"
#include "src/faces/show/names.h"
#include "src/tool/owsctl/alarms/alarms_live.h"
#include "src/tool/owsctl/alarms/journal.h"
#include "src/tool/owsctl/ctl.h"
#include "src/tool/owsctl/past.h"
#include "src/tool/owsctl/table.h"
#include "src/tool/owsctl/verbs.h"
#include "src/tool/owsctl/watch/terminal.h"

#define SLICE (500 * NS_PER_MS) /* a dead owsd sends no wake-up */
#define SINCE (7 * 86400 * NS_PER_S)
#define MOST 1000 /* from memory and disk together, without -c */
#define RINGS 512 /* entries that owsd keeps */
#define COUNT_MAX 1000000

#define JOURNAL_COLUMNS 8
/* clang-format off */
static const struct table_column journal_columns[JOURNAL_COLUMNS] = {
	{"TIME"}, {"NAME"}, {"EVENT"}, {"VALUE", .right = true, .most = 40}, {"PROGRAM"}, {"USER"},
	{"FOR"}, {"REMARK"},
};
/* clang-format on */

static void journal_row(struct table *table, const struct when *now,
                        const struct journal_entry *entry)
{
	char time[WHEN_TEXT], event[JOURNAL_EVENT], value[VALUE_TEXT_MAX], more[32] = "";
	char program[ACTOR_TEXT] = "-", user[ACTOR_TEXT] = "-";
	const char *shown = journal_value(entry, entry->decimals, value), *person = "", *remark;

	if (journal_is_deed(entry)) {
		actor_program(journal_by(entry), program);
		actor_user(journal_by(entry), user);
		person = journal_by(entry)->person;
	}
	remark = entry->is_command ? more : entry->alarm.text;
	if (entry->is_command && entry->command.more)
		snprintf(more, sizeof(more), "after %u more", (unsigned)entry->command.more);
	if (entry->is_command && entry->command.type == OWS_STRING)
		shown = entry->command.text;
	table_add(table, (const char *const[]){when_iso(now, entry->when_ns, time), entry->name,
	                                       journal_event(entry, event), shown ? shown : "-",
	                                       program, user, *person ? person : "-", remark});
}

struct journal {
	struct ctl *ctl;
	struct ows *h;               /* NULL: no owsd has run */
	struct ows_history *history; /* NULL: nothing is kept on disk */
	int64_t since_ns;            /* wall clock; of the disk */
	bool has_since;              /* of the memory, too */
	char *const *patterns;
	int pattern_count;
	int64_t most; /* of the entries that are there; -1: all */
	bool follows;
	bool alarms_alone;
	struct journal_entries entries;
	struct table table;
};

static void print_rows(struct journal *j, unsigned from, bool titled)
{
	struct when now = when_now();

	for (unsigned i = from; i < j->entries.count; i++)
		journal_row(&j->table, &now, &j->entries.entry[i]);
	table_print(&j->table, titled);
	/* later rows stand below these */
	memcpy(j->table.least, j->table.width, sizeof(j->table.least));
	table_clear(&j->table);
}

/* One document; while it follows, a line for each entry. */
static void journal_print_json(struct journal *j, unsigned from)
{
	struct when now = when_now();
	struct json json;

	json_list(&json, stdout, !j->follows);
	for (unsigned i = from; i < j->entries.count; i++) {
		journal_json(&json, &now, &j->entries.entry[i], false);
		if (j->follows)
			json_end(&json);
	}
	json_list_end(&json);
}

static void print_from(struct journal *j, unsigned from, bool titled)
{
	if (j->ctl->json)
		journal_print_json(j, from);
	else
		print_rows(j, from, titled);
}

static void print_news(struct journal *j)
{
	if (!journal_look(j->h, j->patterns, j->pattern_count, &j->entries))
		ctl_need(NULL);
	print_from(j, 0, false);
}

static void drop_commands(struct journal_entries *entries)
{
	unsigned count = 0;

	for (unsigned i = 0; i < entries->count; i++)
		if (!entries->entry[i].is_command)
			entries->entry[count++] = entries->entry[i];
	entries->count = count;
}

static void drop_older(struct journal_entries *entries, int64_t since_ns)
{
	unsigned old = 0;

	while (old < entries->count && entries->entry[old].when_ns < since_ns)
		old++;
	entries->count -= old;
	if (entries->count)
		memmove(entries->entry, entries->entry + old,
		        entries->count * sizeof(*entries->entry));
}

/* Those of the disk first: what is entered meanwhile is then in memory. 0 or -errno. */
static int look_at_both(struct journal *j)
{
	unsigned most = j->most < 0 ? MOST : (unsigned)j->most;
	struct when now = when_now();
	struct journal_entries past = {0};
	int err = 0;

	if (j->history)
		err = journal_past(j->history, &now, j->since_ns, INT64_MAX, j->patterns,
		                   j->pattern_count, most ? most + RINGS : 0, &past);
	if ((j->h && !journal_look(j->h, j->patterns, j->pattern_count, &j->entries)) ||
	    !journal_past_drop(&past, &j->entries))
		ctl_need(NULL);
	if (j->alarms_alone)
		drop_commands(&j->entries);
	if (j->has_since)
		drop_older(&j->entries, now.boot - (now.wall - j->since_ns));
	if (!journal_add(&j->entries, &past))
		ctl_need(NULL);
	journal_free(&past);
	return err;
}

/* A disk that cannot be read hides nothing of what owsd has in memory. */
static int print_both(struct journal *j)
{
	int err = look_at_both(j), status = CTL_DONE;
	unsigned count = j->entries.count, from = 0;

	if (err)
		status = past_fail("history", err);
	if (j->most >= 0 || j->history) {
		unsigned most = j->most < 0 ? MOST : (unsigned)j->most;

		from = count > most ? count - most : 0;
	}
	print_from(j, from, true);
	return status;
}

/* A start of owsd begins its journals anew; a reload goes on with them. */
static void journal_follow(struct journal *j)
{
	struct ows_daemon daemon = {0}, before;
	uint32_t news = 0;

	terminal_catch_signals();
	ows_daemon(j->h, ows_now(), &daemon);
	while (!terminal_asked_to_end() && ctl_flush_lines() && !ctl_reader_gone()) {
		before = daemon;
		ctl_sleep(j->h, &news, SLICE);
		ows_daemon(j->h, ows_now(), &daemon);
		if (before.alive && !daemon.alive)
			ctl_alive(j->ctl, j->h, ows_now());
		if (daemon.start_ns != before.start_ns) {
			ctl_fail("owsd %s was started again", j->ctl->instance);
			j->entries.begun = false;
		}
		print_news(j);
	}
}

static bool is_in_history(struct ows_history *history, char *const *pattern)
{
	struct ows_history_signal signal;

	for (int i = 0; history && !ows_history_signal(history, i, &signal); i++)
		if (names_match(signal.name, pattern, 1))
			return true;
	return false;
}

/* A signal may be in the history alone: it is no longer configured. */
static bool patterns_known(struct journal *j)
{
	bool known = true;

	for (int i = 0; i < j->pattern_count; i++) {
		if (is_in_history(j->history, &j->patterns[i]))
			continue;
		if (j->h && alarms_known(j->h, &j->patterns[i], 1))
			continue;
		if (!j->h)
			past_unknown(j->ctl, j->history, j->patterns[i]);
		known = false;
	}
	return known;
}

static int journal_show(struct journal *j)
{
	int status;

	if (j->h)
		ctl_alive(j->ctl, j->h, ows_now());
	if (!patterns_known(j))
		return CTL_FAILED;
	table_init(&j->table, journal_columns, JOURNAL_COLUMNS);
	status = print_both(j);
	ows_history_close(j->history);
	j->history = NULL;
	if (j->follows)
		journal_follow(j);
	table_free(&j->table);
	journal_free(&j->entries);
	return status;
}

int journal_alarms(struct ctl *ctl, int argc, char **argv)
{
	struct journal j = {.ctl = ctl, .most = -1, .alarms_alone = true};
	int status;

	ctl_option(ctl, argc, argv, "");
	j.patterns = argv + optind;
	j.pattern_count = argc - optind;
	j.h = ctl_open(ctl, OWS_READ);
	status = journal_show(&j);
	ows_close(j.h);
	return status;
}

/* Open the memory of owsd, the disk, or both. An owsd that has never run has no news to follow. */
static int open_both(struct journal *j, const char *directory)
{
	int status = past_look(j->ctl, directory, &j->history);

	if (status)
		return status;
	if (j->history && !j->follows && ows_open(j->ctl->instance, OWS_READ, &j->h) == -ENOENT)
		return CTL_DONE;
	if (!j->h && ows_open(j->ctl->instance, OWS_READ, &j->h)) {
		ows_history_close(j->history);
		j->history = NULL;
		j->h = ctl_open(j->ctl, OWS_READ); /* says why */
	}
	return CTL_DONE;
}

int verb_journal(struct ctl *ctl, int argc, char **argv)
{
	struct when now = when_now();
	struct journal j = {.ctl = ctl, .most = -1, .since_ns = now.wall - SINCE};
	const char *directory = NULL;
	int c, status;

	while ((c = ctl_option(ctl, argc, argv, "fc:s:d:")) != -1) {
		switch (c) {
		case 'f':
			j.follows = true;
			break;
		case 'c':
			if (!ctl_count(optarg, 0, COUNT_MAX, &j.most))
				return ctl_usage(ctl, "-c wants a number of entries, not %s",
				                 ctl_word(optarg));
			break;
		case 's':
			j.since_ns = ctl_moment(ctl, c, &now);
			j.has_since = true;
			break;
		case 'd':
			directory = optarg;
			break;
		}
	}
	j.patterns = argv + optind;
	j.pattern_count = argc - optind;
	status = open_both(&j, directory);
	if (!status)
		status = journal_show(&j);
	ows_history_close(j.history);
	ows_close(j.h);
	return status;
}
