/* SPDX-License-Identifier: MIT */
/*
 * owsctl stats: prints owsd's state, its targets, counters and devices, or the last ones of an owsd
 * that ended; and what its faces report.
 */
#include <errno.h>
#include <getopt.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#include "src/faces/show/faces.h"
#include "src/faces/show/stats.h"
#include "src/faces/show/when.h"
#include "src/tool/owsctl/ctl.h"
#include "src/tool/owsctl/table.h"
#include "src/tool/owsctl/verbs.h"

static void print_target(int index, const struct ows_target *target, bool several, bool alive,
                         unsigned served)
{
	printf("target %-4d %s: %s%s, %u reconnect%s", index, target->name, alive ? "" : "was ",
	       stats_target_state(target->state), (unsigned)target->reconnects,
	       target->reconnects == 1 ? "" : "s");
	if (several)
		printf(", wire %u, %u signal%s, %u move%s here", (unsigned)target->group, served,
		       served == 1 ? "" : "s", (unsigned)target->moves,
		       target->moves == 1 ? "" : "s");
	putchar('\n');
}

static void print_note(struct ows *h, int index, int64_t now_ns)
{
	struct ows_log_line note;
	char span[WHEN_TEXT];

	if (ows_target_note(h, index, &note) == 0)
		printf("%11s for %s: %s\n", "", when_span(now_ns - note.time_ns, span), note.text);
}

/* clang-format off */
static const struct table_column device_columns[] = {
	{"DEVICE"}, {"IDENTITY"}, {"HEALTH"}, {"POWER"}, {"TARGET", .right = true},
	{"REQUESTS", .right = true}, {"ERRORS", .right = true}, {"RETRIES", .right = true},
	{"WIRE", .right = true}, {"LAST", .right = true},
};
/* clang-format on */
#define DEVICE_COLUMNS (sizeof(device_columns) / sizeof(device_columns[0]))

/* What is not known is "-"; WIRE: of the time since owsd's start. */
static void add_device(struct table *table, const struct ows_device *device,
                       enum device_health health, int64_t uptime_ns, int64_t now_ns)
{
	char target[16] = "-", answers[24], errors[24], retries[24] = "-", wire[32] = "-",
	     last[WHEN_TEXT] = "-";
	const char *power = stats_power(device->power);

	if (device->target >= 0)
		snprintf(target, sizeof(target), "%d", device->target);
	snprintf(answers, sizeof(answers), "%" PRIu64, device->answers);
	snprintf(errors, sizeof(errors), "%" PRIu64, device->errors);
	if (stats_device_costs(device)) {
		snprintf(retries, sizeof(retries), "%" PRIu64, device->retries);
		snprintf(wire, sizeof(wire), "%.2f%%",
		         uptime_ns > 0 ? (double)device->wire_us * 1e5 / (double)uptime_ns : 0);
	}
	if (device->ok_ns)
		when_span(now_ns - device->ok_ns, last);
	table_add(table,
	          (const char *const[]){device->id, *device->identity ? device->identity : "-",
	                                health_word(health), power ? power : "-", target, answers,
	                                errors, retries, wire, last});
}

static void print_devices(struct ows *h, const struct ows_daemon *daemon, int64_t now_ns)
{
	struct ows_device device;
	struct table table;
	enum device_health *healths = stats_healths(h, now_ns);
	int err;

	table_init(&table, device_columns, DEVICE_COLUMNS);
	for (int i = 0; healths && (err = ows_device(h, i, &device)) != -ENOENT; i++)
		if (!err)
			add_device(&table, &device, healths[i], now_ns - daemon->start_ns, now_ns);
	free(healths);
	if (table.rows) {
		putchar('\n');
		table_print(&table, true);
	}
	table_free(&table);
}

