/* SPDX-License-Identifier: MIT */
/* owsctl journal: who did what and when; alarms and commands merged, and followed as they come. */
#include <errno.h>
#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/bus/time.h"
#include "src/owsctl/alarms_live.h"
#include "src/owsctl/ctl.h"
#include "src/owsctl/journal_row.h"
#include "src/owsctl/terminal.h"
#include "src/owsctl/verbs.h"

#define SLICE (500 * NS_PER_MS) /* a dead owsd sends no wake-up */
#define LINE 2048

struct journal {
	struct ctl *ctl;
	struct ows *h;
	char *const *patterns;
	int pattern_count;
	int64_t most; /* of the entries that are there; -1: all */
	bool follows;
	struct journal_entries entries;
	struct table table;
};

static bool print_rows(struct journal *j, unsigned from, bool titled)
{
	struct when now = when_now();
	char line[LINE];
	bool ok = true;

	for (unsigned i = from; ok && i < j->entries.count; i++)
		ok = journal_row(&j->table, &now, &j->entries.entry[i]);
	table_fit(&j->table, 0);
	for (int i = titled ? -1 : 0; ok && i < (int)j->table.rows; i++) {
		table_line(&j->table, i, line, sizeof(line));
		puts(line);
	}
	/* later rows stand below these */
	memcpy(j->table.least, j->table.width, sizeof(j->table.least));
	table_clear(&j->table);
	return ok;
}

/* One document; while it follows, a line for each entry. */
static void print_json(struct journal *j, unsigned from)
{
	struct when now = when_now();
	struct json json;

	json_open(&json, stdout);
	if (!j->follows)
		json_array(&json, NULL);
	for (unsigned i = from; i < j->entries.count; i++) {
		journal_json(&json, &now, &j->entries.entry[i]);
		if (j->follows)
			json_end(&json);
	}
	if (j->follows)
		return;
	json_array_end(&json);
	json_end(&json);
}

static bool print_entries(struct journal *j, bool first)
{
	unsigned from = 0;

	if (!journal_look(j->h, j->patterns, j->pattern_count, &j->entries))
		return false;
	if (first && j->most >= 0 && j->entries.count > j->most)
		from = j->entries.count - (unsigned)j->most;
	if (!j->ctl->json)
		return print_rows(j, from, first);
	print_json(j, from);
	return true;
}

/* A start of owsd begins its journals anew; a reload goes on with them. */
static bool follow(struct journal *j)
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
		if (!print_entries(j, false))
			return false;
	}
	return true;
}

static int show(struct journal *j)
{
	bool ok;

	ctl_alive(j->ctl, j->h, ows_now());
	if (!alarms_known(j->h, j->patterns, j->pattern_count))
		return CTL_FAILED;
	table_init(&j->table, journal_columns, JOURNAL_COLUMNS);
	ok = print_entries(j, true) && (!j->follows || follow(j));
	table_free(&j->table);
	journal_free(&j->entries);
	return ok ? CTL_DONE : ctl_fail("no memory");
}

static bool parse_count(const char *text, int64_t *count)
{
	char *end;

	errno = 0;
	*count = strtoll(text, &end, 10);
	return end != text && !*end && !errno && *count >= 0;
}

int verb_journal(struct ctl *ctl, int argc, char **argv)
{
	struct journal j = {.ctl = ctl, .most = -1};
	int c, status;

	ctl_options();
	while ((c = ctl_option(ctl, argc, argv, "fc:")) != -1) {
		switch (c) {
		case 'f':
			j.follows = true;
			break;
		case 'c':
			if (!parse_count(optarg, &j.most))
				return ctl_usage(ctl, "-c wants a number of entries, not %s",
				                 ctl_word(optarg));
			break;
		default:
			return CTL_USAGE;
		}
	}
	j.patterns = argv + optind;
	j.pattern_count = argc - optind;
	status = ctl_open(ctl, OWS_READ, &j.h);
	if (status)
		return status;
	status = show(&j);
	ows_close(j.h);
	return status;
}
