/* SPDX-License-Identifier: MIT */
/* owsctl wait: waits until a value changes or fulfils a condition. */
#include <errno.h>
#include <getopt.h>

#include "hal/base/time.h"
#include "src/faces/show/names.h"
#include "src/tool/owsctl/ctl.h"
#include "src/tool/owsctl/rows.h"
#include "src/tool/owsctl/verbs.h"
#include "src/tool/owsctl/watch/condition.h"

#define NO_LIMIT INT64_MAX
#define SLICE (250 * NS_PER_MS) /* an old value or a dead owsd sends no wake-up */

struct waiting {
	struct ows *h;
	const char *name;
	int id;
	const char *op; /* NULL: any change */
	struct condition condition;
	struct row row; /* the first reading */
	struct reading *reading;
};

/* Bad values fulfil no condition. A change is a change of the value, or from or to not good. */
static bool came(struct waiting *waiting)
{
	reading_get(waiting->h, waiting->id, ows_now(), waiting->reading);
	if (waiting->op)
		return reading_good(waiting->reading) &&
		       condition_holds(&waiting->condition, waiting->reading);
	return reading_filled(waiting->reading) && row_changed(&waiting->row, waiting->reading);
}

static bool sleep_until_it_came(struct waiting *waiting, int64_t limit_ns)
{
	int64_t end = limit_ns == NO_LIMIT ? NO_LIMIT : ows_now() + limit_ns;
	uint32_t news = 0;

	if (!waiting->op)
		came(waiting);
	while (!came(waiting)) {
		int64_t left = end == NO_LIMIT ? SLICE : end - ows_now();

		if (left <= 0)
			return false;
		ctl_sleep(waiting->h, &news, left < SLICE ? left : SLICE);
	}
	return true;
}

static int print_end(struct ctl *ctl, struct waiting *waiting, bool it_came)
{
	struct reading *reading = waiting->reading;
	struct when now = when_now();
	char words[READING_WORDS];
	struct ows_info info;
	struct json json;

	if (ctl->json) {
		json_open(&json, stdout);
		json_object(&json, NULL);
		json_string(&json, "name", waiting->name);
		json_bool(&json, "came", it_came);
		reading_json(&json, waiting->h, reading, &now);
		json_object_end(&json);
		json_end(&json);
	} else if (it_came) {
		if (names_info(waiting->h, ctl->instance, waiting->name, &info))
			reading_round(reading, info.decimals);
		fwrite(reading->text, 1, reading->len, stdout);
		putchar('\n');
	}
	if (!reading_good(reading)) {
		ctl_flush(CTL_DONE);
		ctl_fail("%s is not good: %s", waiting->name, reading_why(reading, words));
		return CTL_NOT_GOOD;
	}
	return it_came ? CTL_DONE : ctl_fail("%s: the time is over", waiting->name);
}

static int wait_begin(struct ctl *ctl, struct waiting *waiting, const char *value)
{
	enum attribute attribute;
	struct ows_info info;
	enum ows_type type;
	int signal, err;

	waiting->id = ows_find(waiting->h, waiting->name);
	if (waiting->id < 0 ||
	    names_lookup(waiting->h, ctl->instance, waiting->name, &signal, &attribute) != 0)
		return ctl_unknown(waiting->h, waiting->name);
	if (!attribute_table[attribute].readable)
		return ctl_fail("%s can only be set", waiting->name);
	if (!waiting->op)
		return CTL_DONE;
	type = attribute_table[attribute].type;
	if (attribute == ATTR_VALUE && ows_info(waiting->h, signal, &info) == 0)
		type = (enum ows_type)info.type;
	err = condition_make(type, waiting->op, value, &waiting->condition);
	if (err == -EOPNOTSUPP)
		return ctl_usage(ctl, "%s is a string: only = and != can be waited for",
		                 waiting->name);
	if (err)
		return ctl_usage(ctl, "%s is not a value to compare %s with", ctl_word(value),
		                 waiting->name);
	return CTL_DONE;
}

static void parse_limit(struct ctl *ctl, int argc, char **argv, int64_t *limit_ns)
{
	int c;

	optind = 0;
	while ((c = ctl_option(ctl, argc, argv, "+t:")) != -1)
		*limit_ns = ctl_option_seconds(ctl, c);
}

int verb_wait(struct ctl *ctl, int argc, char **argv)
{
	static struct reading reading;
	struct waiting waiting = {.reading = &reading};
	const char *value = NULL;
	int64_t limit_ns = NO_LIMIT;
	int status, at;

	parse_limit(ctl, argc, argv, &limit_ns);
	at = optind;
	if (at == argc)
		return ctl_usage(ctl, "wait for what?");
	waiting.name = argv[at++];
	if (at < argc && condition_op(argv[at]) >= 0) {
		if (at + 1 == argc)
			return ctl_usage(ctl, "%s needs a value to compare with", argv[at]);
		waiting.op = argv[at];
		value = argv[at + 1];
		at += 2;
	}
	/* Options may stand behind the condition too. */
	if (at < argc) {
		argc -= at - 1;
		argv += at - 1;
		parse_limit(ctl, argc, argv, &limit_ns);
		if (optind < argc)
			return ctl_usage(ctl, "%s is no comparison (= != < <= > >=)", argv[optind]);
	}
	waiting.h = ctl_open(ctl, OWS_READ);
	status = wait_begin(ctl, &waiting, value);
	if (status == CTL_DONE)
		status = print_end(ctl, &waiting, sleep_until_it_came(&waiting, limit_ns));
	ows_close(waiting.h);
	return status;
}
