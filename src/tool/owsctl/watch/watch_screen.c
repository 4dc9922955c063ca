/* SPDX-License-Identifier: MIT */
/* The live table of owsctl watch on a terminal. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "hal/base/time.h"
#include "src/faces/show/text.h"
#include "src/tool/owsctl/ctl.h"
#include "src/tool/owsctl/watch/terminal.h"
#include "src/tool/owsctl/watch/watch_screen.h"

#define BETWEEN_KEYS (50 * NS_PER_MS)
#define BETWEEN_PICTURES (250 * NS_PER_MS)
#define LONGEST_PICTURE NS_PER_S /* ages grow without a wake-up */

/* What a row is, in the order of "bad first". */
enum rank { BAD, WANTS_EYES, IN_ALARM, GOOD, RANKS };

struct screen {
	struct watch *watch;
	unsigned lines, width;
	struct table table; /* the rows that are shown, in the order of the file */
	enum rank *rank;    /* of each of them */
	int *order;         /* the rows of the table, as they are sorted */
	int top;            /* index of the first one on the screen */
	int of_rank[RANKS]; /* how many, of all */
	const char *target; /* of all rows, for the head line; "" where there are several */
	const char *note;   /* what happened to owsd last */
	char search[32];    /* in a name or a path; "": all */
	bool typing;        /* the search is being typed */
	bool bad_first;
	char **before; /* the lines on the terminal */
	unsigned line; /* the next one of the picture */
};

/* Is there a line below the rows, with the keys or what was chosen by them? */
static bool has_foot(const struct screen *screen)
{
	return (int)screen->table.rows > (int)screen->lines - 2 || screen->typing ||
	       *screen->search || screen->bad_first;
}

/* The rows that fit below the two head lines; one line stays free for the foot. */
static int room(const struct screen *screen)
{
	int lines = (int)screen->lines - 2 - has_foot(screen);

	return lines < 0 ? 0 : lines;
}

static void keep_top_in_range(struct screen *screen)
{
	int last = (int)screen->table.rows - room(screen);

	if (screen->top > last)
		screen->top = last;
	if (screen->top < 0)
		screen->top = 0;
}

/* A line is written only if it is another than the one on the terminal. */
static void put_line(struct screen *screen, const char *style, const char *text)
{
	char cut[1024], *whole;
	unsigned line = screen->line++;

	text_clean(text, strlen(text), screen->width, cut, sizeof(cut));
	if (line >= screen->lines || asprintf(&whole, "%s%s", style, cut) < 0)
		return;
	if (!screen->before[line] || strcmp(screen->before[line], whole) != 0)
		printf("\033[%u;1H%s\033[0m\033[K", line + 1, whole);
	free(screen->before[line]);
	screen->before[line] = whole;
}

/* Nothing is known of what is on the terminal: all of it is written again. */
static void forget_lines(struct screen *screen, unsigned lines)
{
	for (unsigned i = 0; i < screen->lines; i++)
		free(screen->before[i]);
	free(screen->before);
	screen->before = ctl_need(calloc(lines + 1u, sizeof(*screen->before)));
	screen->lines = lines;
}

static void put_head(struct screen *screen)
{
	struct watch *watch = screen->watch;
	const int *of = screen->of_rank;
	struct ows_daemon daemon = {0};
	struct ows_log_line refused;
	int64_t now = ows_now();
	char text[640], span[WHEN_TEXT], clock[16] = "", alarms[32] = "";
	time_t wall = time(NULL);
	struct tm local;
	int n;

	ows_daemon(watch->h, now, &daemon);
	if (localtime_r(&wall, &local))
		strftime(clock, sizeof(clock), "%H:%M:%S", &local);
	if (rows_have_alarms(watch->h, &watch->rows))
		snprintf(alarms, sizeof(alarms), ", %d in alarm", of[WANTS_EYES] + of[IN_ALARM]);
	n = snprintf(text, sizeof(text), "%s  %s  ", watch->ctl->instance, clock);
	if (daemon.alive)
		n += snprintf(text + n, sizeof(text) - (size_t)n, "%d signal%s, %d not good%s  ",
		              watch->rows.count, watch->rows.count == 1 ? "" : "s", of[BAD],
		              alarms);
	if (daemon.state == 3)
		snprintf(text + n, sizeof(text) - (size_t)n, "owsd was stopped");
	else if (!daemon.alive)
		snprintf(text + n, sizeof(text) - (size_t)n,
		         "owsd is not running: last heartbeat %s ago",
		         rows_span(daemon.beat_age_ns, span));
	else if (ows_refused_reload(watch->h, &refused) == 0)
		snprintf(text + n, sizeof(text) - (size_t)n, "reload refused: %s", refused.text);
	else
		snprintf(text + n, sizeof(text) - (size_t)n, "up %s%s%s%s%s",
		         rows_span(now - daemon.start_ns, span), *screen->note ? "  owsd " : "",
		         screen->note, *screen->target ? "  " : "", screen->target);
	put_line(screen, daemon.alive ? "" : "\033[7m", text);
}

