/* SPDX-License-Identifier: MIT */
/* A logger as a target shows it: requests for its properties. */
#include "src/tool/owsctl/mission/mission_ask.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define VALUE_MAX 64

static bool path_of(const struct mission *mission, const char *property, char path[256])
{
	bool fresh;
	char given[256];
	int n = snprintf(given, sizeof(given), "%s/%s", mission->device, property);

	return n > 0 && n < (int)sizeof(given) && target_path(given, path, &fresh);
}

static int read_property(struct mission *mission, const char *property, char text[VALUE_MAX])
{
	char path[256];
	struct ask ask = {.req = {.op = BUS_READ,
	                          .prio = BUS_GUEST,
	                          .path = path,
	                          .data = (uint8_t *)text,
	                          .len = VALUE_MAX - 1,
	                          .fresh = true}};
	int err = path_of(mission, property, path) ? target_ask_one(&mission->target, &ask)
	                                           : -ENODEV;

	text[err ? 0 : ask.answer.len] = '\0';
	return err;
}

int mission_read(struct mission *mission, const char *property, double *value)
{
	char text[VALUE_MAX], *end;
	int err = read_property(mission, property, text);

	if (err)
		return err;
	*value = strtod(text, &end);
	return end == text ? -EIO : 0;
}

int mission_failed(const struct mission *mission, const char *property, int err)
{
	char words[ERROR_WORDS];

	return ctl_fail("%s/%s: %s", mission->device, property, error_words(err, words));
}

int mission_need(struct mission *mission, const char *property, double *value)
{
	int err = mission_read(mission, property, value);

	return err ? mission_failed(mission, property, err) : CTL_DONE;
}

int mission_write(struct mission *mission, const char *property, double value)
{
	char path[256], text[VALUE_MAX];
	struct ask ask = {.req = {.op = BUS_WRITE, .prio = BUS_OUTPUT, .path = path}};
	int err;

	ask.req.data = (uint8_t *)text;
	ask.req.number = true;
	ask.req.value = rint(value);
	err = path_of(mission, property, path) ? target_ask_one(&mission->target, &ask) : -ENODEV;
	return err ? mission_failed(mission, property, err) : CTL_DONE;
}

int mission_open(const struct ctl *ctl, const char *device, int64_t timeout_ns,
                 struct mission *mission)
{
	char family[VALUE_MAX];
	struct served served;
	int status, err;

	*mission = (struct mission){.device = device};
	status = open_target(ctl, timeout_ns, &mission->target, &served);
	if (status)
		return status;
	err = read_property(mission, "family", family);
	mission->minutes = strcmp(family, "21") == 0;
	if (!err && (mission->minutes || strcmp(family, "41") == 0))
		return CTL_DONE;
	status = err ? mission_failed(mission, "family", err)
	             : ctl_fail("%s: no logger; they have the families 21 and 41", device);
	target_close(&mission->target);
	return status;
}

int mission_interval(struct mission *mission, double *seconds)
{
	int err = mission_read(mission, mission->minutes ? "mission/frequency" : "mission/interval",
	                       seconds);

	if (!err && mission->minutes)
		*seconds *= 60;
	return err;
}

void mission_time(double seconds, char text[MISSION_TIME])
{
	time_t when = (time_t)seconds;
	struct tm tm;

	if (!gmtime_r(&when, &tm) || !strftime(text, MISSION_TIME, "%Y-%m-%dT%H:%M:%SZ", &tm))
		text[0] = '\0';
}
