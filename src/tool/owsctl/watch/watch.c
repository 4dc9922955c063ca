/* SPDX-License-Identifier: MIT */
/* owsctl watch: follows signals over changes and restarts, as lines or as a live table. */
#include <getopt.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "hal/base/time.h"
#include "src/faces/show/text.h"
#include "src/tool/owsctl/ctl.h"
#include "src/tool/owsctl/verbs.h"
#include "src/tool/owsctl/watch/terminal.h"
#include "src/tool/owsctl/watch/watch_screen.h"

#define LONGEST_SLEEP (500 * NS_PER_MS) /* an age sends no wake-up, nor does a closed pipe */

static void print_event(struct watch *watch, const struct watch_event *event)
{
	char text[WHEN_TEXT];
	struct when now = when_now();
	struct json json;

	if (watch->ctl->json) {
		json_open(&json, stdout);
		json_object(&json, NULL);
		json_string(&json, "time", when_iso(&now, now.boot, text));
		json_string(&json, "event", event->word);
		json_uint(&json, "generation", watch->generation);
		json_object_end(&json);
		json_end(&json);
	} else if (!*event->told) {
		ctl_alive(watch->ctl, watch->h, ows_now());
	} else {
		ctl_tell("owsd %s %s", watch->ctl->instance, event->told);
	}
}

static void print_change(struct watch *watch, const struct row *row, const struct when *now)
{
	const struct reading *reading = watch->reading;
	char text[WHEN_TEXT], words[READING_WORDS], alarm[STANDING_WORDS], name[256];
	struct json json;

	json_open(&json, stdout);
	if (watch->ctl->json) {
		json_object(&json, NULL);
		json_string(&json, "time", when_iso(now, now->boot, text));
		row_json(&json, watch->h, row, now->boot);
		reading_json(&json, watch->h, reading, now);
		json_object_end(&json);
		json_end(&json);
		return;
	}
	text_clean(row->name, strlen(row->name), sizeof(name), name, sizeof(name));
	printf("%s %s ", when_iso(now, now->boot, text), name);
	if (row_filled(row, reading) && reading->value.type == OWS_STRING)
		json_bytes(&json, NULL, reading->text, reading->len);
	else
		fputs(row_filled(row, reading) ? reading->text : "-", stdout);
	printf(" %s", reading_quality(reading, words));
	if (standing_any(&row->alarms))
		printf("; alarm: %s", standing_text(&row->alarms, alarm));
	putchar('\n');
}

static void print_changes(struct watch *watch)
{
	struct when now = when_now();

	for (int i = 0; i < watch->rows.count && watch->left != 0; i++) {
		struct row *row = &watch->rows.row[i];

		row_read(watch->h, row, now.boot, watch->reading);
		if (!watch->ctl->json)
			reading_round(watch->reading, row_decimals(row));
		if (!row_changed(row, watch->reading))
			continue;
		print_change(watch, row, &now);
		watch->left -= watch->left > 0;
	}
}

static void watch_lines(struct watch *watch)
{
	const struct watch_event *event = watch->alive ? NULL : &watch_lost;

	/* write round by round, so that errno shows why a write failed */
	setvbuf(stdout, NULL, _IOFBF, BUFSIZ);
	for (;;) {
		if (event)
			print_event(watch, event);
		print_changes(watch);
		if (watch_over(watch) || !ctl_flush_lines() || ctl_reader_gone())
			return;
		event = watch_sleep(watch, LONGEST_SLEEP);
	}
}

/* A terminal that knows no escape sequences gets lines, as a pipe does. */
static bool has_screen(void)
{
	const char *term = getenv("TERM");

	return isatty(STDOUT_FILENO) && (!term || strcmp(term, "dumb") != 0);
}

int verb_watch(struct ctl *ctl, int argc, char **argv)
{
	static struct reading reading;
	struct watch watch = {.ctl = ctl, .left = -1, .end_ns = INT64_MAX, .reading = &reading};
	struct ows_daemon daemon = {0};
	bool screen = has_screen();
	int64_t limit_ns = -1;
	int c, status;

	while ((c = ctl_option(ctl, argc, argv, "alc:t:")) != -1) {
		if (c == 'a')
			watch.driver = true;
		else if (c == 'l')
			screen = false;
		else if (c == 't')
			limit_ns = ctl_option_seconds(ctl, c);
		else if (!ctl_count(optarg, 1, INT64_MAX, &watch.left))
			return ctl_usage(ctl, "-c wants a number above 0, not %s",
			                 ctl_word(optarg));
	}
	watch.patterns = argv + optind;
	watch.pattern_count = argc - optind;
	watch.h = ctl_open(ctl, OWS_READ);
	if (limit_ns >= 0)
		watch.end_ns = ows_now() + limit_ns;
	ows_daemon(watch.h, ows_now(), &daemon);
	watch_collect(&watch, &daemon);
	status = rows_check(&watch.rows, watch.patterns, watch.pattern_count);
	terminal_catch_signals();
	if (!status && screen && !ctl->json)
		watch_screen(&watch);
	else if (!status)
		watch_lines(&watch);
	rows_free(&watch.rows);
	ows_close(watch.h);
	return status;
}