static void print_faces(const char *instance, const struct when *now)
{
	struct faces_one faces[FACES_MOST];
	unsigned count = faces_read(instance, faces);
	char text[WHEN_TEXT];

	for (unsigned i = 0; i < count; i++) {
		const struct faces_one *face = &faces[i];

		printf("\n%s, pid %ld: %s\n", face->program, face->pid, face->status);
		if (faces_silent(face, now->boot))
			printf("%11s %s, %s ago\n", "silent", "its last report is below",
			       when_span(now->boot - face->beat_ns, text));
		if (face->since_ns)
			printf("%11s %s\n", "connected", when_iso(now, face->since_ns, text));
		if (*face->trouble && face->trouble_ns)
			printf("%11s %s ago: %s\n", "last error",
			       when_span(now->boot - face->trouble_ns, text), face->trouble);
		else if (*face->trouble)
			printf("%11s %s\n", "last error", face->trouble);
		if (*face->refused)
			printf("%11s its file: %s\n", "refused", face->refused);
		for (unsigned k = 0; k < face->count; k++)
			printf("%12" PRIu64 "  %s\n", face->counters[k].value,
			       face->counters[k].name);
	}
}

/*
 * Prints the counters that have counted, and those that are 0 to zeros. Each is read once: owsd may
 * count meanwhile, and a counter must stand in one of the two lists.
 */
static void print_counters(struct ows *h, FILE *zeros)
{
	struct ows_target target;
	struct ows_counter counter;

	for (int i = 0; ows_counter(h, i, &counter) == 0; i++) {
		bool own = ows_target(h, counter.target, &target) != 0;

		fprintf(counter.value ? stdout : zeros, "%12" PRIu64 "  %s%s%s\n", counter.value,
		        counter.name, own ? "" : " of ", own ? "" : target.name);
	}
}

static void print_text(const struct ctl *ctl, struct ows *h, const struct ows_daemon *daemon,
                       const struct when *now)
{
	char text[WHEN_TEXT], span[WHEN_TEXT], *last = NULL;
	unsigned served[STATS_TARGETS + 1];
	bool several;
	struct ows_target target;
	struct ows_log_line refused;
	size_t last_len;
	FILE *zeros = ctl_need(open_memstream(&last, &last_len));

	stats_served(h, now->boot, served);
	printf("instance    %s\n", ctl->instance);
	printf("owsd        pid %d, %s", (int)daemon->pid, stats_daemon_state(daemon));
	if (!daemon->alive)
		printf(" since %s; all below is what it was then",
		       when_iso(now, now->boot - daemon->beat_age_ns, text));
	putchar('\n');
	printf("started     %s, %s ago\n", when_iso(now, daemon->start_ns, text),
	       when_span(now->boot - daemon->start_ns, span));
	printf("generation  %u\n", (unsigned)daemon->generation);
	if (ows_refused_reload(h, &refused) == 0)
		printf("refused     a reload, %s ago: %s\n",
		       when_span(now->boot - refused.time_ns, span), refused.text);
	printf("period      %g s\n", (double)daemon->period_ns / 1e9);
	printf("heartbeat   %s ago\n", when_span(daemon->beat_age_ns, span));
	printf("signals     %d, %d not good\n", ows_count(h), stats_not_good(h, now->boot));
	if (ows_served(h))
		printf("served      %s\n", ows_served(h));
	several = ows_target(h, 1, &target) == 0;
	for (int i = 0; i < STATS_TARGETS && ows_target(h, i, &target) == 0; i++) {
		print_target(i, &target, several, daemon->alive, served[i]);
		print_note(h, i, now->boot);
	}
	print_counters(h, zeros);
	print_devices(h, daemon, now->boot);
	print_faces(ctl->instance, now);
	fclose(zeros);
	printf("\n%s", (const char *)ctl_need(last));
	free(last);
}

int verb_stats(struct ctl *ctl, int argc, char **argv)
{
	struct ows_daemon daemon = {0};
	struct json json;
	struct when now;
	struct ows *h;

	ctl_option(ctl, argc, argv, "");
	if (optind < argc)
		return ctl_usage(ctl, "stats takes no operands");
	h = ctl_open(ctl, OWS_READ);
	now = when_now();
	ows_daemon(h, now.boot, &daemon);
	ctl_alive(ctl, h, now.boot);
	if (ctl->json) {
		json_open(&json, stdout);
		json_object(&json, NULL);
		stats_json(&json, ctl->instance, h, &daemon, &now);
		json_object_end(&json);
		json_end(&json);
	} else {
		print_text(ctl, h, &daemon, &now);
	}
	ows_close(h);
	return CTL_DONE;
}
