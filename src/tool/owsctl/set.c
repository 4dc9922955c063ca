/* SPDX-License-Identifier: MIT */
/* owsctl set: checks values, sets them, and waits until the bus has them. */
#include <errno.h>
#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/time.h"
#include "src/faces/kit/command.h"
#include "src/faces/show/actor.h"
#include "src/faces/show/names.h"
#include "src/faces/show/reading.h"
#include "src/ground/signal/value.h"
#include "src/tool/owsctl/ctl.h"
#include "src/tool/owsctl/verbs.h"

struct order {
	const char *name;
	const char *text;
	int id;
	enum attribute attribute;
	enum ows_type type;
	struct ows_info info; /* its name, and which values it takes */
	int64_t value;        /* numbers */
	uint32_t stamp;
	bool input; /* the value of one */
	bool confirmed;
};

static bool is_edge(enum attribute attribute)
{
	return attribute_table[attribute].writable && !attribute_table[attribute].readable;
}

/* In the words of all programs that command. Returns words. */
static const char *refusal_of(const struct order *order, int err, char words[FACE_REFUSAL])
{
	const struct face_command command = {.program = "owsctl", .text = order->text};

	return face_refusal(&command, &order->info, err, words);
}

/* Check all orders before the first value is set. */
static int check_order(const struct ctl *ctl, struct ows *h, struct order *order)
{
	struct ows_info *info = &order->info;
	const struct attribute_def *def;
	char words[FACE_REFUSAL];
	int signal, err;

	if (names_lookup(h, ctl->instance, order->name, &signal, &order->attribute) != 0)
		return ctl_unknown(h, order->name);
	order->id = ows_find(h, order->name);
	if (order->id < 0)
		return ctl_fail("%s: %s", order->name, error_text(order->id));
	def = &attribute_table[order->attribute];
	if (!def->writable)
		return ctl_fail("%s cannot be set, only read", order->name);
	*info = (struct ows_info){.type = (uint8_t)def->type, .min = NAN, .max = NAN};
	if (order->attribute == ATTR_VALUE) {
		if (ows_info(h, signal, info) != 0)
			return ctl_fail("%s is not there any more", order->name);
		order->input = !info->output;
	}
	info->name = order->name;
	order->type = (enum ows_type)info->type;
	if (order->type == OWS_STRING)
		return CTL_DONE;
	err = value_parse(order->type, order->text, &order->value);
	return err ? ctl_fail("%s: %s", order->name, refusal_of(order, err, words)) : CTL_DONE;
}

static int set_put(struct ows *h, struct order *order)
{
	if (order->type == OWS_STRING)
		return ows_set_text(h, order->id, order->text, &order->stamp);
	if (value_is_float(order->type))
		return ows_set(h, order->id, value_number(order->type, order->value),
		               &order->stamp);
	/* an edge is a change from 0, whatever this handle has set before */
	if (is_edge(order->attribute))
		ows_set_integer(h, order->id, 0, NULL);
	return ows_set_integer(h, order->id, order->value, &order->stamp);
}

static int set_send(struct ows *h, struct order *order)
{
	char words[FACE_REFUSAL];
	int err = set_put(h, order);

	/* owsd has just moved to new memory: set the value there */
	for (int i = 0; err == -ESTALE && i < 10; i++) {
		ctl_nap();
		if (ows_reopen(h) == 0)
			err = set_put(h, order);
	}
	if (err == -EACCES && order->input)
		return ctl_fail("%s is not writable: it is an input, and its _WriteEnable is 0",
		                order->name);
	return err ? ctl_fail("%s: %s", order->name, refusal_of(order, err, words)) : CTL_DONE;
}

/* Has the bus, or for the enables the engine, taken what was set, and does it read so? */
static bool is_confirmed(struct ows *h, struct order *order, struct reading *reading)
{
	if (order->confirmed || is_edge(order->attribute))
		return true;
	if (reading_get(h, order->id, ows_now(), reading) != 0)
		return false;
	if (order->attribute == ATTR_VALUE)
		order->confirmed = (int32_t)(reading->value.applied - order->stamp) >= 0 &&
		                   reading->value.quality != OWS_Q_DIFFERS;
	else
		order->confirmed = (reading->value.integer != 0) == (order->value != 0);
	return order->confirmed;
}

static bool all_confirmed(struct ows *h, struct order *orders, int count, struct reading *reading)
{
	bool all = true;

	for (int i = 0; i < count; i++)
		all &= is_confirmed(h, &orders[i], reading);
	return all;
}

static int set_await(struct ows *h, struct order *orders, int count, int64_t limit_ns,
                     struct reading *reading)
{
	const int64_t slice = 100 * NS_PER_MS;
	int64_t end = ows_now() + limit_ns;
	uint32_t news = 0;

	while (!all_confirmed(h, orders, count, reading)) {
		int64_t left = end - ows_now();

		if (left <= 0)
			return CTL_FAILED;
		ctl_sleep(h, &news, left < slice ? left : slice);
	}
	return CTL_DONE;
}

static bool write_disabled(struct ows *h, const struct order *order)
{
	char name[NAMES_MAX + 16];
	struct ows_value value;
	int id;

	snprintf(name, sizeof(name), "%s_WriteEnable", order->name);
	id = ows_find(h, name);
	return id >= 0 && ows_get(h, id, ows_now(), &value) == 0 && value.integer == 0;
}

/* If the signal is read with success, the error is that of the write. */
static const char *why_not(const struct reading *reading, char words[READING_WORDS])
{
	char own[ERROR_WORDS];

	if (!reading_good(reading) || !reading->value.err)
		return reading_why(reading, words);
	if (reading->value.err == -EACCES)
		return "it cannot be written";
	snprintf(words, READING_WORDS, "writing it fails: %s",
	         error_words(reading->value.err, own));
	return words;
}

