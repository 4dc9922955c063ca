/* SPDX-License-Identifier: MIT */
/* The live table of owsctl watch on a terminal. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "hal/bus/time.h"
#include "src/owsctl/ctl.h"
#include "src/owsctl/table.h"
#include "src/owsctl/terminal.h"
#include "src/owsctl/watch_screen.h"
#include "src/show/text.h"

#define BETWEEN_KEYS (50 * NS_PER_MS)
#define BETWEEN_PICTURES (100 * NS_PER_MS)
#define LONGEST_PICTURE NS_PER_S /* ages grow without a wake-up */

static const struct table_column columns[] = {
	{"NAME"},
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
};

/* The rows that fit below the two head lines; one line stays free when not all rows fit. */
static int room(const struct screen *screen)
{
	int lines = (int)screen->lines - 2;

	if (screen->watch->rows.count > lines)
		lines--;
	return lines < 0 ? 0 : lines;
}

static void keep_top_in_range(struct screen *screen)
{
	int last = screen->watch->rows.count - room(screen);

	if (screen->top > last)
		screen->top = last;
	if (screen->top < 0)
		screen->top = 0;
}

static void put_line(FILE *out, const struct screen *screen, const char *style, const char *text)
{
	char cut[1024];

	text_clean(text, strlen(text), screen->width, cut, sizeof(cut));
	fprintf(out, "%s%s\033[0m\033[K", style, cut);
}

static void put_head(FILE *out, const struct screen *screen)
{
	struct watch *watch = screen->watch;
	struct ows_daemon daemon = {0};
	int64_t now = ows_now();
	char text[512], span[WHEN_TEXT], clock[16] = "", alarms[32] = "";
	time_t wall = time(NULL);
	struct tm local;

	ows_daemon(watch->h, now, &daemon);
	if (localtime_r(&wall, &local))
		strftime(clock, sizeof(clock), "%H:%M:%S", &local);
	if (screen->alarms)
		snprintf(alarms, sizeof(alarms), ", %d in alarm", screen->in_alarm);
	if (daemon.alive)
		snprintf(text, sizeof(text), "%s  %s  %d signal%s, %d not good%s  up %s%s%s%s%s",
		         watch->ctl->instance, clock, watch->rows.count,
		         watch->rows.count == 1 ? "" : "s", screen->not_good, alarms,
		         when_span(now - daemon.start_ns, span), *screen->note ? "  " : "",
		         screen->note, *screen->target ? "  " : "", screen->target);
	else if (daemon.state == 3)
		snprintf(text, sizeof(text), "%s  %s  owsd was stopped", watch->ctl->instance,
		         clock);
	else
		snprintf(text, sizeof(text), "%s  %s  owsd is not running: last heartbeat %s ago",
		         watch->ctl->instance, clock, when_span(daemon.beat_age_ns, span));
	put_line(out, screen, daemon.alive ? "" : "\033[7m", text);
}

