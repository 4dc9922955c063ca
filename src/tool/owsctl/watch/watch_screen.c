/* SPDX-License-Identifier: MIT */
/* The live table of owsctl watch on a terminal. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "hal/base/time.h"
#include "src/faces/show/text.h"
#include "src/tool/owsctl/ctl.h"
#include "src/tool/owsctl/table.h"
#include "src/tool/owsctl/watch/terminal.h"
#include "src/tool/owsctl/watch/watch_screen.h"

#define BETWEEN_KEYS (50 * NS_PER_MS)
#define BETWEEN_PICTURES (250 * NS_PER_MS)
#define LONGEST_PICTURE NS_PER_S /* ages grow without a wake-up */

static const struct table_column columns[] = {
	{"NAME", .shrink = 24},
	{"VALUE", .right = true, .most = 32},
	{"UNIT", .drop = 4},
	{"QUALITY", .shrink = 13}, /* "device absent" */
	{"ALARM", .shrink = 8},
	{"AGE", .right = true, .drop = 2},
	{"PATH", .drop = 1, .shrink = 16}, /* "/28.551DDF030000" */
	{"TARGET", .drop = 3, .spare = true},
};
enum { UNIT = 2, ALARM = 4, TARGET = 7 };
#define COLUMNS (sizeof(columns) / sizeof(columns[0]))

struct screen {
	struct watch *watch;
	unsigned lines, width;
	int top;                 /* index of the first row on the screen */
	unsigned least[COLUMNS]; /* widths of the last picture, so that columns do not jump */
	int not_good, in_alarm;
	bool alarms; /* some signals can have alarms */
	/* The target of all rows, for the head line; "" when there are several. */
	char target[200];
	const char *note; /* what happened to owsd last */
	int *order;       /* the rows that are shown, as they are sorted; room for all */
	int count;        /* of them */
	char search[32];  /* in a name or a path; "": all */
	bool typing;      /* the search is being typed */
	enum { SORT_FILE, SORT_NAME, SORT_AGE, SORTS } sort;
	bool bad_first;
	char **before; /* the lines on the terminal; NULL: not known */
	unsigned before_count;
	unsigned line; /* the next one of the picture */
};

/* Is there a line below the rows, with the keys or what was chosen by them? */
static bool has_foot(const struct screen *screen)
{
	return screen->count > (int)screen->lines - 2 || screen->typing || *screen->search ||
	       screen->sort != SORT_FILE || screen->bad_first;
}

/* The rows that fit below the two head lines; one line stays free for the foot. */
static int room(const struct screen *screen)
{
	int lines = (int)screen->lines - 2 - has_foot(screen);

	return lines < 0 ? 0 : lines;
}

static void keep_top_in_range(struct screen *screen)
{
	int last = screen->count - room(screen);

	if (screen->top > last)
		screen->top = last;
	if (screen->top < 0)
		screen->top = 0;
}

/* A line is written only if it is another than the one on the terminal. */
static void put_line(FILE *out, struct screen *screen, const char *style, const char *text)
{
	char cut[1024], *whole;
	unsigned line = screen->line++;

	text_clean(text, strlen(text), screen->width, cut, sizeof(cut));
	if (line >= screen->before_count || asprintf(&whole, "%s%s", style, cut) < 0)
		return;
	if (!screen->before[line] || strcmp(screen->before[line], whole) != 0)
		fprintf(out, "\033[%u;1H%s\033[0m\033[K", line + 1, whole);
	free(screen->before[line]);
	screen->before[line] = whole;
}

/* Nothing is known of what is on the terminal: all of it is written again. */
static void forget_lines(struct screen *screen)
{
	for (unsigned i = 0; i < screen->before_count; i++)
		free(screen->before[i]);
	free(screen->before);
	screen->before = ctl_need(calloc(screen->lines + 1, sizeof(*screen->before)));
	screen->before_count = screen->lines;
}

/* An age or a time in whole seconds: a picture changes no more often. */
static const char *whole_seconds(int64_t ns, char text[WHEN_TEXT])
{
	if (ns < 0 || ns >= 60 * NS_PER_S)
		return when_span(ns, text);
	snprintf(text, WHEN_TEXT, "%ds", (int)(ns / NS_PER_S));
	return text;
}

