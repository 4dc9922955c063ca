/* SPDX-License-Identifier: MIT */
/* Prints what an instance has as metrics. */
#include <errno.h>
#include <inttypes.h>
#include <string.h>

#include "src/faces/show/metrics.h"
#include "src/faces/show/names.h"
#include "src/faces/show/newest.h"
#include "src/faces/show/present.h"
#include "src/faces/show/stats.h"
#include "src/faces/show/when.h"
#include "src/ground/signal/utf8.h"
#include "src/ground/signal/value.h"

struct print {
	FILE *out;
	const struct metrics *metrics;
	struct when now;
};

/* A family of metrics begins; its samples follow. */
static void begin_family(const struct print *p, const char *name, const char *type,
                         const char *help)
{
	fprintf(p->out, "# TYPE %s %s\n# HELP %s %s\n", name, type, name, help);
}

static void put_label(const struct print *p, const char *name, const char *text)
{
	size_t len = strlen(text);

	fprintf(p->out, "%s=\"", name);
	while (len > 0) {
		const char *at = text;
		int32_t c = utf8_next(&text, &len);

		if (c == '\n')
			fputs("\\n", p->out);
		else if (c == '"' || c == '\\')
			fprintf(p->out, "\\%c", (char)c);
		else if (c < 0x20 || utf8_disturbs(c))
			fputs("\xef\xbf\xbd", p->out);
		else
			fwrite(at, 1, (size_t)(text - at), p->out);
	}
	putc('"', p->out);
}

static void next_label(const struct print *p, const char *name, const char *text)
{
	putc(',', p->out);
	put_label(p, name, text);
}

/* The start of a sample: its name and the label of owsd, and the brace stays open. */
static void begin_sample(const struct print *p, const char *name)
{
	fprintf(p->out, "%s{", name);
	put_label(p, "owsd", p->metrics->instance);
}

static void end_sample(const struct print *p, const char *value)
{
	fprintf(p->out, "} %s\n", value);
}

static void end_seconds(const struct print *p, int64_t ns)
{
	fprintf(p->out, "} %" PRId64 ".%03d\n", ns / 1000000000, (int)(ns % 1000000000 / 1000000));
}

/* us: the value is in microseconds, and is shown in seconds. */
static void end_count(const struct print *p, uint64_t value, bool us)
{
	if (us)
		fprintf(p->out, "} %" PRIu64 ".%06u\n", value / 1000000,
		        (unsigned)(value % 1000000));
	else
		fprintf(p->out, "} %" PRIu64 "\n", value);
}

enum what { VALUE, QUALITY, AGE, SIMULATED, ALARM, UNARMED, WHATS };
static const struct {
	const char *name, *help;
} whats[] = {
	[VALUE] = {"ows_value", "The value of a signal in its unit. Absent unless it is good."},
	[QUALITY] = {"ows_quality",
                     "The OPC quality of a signal, 0 to 255. From 192 on it is good."},
	[AGE] = {"ows_age_seconds",
                 "The time since a signal was measured. Absent if it never was."},
	[SIMULATED] = {"ows_simulated",
                       "1 for a signal whose value is simulated. Absent for others."},
	[ALARM] = {"ows_alarm", "1 while an alarm of a signal stands. Absent if it can have none."},
	[UNARMED] = {"ows_alarm_unarmed",
                     "1 while the alarm of a device can do nothing. Absent of others."},
};

/* The value of a sample; false: the signal has no such sample. */
static bool sample_of(const struct print *p, int signal, const struct ows_info *info,
                      enum what what, char text[VALUE_TEXT_MAX], int64_t *seconds_ns)
{
	struct ows *h = p->metrics->h;
	struct face_value value;
	struct ows_alarm_state alarms;

