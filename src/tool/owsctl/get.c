/* SPDX-License-Identifier: MIT */
/* owsctl get: values alone, or as JSON. */
#include <errno.h>
#include <getopt.h>

#include "src/faces/show/digits.h"
#include "src/faces/show/names.h"
#include "src/faces/show/reading.h"
#include "src/tool/owsctl/ctl.h"
#include "src/tool/owsctl/rows.h"
#include "src/tool/owsctl/verbs.h"

static int worse(int a, int b)
{
	return a == CTL_FAILED || b == CTL_FAILED ? CTL_FAILED : a > b ? a : b;
}

/* A set takes a moment: say what is on its way, while the value is still the one before. */
static void say_command(struct ows *h, const struct ows_info *info, int id,
                        const struct reading *reading)
{
	char commanded[VALUE_TEXT_MAX], text[COMMANDED_WORDS];

	if (reading->err || !command_differs(h, id, reading, commanded))
		return;
	ctl_flush_lines();
	ctl_tell("%s: commanded %s, and the device does not have it%s", info->name,
	         commanded_text((enum ows_type)info->type, commanded, info->decimals, info->unit,
	                        text),
	         reading->value.quality == OWS_Q_DIFFERS ? "" : " yet");
}

static int get_one(const struct ctl *ctl, struct ows *h, const char *name, struct reading *reading)
{
	char words[READING_WORDS];
	struct ows_info info;
	bool is_value, has_value;
	int id = ows_find(h, name);

	if (id == -ENOENT)
		return ctl_unknown(h, name);
	if (id < 0)
		return ctl_fail("%s: %s", name, error_text(id));
	if (reading_get(h, id, ows_now(), reading) == -EACCES)
		return ctl_fail("%s can only be set", name);
	if (!reading_filled(reading))
		return ctl_fail("%s: %s", name, error_text(reading->err));
	is_value = names_info(h, ctl->instance, name, &info);
	if (is_value)
		reading_round(reading, digits_of_script(reading->value.number, info.decimals));
	/* an empty line, so that each name keeps its own */
	has_value = !is_value || reading_has_value(reading);
	ctl_value(reading->text, has_value ? reading->len : 0);
	if (is_value)
		say_command(h, &info, id, reading);
	if (reading_good(reading))
		return CTL_DONE;
	/* keep the order of stderr and stdout where both go to one place */
	ctl_flush_lines();
	ctl_fail("%s %s: %s", name, has_value ? "is not good" : "has no value",
	         reading_why(reading, words));
	return CTL_NOT_GOOD;
}

static int get_json(const struct ctl *ctl, struct json *json, struct ows *h, const char *name,
                    struct reading *reading, const struct when *now)
{
	int id = ows_find(h, name), status = CTL_DONE;
	struct meaning meaning;
	struct ows_info info;

	json_object(json, NULL);
	json_string(json, "name", name);
	if (id < 0) {
		json_null(json, "value");
		json_bool(json, "good", false);
		json_string(json, "error", id == -ENOENT ? "no such name" : error_text(id));
		status = id == -ENOENT ? ctl_unknown(h, name) : CTL_FAILED;
	} else {
		reading_get(h, id, now->boot, reading);
		if (reading->err == -EACCES)
			status = ctl_fail("%s can only be set", name);
		else if (!reading_filled(reading))
			status = CTL_FAILED;
		else if (!reading_good(reading))
			status = CTL_NOT_GOOD;
		reading_json(json, h, reading, now);
		if (names_info(h, ctl->instance, name, &info)) {
			meaning_of(h, &info, &meaning);
			meaning_json(json, h, &meaning, now->boot);
			meaning_free(&meaning);
		}
	}
	json_object_end(json);
	return status;
}

int verb_get(struct ctl *ctl, int argc, char **argv)
{
	static struct reading reading;
	struct when now;
	struct json json;
	struct ows *h;
	int worst = CTL_DONE;

	ctl_option(ctl, argc, argv, "");
	if (optind == argc)
		return ctl_usage(ctl, "get what?");
	h = ctl_open(ctl, OWS_READ);
	now = when_now();
	json_list(&json, stdout, ctl->json);
	for (int i = optind; i < argc; i++) {
		int status = ctl->json ? get_json(ctl, &json, h, argv[i], &reading, &now)
		                       : get_one(ctl, h, argv[i], &reading);

		worst = worse(worst, status);
	}
	json_list_end(&json);
	if (worst != CTL_DONE)
		ctl_alive(ctl, h, ows_now());
	ows_close(h);
	return worst;
}
