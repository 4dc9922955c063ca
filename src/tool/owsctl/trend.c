/* SPDX-License-Identifier: MIT */
/* owsctl trend: what signals had, drawn in the terminal, or each record in a line. */
#include <errno.h>
#include <getopt.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "src/faces/show/digits.h"
#include "src/faces/show/json.h"
#include "src/faces/show/text.h"
#include "src/faces/show/when.h"
#include "src/ground/signal/value.h"
#include "src/ground/text/influx.h"
#include "src/tool/owsctl/ctl.h"
#include "src/tool/owsctl/past.h"
#include "src/tool/owsctl/verbs.h"

#define SINCE "24h"
#define HEIGHT 8
#define WIDTH 64       /* where there is no terminal */
#define WIDTH_LEAST 34 /* of the two times below */
#define WIDTH_MOST 400
#define MARGIN 11 /* the numbers on the left */

struct trend {
	struct ctl *ctl;
	struct ows_history *h;
	struct when now;
	int64_t from_ns, until_ns; /* wall clock */
	bool csv, influx;
	unsigned left_out; /* good values that a line of InfluxDB cannot have */
	struct json json;
};

static const char *iso(const struct trend *t, int64_t wall_ns, char text[WHEN_TEXT])
{
	return when_iso(&t->now, t->now.boot - (t->now.wall - wall_ns), text);
}

static int columns(void)
{
	struct winsize size;
	int width = WIDTH + MARGIN;

	if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0)
		width = size.ws_col - 1;
	width -= MARGIN;
	return width < WIDTH_LEAST ? WIDTH_LEAST : width > WIDTH_MOST ? WIDTH_MOST : width;
}

/* The least and the greatest of all; false: there is no good value. */
static bool find_range(const struct ows_history_point *points, int n, double *low, double *high)
{
	*low = INFINITY;
	*high = -INFINITY;
	for (int i = 0; i < n; i++) {
		*low = fmin(*low, points[i].min);
		*high = fmax(*high, points[i].max);
	}
	return *low <= *high && isfinite(*low) && isfinite(*high);
}