/* Has owsd refused it, or another program commanded something else? True after printing that. */
static bool print_lost(struct ows *h, const struct order *order)
{
	struct ows_command command = {0};
	struct ows_origin origin = {0};
	char words[FACE_REFUSAL], who[ACTOR_LINE];

	if (order->attribute != ATTR_VALUE)
		return false;
	ows_command(h, order->id, &command);
	if (command.taken == order->stamp && command.refused) {
		ctl_fail("%s was refused: %s", order->name,
		         refusal_of(order, command.refused, words));
		return true;
	}
	ows_origin(h, order->id, &origin);
	if (origin.own || !origin.who.serial || (int32_t)(command.taken - order->stamp) < 0)
		return false;
	ctl_fail("%s was not confirmed: %s has set it since", order->name,
	         actor_line(&origin.who, who));
	return true;
}

static void print_why(struct ows *h, const struct order *order, const char *seconds,
                      struct reading *reading)
{
	char words[READING_WORDS];
	struct ows_daemon daemon = {0};

	ows_daemon(h, ows_now(), &daemon);
	if (!daemon.alive)
		ctl_fail("%s was not confirmed: owsd is not running", order->name);
	else if (print_lost(h, order))
		return;
	else if (order->attribute == ATTR_VALUE && write_disabled(h, order))
		ctl_fail("%s was not confirmed: writing is disabled (%s_WriteEnable is 0)",
		         order->name, order->name);
	else if (reading_get(h, order->id, ows_now(), reading) == 0 &&
	         reading->value.quality == OWS_Q_DIFFERS)
		ctl_fail("%s was not confirmed: the device does not have what was commanded: set "
		         "%s_WriteOneShot to 1 and it is written again",
		         order->name, order->name);
	else if (reading_get(h, order->id, ows_now(), reading) != 0 || !reading_good(reading) ||
	         reading->value.err)
		ctl_fail("%s was not confirmed: %s", order->name, why_not(reading, words));
	else
		ctl_fail("%s was not confirmed within %s s: its turn has not come", order->name,
		         seconds);
}

static void set_print_json(const struct order *orders, int count, bool waited)
{
	struct json json;

	json_list(&json, stdout, true);
	for (int i = 0; i < count; i++) {
		json_object(&json, NULL);
		json_string(&json, "name", orders[i].name);
		json_string(&json, "set", orders[i].text);
		if (waited && !is_edge(orders[i].attribute))
			json_bool(&json, "confirmed", orders[i].confirmed);
		else
			json_null(&json, "confirmed");
		json_object_end(&json);
	}
	json_list_end(&json);
}

/* Refuse two values for one signal: chance would decide which of them the device gets. */
static int refuse_twice(const struct order *orders, int count)
{
	for (int i = 1; i < count; i++)
		for (int j = 0; j < i; j++)
			if (orders[i].id == orders[j].id)
				return ctl_fail("%s is set twice: nothing was set", orders[i].name);
	return CTL_DONE;
}

static int set_all(struct ctl *ctl, struct ows *h, struct order *orders, int count,
                   const char *seconds, int64_t limit_ns)
{
	static struct reading reading;
	struct ows_daemon daemon = {0};
	int status = CTL_DONE;

	ows_daemon(h, ows_now(), &daemon);
	if (!daemon.alive)
		return ctl_fail("owsd is not running: nothing was set");
	for (int i = 0; i < count; i++)
		if (check_order(ctl, h, &orders[i]) != CTL_DONE)
			status = CTL_FAILED;
	if (status == CTL_DONE)
		status = refuse_twice(orders, count);
	for (int i = 0; i < count && status == CTL_DONE; i++)
		status = set_send(h, &orders[i]);
	if (status)
		return status;
	if (seconds && set_await(h, orders, count, limit_ns, &reading) != CTL_DONE) {
		status = CTL_FAILED;
		for (int i = 0; i < count; i++)
			if (!is_confirmed(h, &orders[i], &reading))
				print_why(h, &orders[i], seconds, &reading);
	}
	if (ctl->json)
		set_print_json(orders, count, seconds);
	return status;
}

/*
 * Options may stand before each name, and behind the last value: no name begins with a minus, but a
 * value may. Names and values are in argv from 1 on then; returns how many there are.
 */
static int take_options(struct ctl *ctl, int argc, char **argv, const char **seconds,
                        int64_t *limit_ns)
{
	int c, at = 1, count = 0;
	char **words = argv + 1;

	while (at < argc) {
		argc -= at - 1;
		argv += at - 1;
		optind = 0;
		while ((c = ctl_option(ctl, argc, argv, "+w:")) != -1) {
			*seconds = optarg;
			*limit_ns = ctl_option_seconds(ctl, c);
		}
		for (at = optind; at < argc && at < optind + 2; at++)
			words[count++] = argv[at];
	}
	return count;
}

int verb_set(struct ctl *ctl, int argc, char **argv)
{
	const char *seconds = NULL;
	struct order *orders;
	int64_t limit_ns = 0;
	int words = take_options(ctl, argc, argv, &seconds, &limit_ns), count = words / 2, status;
	struct ows *h;

	if (!words || words % 2)
		return ctl_usage(ctl, words ? "%s needs a value" : "set what?", argv[words]);
	h = ctl_open(ctl, OWS_CONTROL);
	orders = ctl_need(calloc((size_t)count, sizeof(*orders)));
	for (int i = 0; i < count; i++) {
		orders[i].name = argv[1 + 2 * i];
		orders[i].text = argv[2 + 2 * i];
	}
	status = set_all(ctl, h, orders, count, seconds, limit_ns);
	free(orders);
	ows_close(h);
	return status;
}