static bool is_sought(const struct screen *screen, const struct row *row)
{
	return !*screen->search || strcasestr(row->name, screen->search) ||
	       (row->path && strcasestr(row->path, screen->search));
}

static enum rank rank_of(const struct row *row, const struct reading *reading)
{
	return !reading_good(reading)              ? BAD
	       : standing_wants_eyes(&row->alarms) ? WANTS_EYES
	       : standing_any(&row->alarms)        ? IN_ALARM
	                                           : GOOD;
}

/* Read all rows: which are shown, in which order, and what the head line says of all. */
static void survey(struct screen *screen)
{
	struct watch *watch = screen->watch;
	struct table *table = &screen->table;
	size_t room = (size_t)watch->rows.count + 1;
	int64_t now = ows_now();
	struct ows_target target;
	int served = -1, k = 0;

	screen->order = ctl_need(realloc(screen->order, room * sizeof(*screen->order)));
	screen->rank = ctl_need(realloc(screen->rank, room * sizeof(*screen->rank)));
	memset(screen->of_rank, 0, sizeof(screen->of_rank));
	screen->target = "";
	table_clear(table);
	rows_absent(watch->h, &watch->rows, table);
	table->absent[ROWS_TYPE] = table->absent[ROWS_IO] = true;
	for (int i = 0; i < watch->rows.count; i++) {
		struct row *row = &watch->rows.row[i];
		enum rank rank;

		row_read(watch->h, row, now, watch->reading);
		reading_round(watch->reading, row_decimals(row));
		rank = rank_of(row, watch->reading);
		screen->of_rank[rank]++;
		if (row_changed(row, watch->reading) && watch->left > 0)
			watch->left--;
		if (row->path && !ows_target(watch->h, watch->reading->value.target, &target)) {
			screen->target = served < 0 || served == watch->reading->value.target
			                         ? target.name
			                         : "";
			served = *screen->target ? watch->reading->value.target : INT32_MAX;
		}
		if (!is_sought(screen, row))
			continue;
		screen->rank[table->rows] = rank;
		rows_add_cells(table, watch->h, row, watch->reading, true);
	}
	table->absent[ROWS_TARGET] = *screen->target;
	for (enum rank rank = BAD; rank < RANKS; rank++)
		for (int i = 0; i < (int)table->rows && (screen->bad_first || rank == BAD); i++)
			if (!screen->bad_first || screen->rank[i] == rank)
				screen->order[k++] = i;
}

static void put_foot(struct screen *screen, int last)
{
	char text[200];

	if (screen->typing)
		snprintf(text, sizeof(text), "/%s", screen->search);
	else
		snprintf(text, sizeof(text),
		         "%d to %d of %d%s%s%s; / searches, ! bad first, q ends",
		         screen->top + (last > screen->top), last, (int)screen->table.rows,
		         *screen->search ? " with " : "", screen->search,
		         screen->bad_first ? "; bad first" : "");
	while (screen->line + 1 < screen->lines)
		put_line(screen, "", "");
	put_line(screen, screen->typing ? "" : "\033[2m", text);
}

/* Red for a value that is not good, yellow for an alarm to acknowledge; the words state both. */
static const char *style_of(enum rank rank)
{
	return getenv("NO_COLOR")   ? ""
	       : rank == BAD        ? "\033[31m"
	       : rank == WANTS_EYES ? "\033[33m"
	                            : "";
}