/* Draw each column as a bar up to its greatest value, in eighths of a line. */
static void print_bars(const struct ows_history_point *points, int width, double low, double high)
{
	static const char *const eighths[] = {" ", "▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
	/* halves: the difference of two doubles may be none */
	double range = high / 2 - low / 2;

	for (int line = HEIGHT - 1; line >= 0; line--) {
		if (line == HEIGHT - 1 || (line == 0 && high > low))
			printf("%*.6g ", MARGIN - 1, line ? high : low);
		else
			printf("%*s", MARGIN, "");
		for (int i = 0; i < width; i++) {
			/* of unknown time it is not a number, which draws nothing */
			double height = points[i].max / 2 - low / 2;
			double part = range > 0 ? height / range : height + 0.5;
			double full = 1 + part * (HEIGHT * 8 - 1) - line * 8;

			fputs(eighths[full > 0 ? (int)fmin(full, 8) : 0], stdout);
		}
		putchar('\n');
	}
}

static void print_picture(const struct trend *t, const struct ows_history_signal *known,
                          const struct ows_history_point *points, int width)
{
	char from[WHEN_TEXT], until[WHEN_TEXT], name[256], unit[64];
	double low, high;

	text_clean(known->name, strlen(known->name), sizeof(name), name, sizeof(name));
	text_clean(known->unit, strlen(known->unit), sizeof(unit), unit, sizeof(unit));
	printf("%s%s%s%s\n", name, *unit ? " (" : "", unit, *unit ? ")" : "");
	if (!find_range(points, width, &low, &high)) {
		puts("  no good value in that time");
		return;
	}
	print_bars(points, width, low, high);
	printf("%*s", MARGIN, "");
	for (int i = 0; i < width; i++)
		fputs(points[i].good_ns > 0 ? "─" : points[i].known_ns > 0 ? "×" : " ", stdout);
	printf("\n%*s%.16s%*s%.16s\n", MARGIN, "", iso(t, points[0].from_ns, from), width - 32, "",
	       iso(t, points[width - 1].until_ns, until));
}

static int draw(struct trend *t, int signal, const struct ows_history_signal *known)
{
	struct ows_history_point points[WIDTH_MOST];
	int width = columns();
	int got = ows_history_points(t->h, signal, t->from_ns, t->until_ns, points, width);

	if (got >= 0)
		print_picture(t, known, points, width);
	return got < 0 ? past_fail(known->name, got) : CTL_DONE;
}

static void put_csv(const char *text, size_t len)
{
	putchar('"');
	for (size_t i = 0; i < len; i++) {
		if (text[i] == '"')
			putchar('"');
		putchar(text[i]);
	}
	putchar('"');
}

static void print_csv(const struct trend *t, const char *name, const struct ows_history_item *item)
{
	char when[WHEN_TEXT], text[VALUE_TEXT_MAX];

	printf("%s,", iso(t, item->time_ns, when));
	put_csv(name, strlen(name));
	putchar(',');
	if (item->known && item->type == OWS_STRING)
		put_csv(item->text, item->len);
	else if (item->known && ows_good(item->quality)) {
		digits_print((enum ows_type)item->type, item->number, item->integer, -1, text);
		fputs(text, stdout);
	}
	putchar(',');
	put_csv(past_word(item), strlen(past_word(item)));
	putchar('\n');
}

static void trend_print_json(struct trend *t, const struct ows_history_item *item)
{
	char when[WHEN_TEXT], text[VALUE_TEXT_MAX];

	json_object(&t->json, NULL);
	json_string(&t->json, "time", iso(t, item->time_ns, when));
	json_bool(&t->json, "known", item->known);
	if (item->known && item->type == OWS_STRING) {
		json_text(&t->json, item->text, item->len);
	} else if (item->known && ows_good(item->quality)) {
		digits_print((enum ows_type)item->type, item->number, item->integer, -1, text);
		json_number(&t->json, "value", text);
	} else {
		json_null(&t->json, "value");
	}
	json_string(&t->json, item->known ? "quality" : "reason", past_word(item));
	json_bool(&t->json, "clock", item->trusted);
	json_object_end(&t->json);
}

static void print_influx(struct trend *t, const char *series, const struct ows_history_item *item)
{
	char fields[INFLUX_FIELDS];

	if (!item->known || !ows_good(item->quality))
		return;
	if (influx_fields((enum ows_type)item->type, item->number, item->integer, item->text,
	                  item->len, fields))
		printf("%s %s %" PRId64 "\n", series, fields, item->time_ns);
	else
		t->left_out++;
}

/* Print each item of a signal. 0, or what is wrong. */
static int print_items(struct trend *t, int signal, const char *name, const char *series)
{
	struct ows_history_item item;
	int got = ows_history_read(t->h, signal, t->from_ns, t->until_ns);

	while (!got && (got = ows_history_next(t->h, &item, 1)) == 1) {
		if (t->ctl->json)
			trend_print_json(t, &item);
		else if (t->influx)
			print_influx(t, series, &item);
		else
			print_csv(t, name, &item);
		got = 0;
	}
	return got;
}

/* A value that is not good has no number here: it could be believed. */
static int trend_list(struct trend *t, int signal, const struct ows_history_signal *known)
{
	char series[INFLUX_SERIES];
	int err;

	if (t->influx && !influx_series(INFLUX_MEASUREMENT, known->identity, t->ctl->instance,
	                                known->name, known->unit, series))
		return ctl_fail("%s cannot be a tag of InfluxDB", known->name);
	if (t->ctl->json) {
		json_object(&t->json, NULL);
		json_string(&t->json, "name", known->name);
		json_string(&t->json, "unit", known->unit);
		json_array(&t->json, "records");
	}
	err = print_items(t, signal, known->name, series);
	if (t->ctl->json) {
		json_array_end(&t->json);
		json_object_end(&t->json);
	}
	return err < 0 ? past_fail(known->name, err) : CTL_DONE;
}

/* Is each record printed, rather than a picture? */
static bool lists(const struct trend *t)
{
	return t->csv || t->influx || t->ctl->json;
}

static int trend_show(struct trend *t, const char *name)
{
	struct ows_history_signal known = {.name = "", .unit = ""};
	int signal = past_signal(t->h, t->ctl->instance, name, &known);

	if (signal == -ENOENT)
		return past_unknown(t->ctl, t->h, name);
	if (signal < 0)
		return past_fail(ctl_word(name), signal);
	if (lists(t))
		return trend_list(t, signal, &known);
	if (known.type == OWS_STRING)
		return ctl_fail("%s is a text: --csv, --influx and --json have it", name);
	return draw(t, signal, &known);
}

static int show_all(struct trend *t, char **names, int count)
{
	int status = CTL_DONE;

	if (t->csv)
		puts("time,name,value,quality");
	json_list(&t->json, stdout, t->ctl->json);
	for (int i = 0; i < count; i++) {
		int one = trend_show(t, names[i]);

		status = one ? one : status;
		if (i + 1 < count && !lists(t))
			putchar('\n');
	}
	json_list_end(&t->json);
	if (t->left_out)
		ctl_fail("%u values are left out, which have line ends or are not finite: --csv "
		         "and --json have them",
		         t->left_out);
	return status;
}

int verb_trend(struct ctl *ctl, int argc, char **argv)
{
	struct trend t = {.ctl = ctl, .now = when_now()};
	const char *directory = NULL;
	int c, status;

	when_moment(&t.now, SINCE, &t.from_ns);
	t.until_ns = t.now.wall;
	while ((c = ctl_option(ctl, argc, argv, "s:u:d:CI")) != -1) {
		if (c == 'C')
			t.csv = true;
		else if (c == 'I')
			t.influx = true;
		else if (c == 'd')
			directory = optarg;
		else if (c == 's')
			t.from_ns = ctl_moment(ctl, c, &t.now);
		else
			t.until_ns = ctl_moment(ctl, c, &t.now);
	}
	if (optind == argc)
		return ctl_usage(ctl, "expected the name of a signal");
	if (t.from_ns >= t.until_ns)
		return ctl_usage(ctl, "the time has to begin before it ends");
	if (t.csv + t.influx + ctl->json > 1)
		return ctl_usage(ctl, "--csv, --influx and --json exclude each other");
	status = past_open(ctl, directory, &t.h);
	if (status)
		return status;
	status = show_all(&t, argv + optind, argc - optind);
	ows_history_close(t.h);
	return status;
}
