/* SPDX-License-Identifier: MIT */
/* The alarms of a signal that are present. */
#include <errno.h>
#include <stdio.h>

#include "src/faces/show/actor.h"
#include "src/faces/show/present.h"
#include "src/ground/signal/unarmed.h"

struct ows_alarm_state standing_of(struct ows *h, int id)
{
	static const struct ows_alarm_state none;
	struct ows_alarm_state state = none;
	int err = ows_alarm_state(h, id, &state);

	return err && err != -ESTALE ? none : state;
}

bool standing_possible(const struct ows_alarm_state *state)
{
	return state->item || state->limits;
}

bool standing_any(const struct ows_alarm_state *state)
{
	return state->stands || state->unarmed || state->limit_state != OWS_LIMIT_NORMAL;
}

bool standing_unacknowledged(const struct ows_alarm_state *state)
{
	return state->limit_state == OWS_LIMIT_UNACKNOWLEDGED ||
	       state->limit_state == OWS_LIMIT_RETURNED;
}

bool standing_wants_eyes(const struct ows_alarm_state *state)
{
	return state->stands || state->unarmed || standing_unacknowledged(state);
}

const char *standing_text(const struct ows_alarm_state *state, char words[STANDING_WORDS])
{
	const char *kind = ows_alarm_kind_text(state->limit_kind), *end = "", *mark = "! ";
	char device[32] = "";

	if (state->unarmed)
		snprintf(device, sizeof(device), "! %s", unarmed_text(state->unarmed));
	else if (state->stands)
		snprintf(device, sizeof(device), "! device");
	if (state->limit_state == OWS_LIMIT_ACKNOWLEDGED) {
		mark = "";
		end = ", acknowledged";
	} else if (state->limit_state == OWS_LIMIT_RETURNED) {
		end = ", returned";
	}
	if (state->shelved) {
		mark = "";
		end = state->limit_kind ? ", shelved" : "shelved";
		kind = state->limit_kind ? kind : "";
	}
	if (!standing_any(state) && !state->shelved)
		snprintf(words, STANDING_WORDS, "-");
	else if (state->limit_state == OWS_LIMIT_NORMAL && !state->shelved)
		snprintf(words, STANDING_WORDS, "%s", device);
	else
		snprintf(words, STANDING_WORDS, "%s%s%s%s%s", device, *device ? "; " : "", mark,
		         kind, end);
	return words;
}

static void standing_add(struct json *json, const char *kind, const char *state, bool device)
{
	json_object(json, NULL);
	json_string(json, "alarm", kind);
	json_string(json, "state", state);
	json_bool(json, "device", device);
	json_object_end(json);
}

void standing_json(struct json *json, const struct ows_alarm_state *state)
{
	json_array(json, "alarms");
	if (state->stands)
		standing_add(json, ows_alarm_kind_text(OWS_ALARM_DEVICE), "stands", true);
	if (state->unarmed)
		standing_add(json, ows_alarm_kind_text(OWS_ALARM_DEVICE),
		             unarmed_text(state->unarmed), true);
	if (state->limit_state != OWS_LIMIT_NORMAL)
		standing_add(json, ows_alarm_kind_text(state->limit_kind),
		             ows_limit_state_text(state->limit_state), false);
	json_array_end(json);
	json_bool(json, "shelved", state->shelved);
}

bool standing_find(struct ows *h, int signal, struct ows_info *info, struct ows_alarm_state *state)
{
	int id;

	if (ows_info(h, signal, info) || (id = ows_find(h, info->name)) < 0)
		return false;
	*state = standing_of(h, id);
	return state->limit_state == OWS_LIMIT_UNACKNOWLEDGED;
}

/* --- All that is present --------------------------------------------------------------------- */

/* When the present alarm of a signal was raised, as far as the journal goes back; else 0. */
static int64_t raised(struct ows *h, int signal, uint8_t kind)
{
	struct ows_alarm alarm;
	int err;

	for (uint32_t number = ows_alarm_count(h); number-- > 0;) {
		err = ows_alarm(h, number, &alarm);
		if (err == -ENOENT)
			break;
		if (err || alarm.signal != signal || alarm.event != OWS_ALARM_RAISED)
			continue;
		if (alarm.kind == kind)
			return alarm.occurred_ns;
	}
	return 0;
}