/* What else is to be said of an owsd that lives: the refused reload first, as it has the reason. */
static void head_end(const struct screen *screen, int64_t up_ns, char *text, size_t size)
{
	struct ows_log_line refused;
	char span[WHEN_TEXT];

	if (ows_refused_reload(screen->watch->h, &refused) == 0)
		snprintf(text, size, "reload refused: %s", refused.text);
	else
		snprintf(text, size, "up %s%s%s%s%s", whole_seconds(up_ns, span),
		         *screen->note ? "  " : "", screen->note, *screen->target ? "  " : "",
		         screen->target);
}

static void put_head(FILE *out, struct screen *screen)
{
	struct watch *watch = screen->watch;
	struct ows_daemon daemon = {0};
	int64_t now = ows_now();
	char text[640], end[400], span[WHEN_TEXT], clock[16] = "", alarms[32] = "";
	time_t wall = time(NULL);
	struct tm local;

	ows_daemon(watch->h, now, &daemon);
	if (localtime_r(&wall, &local))
		strftime(clock, sizeof(clock), "%H:%M:%S", &local);
	if (screen->alarms)
		snprintf(alarms, sizeof(alarms), ", %d in alarm", screen->in_alarm);
	head_end(screen, now - daemon.start_ns, end, sizeof(end));
	if (daemon.alive)
		snprintf(text, sizeof(text), "%s  %s  %d signal%s, %d not good%s  %s",
		         watch->ctl->instance, clock, watch->rows.count,
		         watch->rows.count == 1 ? "" : "s", screen->not_good, alarms, end);
	else if (daemon.state == 3)
		snprintf(text, sizeof(text), "%s  %s  owsd was stopped", watch->ctl->instance,
		         clock);
	else
		snprintf(text, sizeof(text), "%s  %s  owsd is not running: last heartbeat %s ago",
		         watch->ctl->instance, clock, whole_seconds(daemon.beat_age_ns, span));
	put_line(out, screen, daemon.alive ? "" : "\033[7m", text);
}

static void watch_screen_add_row(struct watch *watch, struct table *table, const struct row *row)
{
	const struct reading *reading = watch->reading;
	char value[64], words[READING_WORDS], alarm[STANDING_WORDS], span[WHEN_TEXT] = "-";
	struct ows_target target = {.name = "-"};

	row_show(row, reading, value, sizeof(value));
	if (reading->value.measured_ns)
		whole_seconds(reading->value.age_ns, span);
	if (row->path)
		ows_target(watch->h, reading->value.target, &target);
	table_add(table, (const char *const[]){row->name, value, row_unit(row),
	                                       row_quality(row, reading, words),
	                                       standing_text(&row->alarms, alarm), span,
	                                       row->path ? row->path : "", target.name});
}

/* Red for a value that is not good, yellow for an alarm to acknowledge; the words state both. */
static const char *style_of(const struct row *row, const struct reading *reading)
{
	if (getenv("NO_COLOR"))
		return "";
	return !reading_good(reading)              ? "\033[31m"
	       : standing_wants_eyes(&row->alarms) ? "\033[33m"
	                                           : "";
}

/* The target of the rows so far, if all have the same one; -1: none yet, -2: several. */
static int same_target(struct ows *h, int so_far, const struct row *row,
                       const struct reading *reading)
{
	struct ows_target target;
	int this = reading->value.target;

	if (!row->path || so_far == -2 || ows_target(h, this, &target))
		return so_far;
	return so_far == -1 || so_far == this ? this : -2;
}

static bool is_sought(const struct screen *screen, const struct row *row)
{
	return !*screen->search || strcasestr(row->name, screen->search) ||
	       (row->path && strcasestr(row->path, screen->search));
}

/* What rows are sorted by: bad ones first, then those in alarm; then name, age or the file. */
struct sorted {
	int row, rank;
	const char *name;
	int64_t age_ns;
};

static int compare_rows(const void *a, const void *b)
{
	const struct sorted *x = a, *y = b;
	int names = x->name && y->name ? strcmp(x->name, y->name) : 0;

	if (x->rank != y->rank)
		return x->rank - y->rank;
	if (x->age_ns != y->age_ns)
		return x->age_ns > y->age_ns ? -1 : 1;
	return names ? names : x->row - y->row;
}