/* One picture; false: the terminal is gone. */
static bool draw(struct screen *screen)
{
	struct table *table = &screen->table;
	char line[2048];
	int at;

	screen->line = 0;
	survey(screen);
	keep_top_in_range(screen);
	table_fit(table, screen->width);
	/* columns do not jump */
	memcpy(table->least, table->natural, sizeof(table->least));
	put_head(screen);
	table_line(table, -1, line, sizeof(line));
	put_line(screen, "\033[1m", line);
	for (at = screen->top; at < (int)table->rows && at < screen->top + room(screen); at++) {
		table_line(table, screen->order[at], line, sizeof(line));
		put_line(screen, style_of(screen->rank[screen->order[at]]), line);
	}
	if (has_foot(screen) && screen->lines > 2)
		put_foot(screen, at);
	while (screen->line < screen->lines)
		put_line(screen, "", "");
	return ctl_flush_lines();
}

/* A byte of the search; Enter ends it, and Esc takes it back. */
static void on_byte(struct screen *screen, int byte)
{
	size_t len = strlen(screen->search);

	screen->top = 0;
	if (byte == '\r' || byte == '\n' || byte & TERMINAL_ESCAPED) {
		screen->typing = false;
		if (byte & TERMINAL_ESCAPED)
			screen->search[0] = '\0';
	} else if (byte == 0x7f || byte == '\b') {
		screen->search[len ? len - 1 : 0] = '\0';
	} else if (byte > ' ' && len + 1 < sizeof(screen->search)) {
		screen->search[len] = (char)byte;
		screen->search[len + 1] = '\0';
	}
}

/* Returns false to end. */
static bool on_key(struct screen *screen, int key)
{
	switch (key & ~TERMINAL_ESCAPED) {
	case 'q':
	case 'Q':
	case 'D' - '@':
		return false;
	case 'k':
		screen->top--;
		break;
	case 'j':
		screen->top++;
		break;
	case 'b':
		screen->top -= room(screen);
		break;
	case ' ':
		screen->top += room(screen);
		break;
	case 'g':
		screen->top = 0;
		break;
	case 'G':
		screen->top = (int)screen->table.rows;
		break;
	case '/':
		screen->typing = true;
		screen->search[0] = '\0';
		break;
	case '!':
		screen->bad_first = !screen->bad_first;
		screen->top = 0;
		break;
	}
	keep_top_in_range(screen);
	return true;
}

/* All that was typed. 0; 1: something was; -1: the user ends it. */
static int take_keys(struct screen *screen)
{
	int pressed = 0, key;

	for (; (key = terminal_key()); pressed = 1) {
		if (screen->typing)
			on_byte(screen, key);
		else if (!on_key(screen, key))
			return -1;
	}
	return pressed;
}

static void watch_screen_run(struct screen *screen)
{
	const struct watch_event *event = NULL;
	int64_t drawn = 0, now;
	uint32_t news = 0;
	unsigned lines;
	int pressed;

	do {
		if (event)
			screen->note = event->told;
		if (terminal_size(&lines, &screen->width)) {
			forget_lines(screen, lines);
			drawn = 0;
		}
		if (drawn == 0 || event)
			memset(screen->table.least, 0, sizeof(screen->table.least));
		pressed = take_keys(screen);
		now = ows_now();
		if (pressed > 0 || event || drawn == 0 || now - drawn >= LONGEST_PICTURE ||
		    (news != screen->watch->news && now - drawn >= BETWEEN_PICTURES)) {
			news = screen->watch->news;
			drawn = now;
			if (!draw(screen))
				return;
		}
		event = pressed < 0 || watch_over(screen->watch)
		                ? NULL
		                : watch_sleep(screen->watch, BETWEEN_KEYS);
	} while (pressed >= 0 && !watch_over(screen->watch));
}

void watch_screen(struct watch *watch)
{
	struct screen screen = {.watch = watch, .note = "", .target = ""};

	table_init(&screen.table, rows_columns, ROWS_COLUMNS);
	setvbuf(stdout, NULL, _IOFBF, BUFSIZ);
	terminal_open();
	watch_screen_run(&screen);
	terminal_close();
	forget_lines(&screen, 0);
	free(screen.before);
	free(screen.order);
	free(screen.rank);
	table_free(&screen.table);
}