const char *present_unarmed(const struct ows_alarm_state *state, const struct reading *reading,
                            char words[ERROR_WORDS])
{
	const char *text = unarmed_text(state->unarmed), *key = unarmed_key(state->unarmed);
	bool reads = state->unarmed == OWS_UNARMED_LATCH || state->unarmed == OWS_UNARMED_POR_READ;
	int error = reading_good(reading) ? reading->value.err : 0;

	if (state->unarmed == OWS_UNARMED_NO_POR)
		snprintf(words, ERROR_WORDS, "%s: %s is not defined", text, key);
	else if (state->unarmed == OWS_UNARMED_NO_LATCH)
		snprintf(words, ERROR_WORDS, "%s: %s is not defined, or empty", text, key);
	else if (state->unarmed == OWS_UNARMED_STAYS)
		snprintf(words, ERROR_WORDS, "%s: the latch stays set", text);
	else if (!error)
		snprintf(words, ERROR_WORDS, "%s: %s", text, key);
	else if (error == -EACCES)
		snprintf(words, ERROR_WORDS, "%s: %s cannot be %s", text, key,
		         reads ? "read" : "written");
	else if (error == -EBADRQC)
		snprintf(words, ERROR_WORDS, "%s: %s", text, error_text(error));
	else if (error == -EUCLEAN)
		snprintf(words, ERROR_WORDS, "%s: %s is still set after 0 was written", text, key);
	else
		snprintf(words, ERROR_WORDS, "%s: %s: %s", text, key, error_text(error));
	return words;
}

void present_json(struct json *json, const struct present *alarm, const struct when *now)
{
	char text[WHEN_TEXT];

	json_string(json, "name", alarm->name);
	json_string(json, "alarm", alarm->kind);
	json_string(json, "state", alarm->state);
	json_bool(json, "device", alarm->device);
	json_bool(json, "polled", alarm->polled);
	json_string(json, "since", alarm->since_ns ? when_iso(now, alarm->since_ns, text) : NULL);
	if (alarm->device)
		json_uint(json, "occurrences", alarm->occurrences);
	if (alarm->shelved) {
		json_string(json, "until", when_iso(now, alarm->shelved->until_ns, text));
		actor_json(json, &alarm->shelved->who);
		json_string(json, "why", *alarm->shelved->why ? alarm->shelved->why : NULL);
	}
}

/* It has a device alarm, or the device shows none and is read as an input. */
static void look_at_device(struct present alarm, const struct ows_alarm_state *state,
                           const struct reading *reading, struct ows *h, present_add *add,
                           void *ctx)
{
	char unarmed[ERROR_WORDS];

	alarm.kind = ows_alarm_kind_text(OWS_ALARM_DEVICE);
	alarm.device = true;
	alarm.polled = state->polled;
	alarm.occurrences = state->occurrences;
	if (state->stands || state->polled) {
		alarm.state = state->stands ? "stands" : "no alarm search there: read as an input";
		if (state->stands)
			alarm.since_ns = raised(h, alarm.signal, OWS_ALARM_DEVICE);
		add(ctx, &alarm);
	}
	if (!state->unarmed)
		return;
	alarm.state = present_unarmed(state, reading, unarmed);
	alarm.since_ns = 0;
	alarm.unarmed = state->unarmed;
	add(ctx, &alarm);
}

static void look_at_limit(struct present alarm, const struct ows_alarm_state *state, struct ows *h,
                          present_add *add, void *ctx)
{
	alarm.kind = ows_alarm_kind_text(state->limit_kind);
	alarm.state = ows_limit_state_text(state->limit_state);
	if (state->shelved) {
		alarm.state = "shelved";
		alarm.since_ns = state->since_ns;
		alarm.shelved = state;
		add(ctx, &alarm);
	} else if (state->limit_state != OWS_LIMIT_NORMAL) {
		alarm.since_ns = raised(h, alarm.signal, state->limit_kind);
		add(ctx, &alarm);
	}
}

/* Nobody acknowledges it: it ends when the output reads as it was written. */
static void look_at_output(struct present alarm, const struct reading *reading, struct ows *h,
                           present_add *add, void *ctx)
{
	if (!reading_filled(reading) || reading->value.quality != OWS_Q_DIFFERS)
		return;
	alarm.kind = ows_alarm_kind_text(OWS_ALARM_DIFFERS);
	alarm.state = "stands";
	alarm.since_ns = raised(h, alarm.signal, OWS_ALARM_DIFFERS);
	add(ctx, &alarm);
}

void present_each(struct ows *h, int signal, int id, int64_t now_ns, struct reading *reading,
                  present_add *add, void *ctx)
{
	struct present alarm = {.signal = signal};
	struct ows_alarm_state state = {0};
	struct ows_info info;

	if (ows_info(h, signal, &info) || ows_alarm_state(h, id, &state) == -EAGAIN)
		return;
	reading_get(h, id, now_ns, reading);
	alarm.name = info.name;
	alarm.decimals = info.decimals;
	look_at_device(alarm, &state, reading, h, add, ctx);
	look_at_output(alarm, reading, h, add, ctx);
	look_at_limit(alarm, &state, h, add, ctx);
}