static bool add_row(struct watch *watch, struct table *table, const struct row *row)
{
	const struct reading *reading = watch->reading;
	char value[64], words[READING_WORDS], alarm[STANDING_WORDS], span[WHEN_TEXT] = "-";
	struct ows_target target = {.name = "-"};

	reading_show(reading, value, sizeof(value));
	if (reading->value.measured_ns)
		when_span(reading->value.age_ns, span);
	if (row->path)
		ows_target(watch->h, reading->value.target, &target);
	return table_add(table, (const char *const[]){row->name, value, row_unit(row),
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

static bool fill(struct screen *screen, struct table *table, const char **styles)
{
	struct watch *watch = screen->watch;
	int shown = room(screen);
	int64_t now = ows_now();
	struct ows_target target;
	int served = -1;

	screen->not_good = screen->in_alarm = 0;
	screen->alarms = false;
	for (int i = 0; i < watch->rows.count; i++) {
		struct row *row = &watch->rows.row[i];

		row_read(watch->h, row, now, watch->reading);
		reading_round(watch->reading, row_decimals(row));
		screen->not_good += !reading_good(watch->reading);
		screen->in_alarm += standing_any(&row->alarms);
		screen->alarms |= standing_possible(&row->alarms);
		served = same_target(watch->h, served, row, watch->reading);
		if (row_changed(row, watch->reading) && watch->left > 0)
			watch->left--;
		if (i < screen->top || i >= screen->top + shown)
			continue;
		styles[i - screen->top] = style_of(row, watch->reading);
		if (!add_row(watch, table, row))
			return false;
	}
	snprintf(screen->target, sizeof(screen->target), "%s",
	         served >= 0 && ows_target(watch->h, served, &target) == 0 ? target.name : "");
	table->absent[UNIT] = !rows_have_units(&watch->rows);
	table->absent[ALARM] = !screen->alarms;
	table->absent[TARGET] = screen->target[0] != '\0';
	return true;
}

static void put_rows(FILE *out, struct screen *screen, struct table *table,
                     const char *const *styles)
{
	char line[2048], text[96];
	int count = screen->watch->rows.count, last;

	memcpy(table->least, screen->least, sizeof(screen->least));
	table_fit(table, screen->width);
	for (unsigned i = 0; i < COLUMNS; i++)
		screen->least[i] = table->natural[i];
	if (screen->lines > 1) {
		table_line(table, -1, line, sizeof(line));
		fputs("\r\n", out);
		put_line(out, screen, "\033[1m", line);
	}
	for (int i = 0; i < (int)table->rows; i++) {
		table_line(table, i, line, sizeof(line));
		fputs("\r\n", out);
		put_line(out, screen, styles[i], line);
	}
	last = screen->top + (int)table->rows;
	if (last - screen->top < count && screen->lines > 2) {
		snprintf(text, sizeof(text), "%d to %d of %d; arrows and page keys, q ends",
		         screen->top + (last > screen->top), last, count);
		fputs("\r\n", out);
		put_line(out, screen, "\033[2m", text);
	}
}

/* One picture, written at once. 0, -ENOMEM, -EPIPE. */
static int draw(struct screen *screen)
{
	char *text = NULL;
	size_t len = 0;
	FILE *out = open_memstream(&text, &len);
	const char **styles = calloc(screen->lines + 1, sizeof(*styles));
	struct table table;
	int err = -ENOMEM;

	table_init(&table, columns, COLUMNS);
	keep_top_in_range(screen);
	if (out && styles && fill(screen, &table, styles)) {
		fputs("\033[H", out);
		put_head(out, screen);
		put_rows(out, screen, &table, styles);
		fputs("\033[J", out);
		err = 0;
	}
	if (out && fclose(out) != 0)
		err = -ENOMEM;
	if (err == 0 && !terminal_write(text, len))
		err = -EPIPE;
	table_free(&table);
	free(styles);
	free(text);
	return err;
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
		screen->top = screen->watch->rows.count;
		break;
	case KEY_NONE:
	case KEY_OTHER:
		break;
	}
	keep_top_in_range(screen);
	return true;
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

static int run(struct screen *screen)
{
	int64_t drawn = 0;
	uint32_t news = 0;

	for (;;) {
		int64_t now;
		bool pressed = false;
		enum terminal_key key;
		int event, err;

		terminal_suspend_if_asked();
		if (terminal_size(&screen->lines, &screen->width)) {
			memset(screen->least, 0, sizeof(screen->least));
			drawn = 0;
		}
		while ((key = terminal_key()) != KEY_NONE) {
			pressed = true;
			if (!on_key(screen, key))
				return 0;
		}
		now = ows_now();
		if (pressed || drawn == 0 || now - drawn >= LONGEST_PICTURE ||
		    (news != screen->watch->news && now - drawn >= BETWEEN_PICTURES)) {
			news = screen->watch->news;
			err = draw(screen);
			if (err)
				return err == -EPIPE ? 0 : err;
			drawn = now;
		}
		if (watch_over(screen->watch))
			return 0;
		event = watch_sleep(screen->watch, BETWEEN_KEYS, BETWEEN_KEYS);
		if (event < 0)
			return event;
		if (event != WATCH_NOTHING) {
			on_event(screen, (enum watch_event)event);
			drawn = 0;
		}
	}
}

int watch_screen(struct watch *watch)
{
	struct screen screen = {.watch = watch, .note = ""};
	int err;

	terminal_open();
	err = run(&screen);
	terminal_close();
	return err ? ctl_fail("no memory") : CTL_DONE;
}