	face_value(h, signal, !p->metrics->lost, p->now.boot, &value);
	switch (what) {
	case VALUE:
		if (!value.good || value.v.type == OWS_STRING)
			return false;
		snprintf(text, VALUE_TEXT_MAX, "%s", face_value_text(&value));
		return true;
	case QUALITY:
		snprintf(text, VALUE_TEXT_MAX, "%u", value.v.quality);
		return true;
	case AGE:
		*seconds_ns = value.v.age_ns;
		return value.v.measured_ns != 0;
	case SIMULATED:
		snprintf(text, VALUE_TEXT_MAX, "1");
		return value.simulated;
	case ALARM:
		alarms = standing_of(h, ows_find(h, info->name));
		snprintf(text, VALUE_TEXT_MAX, "%d", standing_any(&alarms));
		return standing_possible(&alarms);
	case UNARMED:
		alarms = standing_of(h, ows_find(h, info->name));
		snprintf(text, VALUE_TEXT_MAX, "%d", alarms.unarmed != 0);
		return alarms.item;
	case WHATS:
		break;
	}
	return false;
}

static void print_signal(const struct print *p, int signal, enum what what)
{
	const struct metrics *m = p->metrics;
	char text[VALUE_TEXT_MAX];
	int64_t seconds_ns = -1;
	struct ows_info info;

	if (ows_info(m->h, signal, &info) || !names_match(info.name, m->patterns, m->pattern_count))
		return;
	if (!sample_of(p, signal, &info, what, text, &seconds_ns))
		return;
	begin_sample(p, whats[what].name);
	next_label(p, "signal", info.name);
	if (*info.device)
		next_label(p, "device", info.device);
	if (*info.unit)
		next_label(p, "unit", info.unit);
	if (what == AGE)
		end_seconds(p, seconds_ns);
	else
		end_sample(p, text);
}

static void print_targets(const struct print *p)
{
	struct ows_daemon daemon = {0};
	struct ows_target target;
	bool alive;

	ows_daemon(p->metrics->h, p->now.boot, &daemon);
	alive = daemon.alive && !p->metrics->lost;
	begin_family(p, "ows_target_up", "gauge", "1 while a target is up.");
	for (int i = 0; ows_target(p->metrics->h, i, &target) == 0; i++) {
		begin_sample(p, "ows_target_up");
		next_label(p, "target", target.name);
		end_sample(p, alive && target.state == 1 ? "1" : "0");
	}
}

/* Is the counter the first of its name? Those of all targets are one family. */
static bool is_first(struct ows *h, int index, const char *name)
{
	struct ows_counter other;

	for (int i = 0; i < index && ows_counter(h, i, &other) == 0; i++)
		if (strcmp(other.name, name) == 0)
			return false;
	return true;
}

/* A name that ends in _us counts microseconds; OpenMetrics counts seconds. */
static void print_counters(const struct print *p)
{
	struct ows *h = p->metrics->h;
	char name[128], whole[144];
	struct ows_counter counter, same;
	struct ows_target target;

	for (int i = 0; ows_counter(h, i, &counter) == 0; i++) {
		size_t len = strlen(counter.name);
		bool us = len > 3 && strcmp(counter.name + len - 3, "_us") == 0;

		if (!is_first(h, i, counter.name))
			continue;
		snprintf(name, sizeof(name), "ows_%.*s%s", (int)(us ? len - 3 : len), counter.name,
		         us ? "_seconds" : "");
		snprintf(whole, sizeof(whole), "%s_total", name);
		begin_family(p, p->metrics->prometheus ? whole : name, "counter",
		             "A counter of owsctl stats.");
		for (int j = i; ows_counter(h, j, &same) == 0; j++) {
			if (strcmp(same.name, counter.name) != 0)
				continue;
			begin_sample(p, whole);
			if (ows_target(h, same.target, &target) == 0)
				next_label(p, "target", target.name);
			end_count(p, same.value, us);
		}
	}
}