/* Read all rows: which are shown, in which order, and what the head line says of all. */
static void survey(struct screen *screen, struct table *table)
{
	struct watch *watch = screen->watch;
	size_t room = (size_t)watch->rows.count + 1;
	struct sorted *sorted = ctl_need(calloc(room, sizeof(*sorted)));
	int64_t now = ows_now();
	struct ows_target target;
	int served = -1;

	screen->order = ctl_need(realloc(screen->order, room * sizeof(*screen->order)));
	screen->count = screen->not_good = screen->in_alarm = 0;
	screen->alarms = false;
	for (int i = 0; i < watch->rows.count; i++) {
		struct row *row = &watch->rows.row[i];
		bool good, alarm;

		row_read(watch->h, row, now, watch->reading);
		reading_round(watch->reading, row_decimals(row));
		good = reading_good(watch->reading);
		alarm = standing_any(&row->alarms);
		screen->not_good += !good;
		screen->in_alarm += alarm;
		screen->alarms |= standing_possible(&row->alarms);
		served = same_target(watch->h, served, row, watch->reading);
		if (row_changed(row, watch->reading) && watch->left > 0)
			watch->left--;
		if (is_sought(screen, row))
			sorted[screen->count++] = (struct sorted){
				.row = i,
				.rank = !screen->bad_first ? 0
			                : !good            ? 0
			                : alarm            ? 1
			                                   : 2,
				.name = screen->sort == SORT_NAME ? row->name : NULL,
				.age_ns = screen->sort == SORT_AGE ? watch->reading->value.age_ns
			                                           : 0,
			};
	}
	qsort(sorted, (size_t)screen->count, sizeof(*sorted), compare_rows);
	for (int i = 0; i < screen->count; i++)
		screen->order[i] = sorted[i].row;
	snprintf(screen->target, sizeof(screen->target), "%s",
	         served >= 0 && ows_target(watch->h, served, &target) == 0 ? target.name : "");
	table->absent[UNIT] = !rows_have_units(&watch->rows);
	table->absent[ALARM] = !screen->alarms;
	table->absent[TARGET] = screen->target[0] != '\0';
	free(sorted);
}

static void watch_screen_fill(struct screen *screen, struct table *table, const char **styles)
{
	struct watch *watch = screen->watch;
	int shown = room(screen);
	int64_t now = ows_now();

	for (int i = screen->top; i < screen->count && i < screen->top + shown; i++) {
		struct row *row = &watch->rows.row[screen->order[i]];

		row_read(watch->h, row, now, watch->reading);
		reading_round(watch->reading, row_decimals(row));
		styles[i - screen->top] = style_of(row, watch->reading);
		watch_screen_add_row(watch, table, row);
	}
}

static void put_foot(FILE *out, struct screen *screen, int last)
{
	static const char *const sorts[] = {"", "; by name", "; by age"};
	char text[200];

	if (screen->typing)
		snprintf(text, sizeof(text), "/%s", screen->search);
	else
		snprintf(text, sizeof(text),
		         "%d to %d of %d%s%s%s%s; / searches, s sorts, ! bad first, q ends",
		         screen->top + (last > screen->top), last, screen->count,
		         *screen->search ? " with " : "", screen->search, sorts[screen->sort],
		         screen->bad_first ? "; bad first" : "");
	while (screen->line + 1 < screen->lines)
		put_line(out, screen, "", "");
	put_line(out, screen, screen->typing ? "" : "\033[2m", text);
}

static void put_rows(FILE *out, struct screen *screen, struct table *table,
                     const char *const *styles)
{
	char line[2048];

	memcpy(table->least, screen->least, sizeof(screen->least));
	table_fit(table, screen->width);
	for (unsigned i = 0; i < COLUMNS; i++)
		screen->least[i] = table->natural[i];
	if (screen->lines > 1) {
		table_line(table, -1, line, sizeof(line));
		put_line(out, screen, "\033[1m", line);
	}
	for (int i = 0; i < (int)table->rows; i++) {
		table_line(table, i, line, sizeof(line));
		put_line(out, screen, styles[i], line);
	}
	if (has_foot(screen) && screen->lines > 2)
		put_foot(out, screen, screen->top + (int)table->rows);
	while (screen->line < screen->lines)
		put_line(out, screen, "", "");
}

/* One picture, written at once; false: the terminal is gone. */
static bool draw(struct screen *screen)
{
	char *text = NULL;
	size_t len = 0;
	FILE *out = ctl_need(open_memstream(&text, &len));
	const char **styles = ctl_need(calloc(screen->lines + 1, sizeof(*styles)));
	struct table table;
	bool written;

	table_init(&table, columns, COLUMNS);
	screen->line = 0;
	survey(screen, &table);
	keep_top_in_range(screen);
	put_head(out, screen);
	watch_screen_fill(screen, &table, styles);
	put_rows(out, screen, &table, styles);
	if (fclose(out) != 0)
		ctl_need(NULL);
	written = terminal_write(text, len);
	table_free(&table);
	free(styles);
	free(text);
	return written;
}

