/* SPDX-License-Identifier: MIT */
/*
 * owsctl stats: prints owsd's state, its targets and its counters, or the last ones of an owsd that
 * ended.
 */
#include <getopt.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "src/owsctl/ctl.h"
#include "src/owsctl/json.h"
#include "src/owsctl/verbs.h"
#include "src/owsctl/when.h"

static const char *daemon_state(const struct ows_daemon *daemon)
{
	switch (daemon->state) {
	case 1:
		return daemon->alive ? "live" : "dead";
	case 2:
		return "retired";
	case 3:
		return "stopped";
	}
	return "unknown";
}

static const char *target_state(uint32_t state)
{
	static const char *const names[] = {"down", "up", "suspended"};

	return state < 3 ? names[state] : "unknown";
}

/* Count the signals of the table that are not good. */
static int not_good(struct ows *h, int64_t now_ns)
{
	struct ows_value value;
	int count = 0;

	for (int i = 0; i < ows_count(h); i++)
		count += ows_get_signal(h, i, now_ns, &value) != 0 || !ows_good(value.quality);
	return count;
}

/* Print how many signals each target serves now. */
#define TARGETS 255
static void count_served(struct ows *h, int64_t now_ns, unsigned served[TARGETS + 1])
{
	struct ows_value value;

	memset(served, 0, (TARGETS + 1) * sizeof(*served));
	for (int i = 0; i < ows_count(h); i++)
		if (ows_get_signal(h, i, now_ns, &value) == 0 && value.target < TARGETS)
			served[value.target]++;
}

static void print_target(int index, const struct ows_target *target, bool several, bool alive,
                         unsigned served)
{
	printf("target %-4d %s: %s%s, %u reconnect%s", index, target->name, alive ? "" : "was ",
	       target_state(target->state), (unsigned)target->reconnects,
	       target->reconnects == 1 ? "" : "s");
	if (several)
		printf(", wire %u, %u signal%s, %u move%s here", (unsigned)target->group, served,
		       served == 1 ? "" : "s", (unsigned)target->moves,
		       target->moves == 1 ? "" : "s");
	putchar('\n');
}

static void print_json(const struct ctl *ctl, struct ows *h, const struct ows_daemon *daemon,
                       const struct when *now)
{
	char text[WHEN_TEXT];
	unsigned served[TARGETS + 1];
	struct ows_target target;
	struct ows_counter counter;
	struct json json;

	count_served(h, now->boot, served);
	json_open(&json, stdout);
	json_object(&json, NULL);
	json_string(&json, "instance", ctl->instance);
	json_object(&json, "daemon");
	json_int(&json, "pid", daemon->pid);
	json_string(&json, "state", daemon_state(daemon));
	json_bool(&json, "alive", daemon->alive);
	json_string(&json, "started", when_iso(now, daemon->start_ns, text));
	json_seconds(&json, "uptime", now->boot - daemon->start_ns);
	json_uint(&json, "generation", daemon->generation);
	json_seconds(&json, "period", daemon->period_ns);
	json_seconds(&json, "heartbeat_age", daemon->beat_age_ns);
	json_string(&json, "last_heartbeat", when_iso(now, now->boot - daemon->beat_age_ns, text));
	json_object_end(&json);
	json_int(&json, "signals", ows_count(h));
	json_int(&json, "not_good", not_good(h, now->boot));
	json_string(&json, "served", ows_served(h));
	json_array(&json, "targets");
	for (int i = 0; i < TARGETS && ows_target(h, i, &target) == 0; i++) {
		json_object(&json, NULL);
		json_string(&json, "name", target.name);
		json_string(&json, "state", daemon->alive ? target_state(target.state) : "unknown");
		json_string(&json, "last_state", target_state(target.state));
		json_uint(&json, "reconnects", target.reconnects);
		json_uint(&json, "wire", target.group);
		json_uint(&json, "signals", served[i]);
		json_uint(&json, "moves", target.moves);
		json_object_end(&json);
	}
	json_array_end(&json);
	json_array(&json, "counters");
	for (int i = 0; ows_counter(h, i, &counter) == 0; i++) {
		json_object(&json, NULL);
		json_string(&json, "name", counter.name);
		json_string(&json, "target",
		            ows_target(h, counter.target, &target) == 0 ? target.name : NULL);
		json_uint(&json, "value", counter.value);
		json_object_end(&json);
	}
	json_array_end(&json);
	json_object_end(&json);
	json_end(&json);
}

static void print_text(const struct ctl *ctl, struct ows *h, const struct ows_daemon *daemon,
                       const struct when *now)
{
	char text[WHEN_TEXT], span[WHEN_TEXT];
	unsigned served[TARGETS + 1];
	bool several;
	struct ows_target target;
	struct ows_counter counter;

	count_served(h, now->boot, served);
	printf("instance    %s\n", ctl->instance);
	printf("owsd        pid %d, %s", (int)daemon->pid, daemon_state(daemon));
	if (!daemon->alive)
		printf(" since %s; all below is what it was then",
		       when_iso(now, now->boot - daemon->beat_age_ns, text));
	putchar('\n');
	printf("started     %s, %s ago\n", when_iso(now, daemon->start_ns, text),
	       when_span(now->boot - daemon->start_ns, span));
	printf("generation  %u\n", (unsigned)daemon->generation);
	printf("period      %g s\n", (double)daemon->period_ns / 1e9);
	printf("heartbeat   %s ago\n", when_span(daemon->beat_age_ns, span));
	printf("signals     %d, %d not good\n", ows_count(h), not_good(h, now->boot));
	if (ows_served(h))
		printf("served      %s\n", ows_served(h));
	several = ows_target(h, 1, &target) == 0;
	for (int i = 0; i < TARGETS && ows_target(h, i, &target) == 0; i++)
		print_target(i, &target, several, daemon->alive, served[i]);
	for (int i = 0; ows_counter(h, i, &counter) == 0; i++) {
		bool own = ows_target(h, counter.target, &target) != 0;

		printf("%12" PRIu64 "  %s%s%s\n", counter.value, counter.name, own ? "" : " of ",
		       own ? "" : target.name);
	}
}

int verb_stats(struct ctl *ctl, int argc, char **argv)
{
	struct ows_daemon daemon = {0};
	struct when now;
	struct ows *h;
	int status;

	ctl_options();
	if (ctl_option(ctl, argc, argv, "") != -1)
		return CTL_USAGE;
	if (optind < argc)
		return ctl_usage(ctl, "stats takes no operands");
	status = ctl_open(ctl, OWS_READ, &h);
	if (status)
		return status;
	now = when_now();
	ows_daemon(h, now.boot, &daemon);
	ctl_alive(ctl, h, now.boot);
	if (ctl->json)
		print_json(ctl, h, &daemon, &now);
	else
		print_text(ctl, h, &daemon, &now);
	ows_close(h);
	return CTL_DONE;
}