enum device_what { DEVICE_ANSWERS, DEVICE_ERRORS, DEVICE_RETRIES, DEVICE_WIRE, DEVICE_WHATS };
static const struct {
	const char *name, *help;
} device_whats[] = {
	[DEVICE_ANSWERS] = {"ows_device_answers",
                            "What its target answered for a device, errors too."},
	[DEVICE_ERRORS] = {"ows_device_errors", "Requests for a device that failed."},
	[DEVICE_RETRIES] = {"ows_device_retries",
                            "How often its target asked a device again. Absent if not known."},
	[DEVICE_WIRE] = {"ows_device_wire_seconds",
                         "What requests for a device took of the wire. Absent if not known."},
};

static int device_count(struct ows *h)
{
	struct ows_device device;
	int count = 0;

	while (ows_device(h, count, &device) != -ENOENT)
		count++;
	return count;
}

static void print_device(const struct print *p, int index, enum device_what what)
{
	struct ows_device device;
	char whole[64];

	if (ows_device(p->metrics->h, index, &device) != 0 ||
	    (what >= DEVICE_RETRIES && !stats_device_costs(&device)))
		return;
	snprintf(whole, sizeof(whole), "%s_total", device_whats[what].name);
	begin_sample(p, whole);
	next_label(p, "device", device.id);
	end_count(p,
	          what == DEVICE_ANSWERS   ? device.answers
	          : what == DEVICE_ERRORS  ? device.errors
	          : what == DEVICE_RETRIES ? device.retries
	                                   : device.wire_us,
	          what == DEVICE_WIRE);
}

/* As metrics_print(); *at is first before the first part. */
static bool print_devices(const struct print *p, int first, int *at, int most)
{
	int devices = device_count(p->metrics->h), done = *at - first;

	if (devices == 0)
		return false;
	for (; done < DEVICE_WHATS * devices && most > 0; done++, most--) {
		enum device_what what = (enum device_what)(done / devices);
		char whole[64];

		snprintf(whole, sizeof(whole), "%s%s", device_whats[what].name,
		         p->metrics->prometheus ? "_total" : "");
		if (done % devices == 0)
			begin_family(p, whole, "counter", device_whats[what].help);
		print_device(p, done % devices, what);
	}
	*at = first + done;
	return done < DEVICE_WHATS * devices;
}

static void print_daemon(const struct print *p)
{
	struct ows_daemon daemon = {0};
	struct ows_log_line refused;

	ows_daemon(p->metrics->h, p->now.boot, &daemon);
	begin_family(p, "ows_up", "gauge", "1 while owsd runs.");
	begin_sample(p, "ows_up");
	end_sample(p, daemon.alive && !p->metrics->lost ? "1" : "0");
	begin_family(p, "ows_reload_refused", "gauge",
	             "1 while owsd refuses its file and serves what it loaded before.");
	begin_sample(p, "ows_reload_refused");
	end_sample(p, ows_refused_reload(p->metrics->h, &refused) == 0 ? "1" : "0");
	begin_family(p, "ows_start_time_seconds", "gauge",
	             "When owsd started, in seconds since 1970.");
	begin_sample(p, "ows_start_time_seconds");
	end_seconds(p, p->now.wall - p->now.boot + daemon.start_ns);
}

bool metrics_print(FILE *out, const struct metrics *metrics, int *at, int most)
{
	const struct print print = {.out = out, .metrics = metrics, .now = when_now()};
	int count = ows_count(metrics->h);

	if (*at == 0)
		print_daemon(&print);
	for (; *at < WHATS * count && most > 0; (*at)++, most--) {
		enum what what = (enum what)(*at / count);

		if (*at % count == 0)
			begin_family(&print, whats[what].name, "gauge", whats[what].help);
		print_signal(&print, *at % count, what);
	}
	if (*at < WHATS * count)
		return true;
	if (print_devices(&print, WHATS * count, at, most))
		return true;
	print_targets(&print);
	print_counters(&print);
	if (!metrics->prometheus)
		fputs("# EOF\n", out);
	return false;
}
