/* SPDX-License-Identifier: MIT */
/* The present alarms of a signal, its device alarm and its limit alarm, in words. */
#include <errno.h>
#include <stdio.h>

#include "src/faces/show/standing.h"
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

bool standing_wants_eyes(const struct ows_alarm_state *state)
{
	return state->stands || state->unarmed || state->limit_state == OWS_LIMIT_UNACKNOWLEDGED ||
	       state->limit_state == OWS_LIMIT_RETURNED;
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