/* Returns false to end. */
static bool on_key(struct screen *screen, enum terminal_key key)
{
	switch (key) {
	case KEY_END:
		return false;
	case KEY_UP:
		screen->top--;
		break;
	case KEY_DOWN:
		screen->top++;
		break;
	case KEY_PAGE_UP:
		screen->top -= room(screen);
		break;
	case KEY_PAGE_DOWN:
		screen->top += room(screen);
		break;
	case KEY_FIRST:
		screen->top = 0;
		break;
	case KEY_LAST:
		screen->top = screen->count;
		break;
	case KEY_SEARCH:
		screen->typing = true;
		screen->search[0] = '\0';
		break;
	case KEY_SORT:
		screen->sort = (screen->sort + 1) % SORTS;
		break;
	case KEY_BAD_FIRST:
		screen->bad_first = !screen->bad_first;
		screen->top = 0;
		break;
	case KEY_NONE:
	case KEY_OTHER:
		break;
	}
	keep_top_in_range(screen);
	return true;
}

/* A byte of the search; Enter ends it, and Esc takes it back. */
static void on_byte(struct screen *screen, char byte)
{
	size_t len = strlen(screen->search);

	if (byte == '\r' || byte == '\n' || byte == '\033') {
		screen->typing = false;
		if (byte == '\033')
			screen->search[0] = '\0';
	} else if (byte == 0x7f || byte == '\b') {
		screen->search[len ? len - 1 : 0] = '\0';
	} else if (byte > ' ' && len + 1 < sizeof(screen->search)) {
		screen->search[len] = byte;
		screen->search[len + 1] = '\0';
	}
	screen->top = 0;
}

/* All that was typed. 0; 1: something was; -1: the user ends it. */
static int take_keys(struct screen *screen)
{
	int pressed = 0;

	for (;;) {
		enum terminal_key key;
		char byte;

		if (screen->typing) {
			byte = terminal_byte();
			if (!byte)
				return pressed;
			on_byte(screen, byte);
		} else {
			key = terminal_key();
			if (key == KEY_NONE)
				return pressed;
			if (!on_key(screen, key))
				return -1;
		}
		pressed = 1;
	}
}

static void on_event(struct screen *screen, enum watch_event event)
{
	switch (event) {
	case WATCH_NOTHING:
		return;
	case WATCH_RESTARTED:
	case WATCH_RELOADED:
		memset(screen->least, 0, sizeof(screen->least));
		screen->note = event == WATCH_RELOADED ? "owsd has reloaded its file"
		                                       : "owsd was started again";
		return;
	case WATCH_LOST:
		screen->note = "";
		return;
	case WATCH_BACK:
		screen->note = "owsd is back";
		return;
	}
}

static void watch_screen_run(struct screen *screen)
{
	int64_t drawn = 0;
	uint32_t news = 0;

	for (;;) {
		enum watch_event event;
		int64_t now;
		int pressed;

		terminal_suspend_if_asked();
		if (terminal_size(&screen->lines, &screen->width)) {
			memset(screen->least, 0, sizeof(screen->least));
			forget_lines(screen);
			drawn = 0;
		}
		pressed = take_keys(screen);
		if (pressed < 0)
			return;
		now = ows_now();
		if (pressed || drawn == 0 || now - drawn >= LONGEST_PICTURE ||
		    (news != screen->watch->news && now - drawn >= BETWEEN_PICTURES)) {
			news = screen->watch->news;
			if (!draw(screen))
				return;
			drawn = now;
		}
		if (watch_over(screen->watch))
			return;
		event = watch_sleep(screen->watch, BETWEEN_KEYS, BETWEEN_KEYS);
		if (event != WATCH_NOTHING) {
			on_event(screen, event);
			drawn = 0;
		}
	}
}

void watch_screen(struct watch *watch)
{
	struct screen screen = {.watch = watch, .note = ""};

	terminal_open();
	watch_screen_run(&screen);
	terminal_close();
	screen.lines = 0;
	forget_lines(&screen);
	free(screen.before);
	free(screen.order);
}
