/* SPDX-License-Identifier: MIT */
/* owsctl mission: start, stop, look at and download the mission of a logger. */
#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "hal/chips/loggers/host_clock.h"
#include "src/faces/show/json.h"
#include "src/tool/owsctl/mission/mission_ask.h"
#include "src/tool/owsctl/mission/mission_download.h"
#include "src/tool/owsctl/verbs.h"

/* --- Status --- */

/* What cannot be read is left out, as the begin of a mission that has no sample yet. */
struct status {
	double running, samples, elements, rollover, interval, begin, clock;
	bool has_begin;
};

static int mission_look(struct mission *mission, struct status *status)
{
	const struct {
		const char *property;
		double *value;
	} wanted[] = {{"mission/running", &status->running},
	              {"mission/samples", &status->samples},
	              {"log/elements", &status->elements},
	              {"mission/rollover", &status->rollover},
	              {"clock/udate", &status->clock}};

	for (size_t i = 0; i < sizeof(wanted) / sizeof(wanted[0]); i++)
		if (mission_need(mission, wanted[i].property, wanted[i].value))
			return CTL_FAILED;
	int err = mission_interval(mission, &status->interval);
	if (err)
		return mission_failed(mission, "interval", err);
	status->has_begin = status->samples > 0 &&
	                    !mission_read(mission, "mission/udate", &status->begin);
	return CTL_DONE;
}

static void mission_print_json(const struct status *status)
{
	char begin[MISSION_TIME], clock[MISSION_TIME];
	struct json json;

	mission_time(status->begin, begin);
	mission_time(status->clock, clock);
	json_open(&json, stdout);
	json_object(&json, NULL);
	json_bool(&json, "running", status->running != 0);
	json_string(&json, "begin", status->has_begin ? begin : NULL);
	json_uint(&json, "interval", (uint64_t)status->interval);
	json_uint(&json, "samples", (uint64_t)status->samples);
	json_uint(&json, "logged", (uint64_t)status->elements);
	json_bool(&json, "rollover", status->rollover != 0);
	json_string(&json, "clock", clock);
	json_object_end(&json);
	json_end(&json);
}

static int print_status(const struct ctl *ctl, struct mission *mission)
{
	char begin[MISSION_TIME] = "-", clock[MISSION_TIME];
	struct status status = {0};

	if (mission_look(mission, &status))
		return CTL_FAILED;
	if (ctl->json) {
		mission_print_json(&status);
		return CTL_DONE;
	}
	if (status.has_begin)
		mission_time(status.begin, begin);
	mission_time(status.clock, clock);
	printf("running   %s\nbegin     %s\ninterval  %.0f s\nsamples   %.0f\nlogged    %.0f\n"
	       "rollover  %s\nclock     %s\n",
	       status.running != 0 ? "yes" : "no", begin, status.interval, status.samples,
	       status.elements, status.rollover != 0 ? "yes" : "no", clock);
	return CTL_DONE;
}

/* --- Start and stop --- */

/* Another program that starts one at the same time may have written its own settings between. */
static int check_started(struct mission *mission, double interval, bool rollover)
{
	double running, seconds, over;
	int err;

	if (mission_need(mission, "mission/running", &running))
		return CTL_FAILED;
	if (running == 0)
		return ctl_fail("%s: the mission has not begun", mission->device);
	err = mission_interval(mission, &seconds);
	if (err)
		return mission_failed(mission, "interval", err);
	if (mission_need(mission, "mission/rollover", &over))
		return CTL_FAILED;
	if (seconds == interval && (over != 0) == rollover)
		return CTL_DONE;
	return ctl_fail("%s: another program started a mission at the same time: it has an "
	                "interval of %.0f s, %s rollover; stop it first",
	                mission->device, seconds, over != 0 ? "with" : "without");
}

/* The one runs when its interval is written, the other when it is started. */
static int start_mission(struct mission *mission, double interval, bool rollover)
{
	double now;

	if (host_clock(&now))
		return ctl_fail("%s: the clock of this computer is not set: no mission can be "
		                "given its time",
		                mission->device);
	const struct {
		const char *property;
		double value;
		bool for_minutes, for_seconds;
	} steps[] = {
		{"clock/udate", now, true, true},
		{"clock/running", 1, true, true},
		{"mission/delay", 0, true, true},
		{"mission/rollover", rollover, true, true},
		{"mission/enable", 1, true, false},
		{"mission/clear", 1, true, false},
		{"mission/frequency", interval / 60, true, false},
		{"mission/interval", interval, false, true},
		{"mission/running", 1, false, true},
	};
	double running;

	if (mission_need(mission, "mission/running", &running))
		return CTL_FAILED;
	if (running != 0)
		return ctl_fail("%s: a mission runs; stop it first", mission->device);
	for (size_t i = 0; i < sizeof(steps) / sizeof(steps[0]); i++) {
		if ((mission->minutes ? steps[i].for_minutes : steps[i].for_seconds) &&
		    mission_write(mission, steps[i].property, steps[i].value))
			return CTL_FAILED;
	}
	return check_started(mission, interval, rollover);
}

static bool is_interval(const struct mission *mission, double seconds)
{
	if (mission->minutes)
		return seconds >= 60 && seconds <= 255 * 60 && fmod(seconds, 60) == 0;
	return seconds >= 1 &&
	       (seconds <= 16383 || (seconds <= 16383 * 60.0 && fmod(seconds, 60) == 0));
}

static int check_and_start(const struct ctl *ctl, struct mission *mission, const char *interval,
                           bool rollover)
{
	int64_t ns;
	bool fits = interval && ctl_seconds(interval, &ns) && ns % NS_PER_S == 0 &&
	            is_interval(mission, (double)ns / NS_PER_S);

	if (!fits)
		return ctl_usage(ctl, "-i %s",
		                 mission->minutes ? "60 to 15300 seconds, in whole minutes"
		                                  : "1 to 16383 seconds, or whole minutes");
	return start_mission(mission, (double)ns / NS_PER_S, rollover);
}

int verb_mission(struct ctl *ctl, int argc, char **argv)
{
	int64_t timeout_ns = OPEN_TIMEOUT_NS;
	const char *interval = NULL, *what;
	bool rollover = false;
	struct mission mission;
	int c, status;

	while ((c = target_option(ctl, argc, argv, "i:o", &timeout_ns)) != -1) {
		interval = c == 'i' ? optarg : interval;
		rollover |= c == 'o';
	}
	if (argc - optind != 2)
		return ctl_usage(ctl, "expected start, stop, status or download, and a device");
	what = argv[optind];
	if (strcmp(what, "start") != 0 && strcmp(what, "stop") != 0 &&
	    strcmp(what, "status") != 0 && strcmp(what, "download") != 0)
		return ctl_usage(ctl, "%s: expected start, stop, status or download",
		                 ctl_word(what));
	if (strcmp(what, "start") != 0 && (interval || rollover))
		return ctl_usage(ctl, "-i and -o are for start");
	status = mission_open(ctl, argv[optind + 1], timeout_ns, &mission);
	if (status)
		return status;
	if (strcmp(what, "start") == 0)
		status = check_and_start(ctl, &mission, interval, rollover);
	else if (strcmp(what, "stop") == 0)
		status = mission_write(&mission, "mission/running", 0);
	else if (strcmp(what, "status") == 0)
		status = print_status(ctl, &mission);
	else
		status = mission_download(ctl, &mission);
	target_close(&mission.target);
	return status;
}
