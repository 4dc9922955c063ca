/* SPDX-License-Identifier: MIT */
/* Reads the signals of owsd in the guest and compares them with the truth. */
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "tests/kernel/endurance.h"

/*
 * A value is true if it was there up to so long before its time of measurement: a conversion, and
 * the slow machine of the rig.
 */
#define SLACK (3 * SECOND)
#define COUNTERS 512
/* So long between two looks: the machine of the rig stood still itself */
#define STOOD SECOND
/* A table that is being exchanged can be opened again */
#define EXCHANGE 5

static struct ows *reader, *control;
static int ids[SIGNALS], output, transactions[SIGNALS + 1];
static int64_t measured[SIGNALS];
static int64_t looked_ns, stood_until_ns;
static uint32_t generation;
static int32_t pid;
static uint64_t counted[COUNTERS];
static uint64_t looks, checked;

static struct ows *open_as(enum ows_mode mode)
{
	struct ows *h = NULL;
	int err = -1;

	for (int i = 0; i < 600 && err; i++) {
		err = ows_open("OWS", mode, &h);
		if (err)
			usleep(100000); /* pace */
	}
	return err ? NULL : h;
}

bool reader_open(void)
{
	char name[64];

	reader = open_as(OWS_READ);
	control = open_as(OWS_CONTROL);
	if (!reader || !control)
		return false;
	for (int i = 0; i < SIGNALS; i++) {
		ids[i] = ows_find(reader, signal_names[i]);
		snprintf(name, sizeof(name), "%s_TRANSACTIONS", signal_names[i]);
		transactions[i] = ows_find(reader, name);
	}
	transactions[SIGNALS] = ows_find(reader, "_TRANSACTIONS");
	output = ows_find(control, signal_names[RELAYS]);
	return true;
}

/* Every error but a table that was exchanged is one of ours. */
static bool get(int i, struct ows_value *value)
{
	int err = ows_get(reader, ids[i], ows_now(), value);

	if (err == -ESTALE) {
		ows_reopen(reader);
		err = ows_get(reader, ids[i], ows_now(), value);
	}
	if (err && err != -ESTALE)
		violated("%s cannot be read: %s", signal_names[i], strerror(-err));
	return !err || err == -ESTALE;
}

/*
 * What was on its way while owsd stood still is as old as its request: it may be true since then.
 * So may what the chip has that the wire feeds: nothing shows which of the conversions since its
 * last reading it has carried out, so that the reading is as old as the first.
 */
static int64_t true_until(int i, const struct ows_value *value, int64_t now)
{
	return i == COLD || value->measured_ns < stood_until_ns ? now : value->measured_ns;
}

static void check(int i, const struct ows_value *value, int64_t now)
{
	checked++;
	if (value->measured_ns > now || value->age_ns < 0)
		violated("%s is from the future", signal_names[i]);
	if (value->measured_ns < measured[i])
		violated("%s is older than it was", signal_names[i]);
	if (i < INPUTS && value->age_ns > STALE_AFTER + SECOND)
		violated("%s is good and %.1f s old", signal_names[i], (double)value->age_ns / 1e9);
	measured[i] = value->measured_ns;
	if (i < INPUTS &&
	    !truth_between(i, value->number, value->measured_ns - SLACK,
	                   true_until(i, value, now)) &&
	    violated("%s is good and false: %g, measured %.3f s ago", signal_names[i],
	             value->number, (double)value->age_ns / 1e9))
		truth_explain(i);
}

void reader_stood(void)
{
	stood_until_ns = ows_now();
}

void reader_look(void)
{
	struct ows_value value;

	if (looks++ && ows_now() - looked_ns > STOOD)
		reader_stood();
	looked_ns = ows_now();
	if (ows_beat(control, 60000) == -ESTALE)
		ows_reopen(control);
	for (int i = 0; i < SIGNALS; i++)
		if (get(i, &value) && ows_good(value.quality) && value.measured_ns)
			check(i, &value, ows_now());
}

bool reader_all_well(void)
{
	struct ows_value value;

	for (int i = 0; i < SIGNALS; i++) {
		if (!get(i, &value) || !ows_good(value.quality))
			return false;
		if (i < INPUTS && !truth_now(i, value.number))
			return false;
	}
	return true;
}

void reader_explain(void)
{
	struct ows_value value;

	for (int i = 0; i < SIGNALS; i++)
		if (get(i, &value))
			remark("%s: %g, %s, error %d, measured %.1f s ago", signal_names[i],
			       value.number, ows_quality_text(value.quality), value.err,
			       (double)value.age_ns / 1e9);
}

int reader_any_good(void)
{
	struct ows_value value;

	for (int i = 0; i < SIGNALS; i++)
		if (get(i, &value) && ows_good(value.quality))
			return i;
	return -1;
}

void reader_set_relays(unsigned pins)
{
	int64_t until = ows_now() + EXCHANGE * SECOND;
	int err = ows_set(control, output, pins, NULL);

	while (err == -ESTALE && ows_now() < until) {
		if (ows_reopen(control))
			usleep(10000); /* pace */
		err = ows_set(control, output, pins, NULL);
	}
	if (err)
		violated("relays cannot be set: %s", strerror(-err));
	else
		truth_relays(pins);
}

/* Read in this order a sum is never above its whole, however the counters go on meanwhile. */
static void sums(void)
{
	struct ows_counter counter;
	struct ows_value value;
	uint64_t sum = 0, all = 0, requests = 0;

	for (int i = 0; i < SIGNALS; i++) {
		if (ows_get(reader, transactions[i], ows_now(), &value))
			return;
		sum += (uint64_t)value.integer;
	}
	if (ows_get(reader, transactions[SIGNALS], ows_now(), &value))
		return;
	all = (uint64_t)value.integer;
	for (int i = 0; ows_counter(reader, i, &counter) == 0; i++)
		if (strcmp(counter.name, "requests") == 0)
			requests += counter.value;
	if (sum > all || all > requests)
		violated("counters: %llu of the signals, %llu ended, %llu begun",
		         (unsigned long long)sum, (unsigned long long)all,
		         (unsigned long long)requests);
}

static bool never(const char *name)
{
	return strcmp(name, "refused_commands") == 0 || strcmp(name, "failed_stores") == 0 ||
	       strcmp(name, "unknown_answers") == 0 || strcmp(name, "served_garbage") == 0 ||
	       strcmp(name, "served_refused_errors") == 0;
}

void reader_counters(void)
{
	struct ows_counter counter;
	struct ows_daemon daemon;

	ows_daemon(reader, ows_now(), &daemon);
	if (daemon.state != 1)
		return;
	if (daemon.pid != pid || daemon.generation != generation)
		memset(counted, 0, sizeof(counted));
	pid = daemon.pid;
	generation = daemon.generation;
	for (int i = 0; i < COUNTERS && ows_counter(reader, i, &counter) == 0; i++) {
		if (counter.value < counted[i])
			violated("counter %s went back from %llu to %llu", counter.name,
			         (unsigned long long)counted[i], (unsigned long long)counter.value);
		if (counter.value && !counted[i] && never(counter.name))
			violated("counter %s: %llu", counter.name,
			         (unsigned long long)counter.value);
		counted[i] = strcmp(counter.name, "served_clients") == 0 ? 0 : counter.value;
	}
	sums();
}

uint64_t reader_looks(void)
{
	return looks;
}

uint64_t reader_checked(void)
{
	return checked;
}
