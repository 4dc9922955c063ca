/* SPDX-License-Identifier: MIT */
/* Values, whether chips are there, and alarms, as messages of JSON. */
#include <string.h>
#include <time.h>

#include "hal/base/time.h"
#include "src/faces/mqtt/plain.h"
#include "src/faces/show/reading.h"
#include "src/faces/show/stats.h"
#include "src/faces/show/when.h"

void plain_topic(const struct stream *s, const struct row *row, char topic[TOPIC_SIZE])
{
	snprintf(topic, TOPIC_SIZE, "%s/%s", s->prefix, row->level);
}

void plain_problem_topic(const struct stream *s, const struct chip *chip, char topic[TOPIC_SIZE])
{
	snprintf(topic, TOPIC_SIZE, "%s/" TOPIC_CHIP "/%s/" TOPIC_PROBLEM, s->prefix, chip->id);
}

bool plain_state(struct stream *s, enum stream_node node)
{
	return stream_put_below(s, TOPIC_STATE, node == STREAM_THERE ? "online" : "offline");
}

bool plain_writes(const struct stream *s, const char *topic, const char *below)
{
	const char *level = strchr(below, '/');
	const struct row *row;
	char id[ROM_TEXT_MAX];

	if (level && !strncmp(below, TOPIC_CHIP "/", strlen(TOPIC_CHIP) + 1)) {
		snprintf(id, sizeof(id), "%.*s", (int)strcspn(level + 1, "/"), level + 1);
		return stream_chip(s, id);
	}
	if (level && strcmp(level, "/alarm") != 0)
		return true;
	if (!level && (!strcmp(below, TOPIC_STATE) || !strcmp(below, TOPIC_HEALTH)))
		return true;
	row = stream_row(s, topic, level ? (size_t)(level - topic) : strlen(topic));
	return row && (!level || row->alarms);
}

/* --- Values ---------------------------------------------------------------------------------- */

/* A time of a clock that nobody has set is none. */
static void put_time(struct json *json, const struct stream *s, int64_t wall_ns)
{
	if (s->clock_set)
		json_int(json, "t", wall_ns / NS_PER_MS);
	else
		json_null(json, "t");
}

/* A bad value has no number. owsd lost: no value is good. */
static void plain_put_value(struct json *json, const struct stream *s, const struct ows_value *v,
                            const char *text)
{
	uint8_t quality = v->quality;
	struct when now = when_now();

	if (ows_good(quality))
		reading_json_number(json, "v", v, text);
	else
		json_null(json, "v");
	json_bool(json, "good", ows_good(quality));
	json_uint(json, "q", quality);
	if (v->detail & OWS_DETAIL_SIMULATED)
		json_bool(json, "simulated", true);
	if (!ows_good(quality))
		json_string(json, "why", ows_quality_text(s->live ? quality : OWS_Q_NO_OWSD));
	put_time(json, s, face_value_time(v, now.boot) + now.wall - now.boot);
}

void plain_value_json(struct json *json, struct stream *s, struct row *row)
{
	struct news news;

	stream_read(s, row, &news);
	plain_put_value(json, s, &news.value.v, news.value.text);
}

/* One of its signals that answers is enough. */
static enum chip_state state_of(const struct stream *s, const struct chip *chip)
{
	if (!s->live)
		return CHIP_OFFLINE;
	return chip->answers ? CHIP_ONLINE : chip->away ? CHIP_OFFLINE : CHIP_UNKNOWN;
}

bool plain_chip_there(const struct stream *s, const struct chip *chip)
{
	enum chip_state state = state_of(s, chip);

	return state == CHIP_ONLINE || (state == CHIP_UNKNOWN && !chip->inputs);
}

bool plain_chip_look(struct stream *s, struct row *row, uint8_t quality)
{
	bool away = quality == OWS_Q_NO_DEVICE || quality == OWS_Q_TARGET ||
	            quality == OWS_Q_NO_OWSD || quality == OWS_Q_SHORT;
	/* what is less is wrong with the configuration, and says nothing of the chip */
	bool answers = quality > OWS_Q_NO_DEVICE && quality != OWS_Q_INITIAL && !away;
	struct chip *chip;

	if (row->chip < 0)
		return false;
	chip = &s->chips[row->chip];
	chip->away += away - row->away;
	row->away = away;
	chip->answers += answers - row->answers;
	row->answers = answers;
	/* a chip that was never there is announced when it comes */
	if (!plain_chip_there(s, chip) || chip->seen)
		return false;
	chip->seen = true;
	return true;
}

const char *plain_chip_word(const struct stream *s, const struct chip *chip)
{
	static const char *const words[] = {"offline", "unknown", "online"};

	return words[state_of(s, chip)];
}

static bool publish_chip(struct stream *s, struct row *row, uint8_t quality)
{
	enum chip_state state;
	struct chip *chip;

	if (plain_chip_look(s, row, quality) && s->profile->birth)
		s->birth = 0;
	if (row->chip < 0)
		return true;
	chip = &s->chips[row->chip];
	state = state_of(s, chip);
	if (chip->published && state == chip->state)
		return true;
	if (!stream_put_text(s, chip->topic, plain_chip_word(s, chip), true))
		return false;
	chip->published = true;
	chip->state = state;
	return true;
}

/* A key came: the ROM id of the one that is there, for those who are there now. */
static bool publish_key(struct stream *s, struct row *row, const struct ows_value *v)
{
	bool here = ows_good(v->quality) && v->integer != 0;
	char topic[TOPIC_SIZE], id[ROM_TEXT_MAX];
	const char *device = row->info.device;
	uint8_t rom[ROM_LEN];

	/* one that was there before we looked did not come */
	if (!ows_good(v->quality) && v->quality != OWS_Q_NO_DEVICE)
		return true;
	if (here && row->key_away) {
		snprintf(topic, sizeof(topic), "%s/tag", row->topic);
		if (!rom_parse(device, strlen(device), rom))
			rom_print(rom, ROM_F_I, id);
		else
			snprintf(id, sizeof(id), "%s", row->chip_id);
		if (!stream_put_text(s, topic, id, false))
			return false;
	}
	row->key_away = !here;
	return true;
}

bool plain_limit(const struct stream *s, const struct row *row, struct ows_alarm_state *state)
{
	return row->alarms && s->live && !ows_alarm_state(s->h, row->id, state);
}

bool plain_stands(const struct ows_alarm_state *state)
{
	return state->limit_state == OWS_LIMIT_UNACKNOWLEDGED ||
	       state->limit_state == OWS_LIMIT_ACKNOWLEDGED;
}

/* The limit alarm, if it is another than was published. */
static bool publish_limit(struct stream *s, struct row *row)
{
	struct ows_alarm_state state;
	char topic[TOPIC_SIZE];
	struct json json;
	uint32_t print;

	if (!plain_limit(s, row, &state))
		return true;
	print = 1u + state.limit_state + (state.limit_kind << 4) + (state.shelved << 12);
	if (print == row->alarm_print)
		return true;
	stream_message(s, &json);
	json_object(&json, NULL);
	json_bool(&json, "active", plain_stands(&state));
	json_string(&json, "state", ows_limit_state_text(state.limit_state));
	json_string(&json, "kind", state.limit_kind ? ows_alarm_kind_text(state.limit_kind) : NULL);
	json_bool(&json, "shelved", state.shelved);
	json_object_end(&json);
	snprintf(topic, sizeof(topic), "%s/alarm", row->topic);
	if (!stream_put(s, topic, true))
		return false;
	row->alarm_print = print;
	return true;
}

/* What is wrong with a chip, if it is another than was published; once all its rows are. */
static bool publish_problem(struct stream *s, const struct row *row)
{
	enum device_health health = HEALTH_NORMAL;
	const struct row *first = NULL;
	struct ows_device device;
	char topic[TOPIC_SIZE];
	struct chip *chip;
	struct json json;
	uint64_t print;
	int bad = 0;

	if (row->chip < 0 || !s->live)
		return true;
	chip = &s->chips[row->chip];
	for (int i = chip->first; i < chip->first + chip->rows; i++) {
		const struct row *one = s->by_chip[i];

		if (!one->published)
			return true;
		health = health_worse(health,
		                      health_of_signal(&one->info, one->quality, one->simulated));
		/* what nobody has set yet, and a key that is away, are as they should be */
		if (one->good || one->quality == OWS_Q_INITIAL || health_is_key(&one->info))
			continue;
		first = first ? first : one;
		bad++;
	}
	print = first ? (uint64_t)(first - s->rows) << 32 | (unsigned)bad << 9 | first->quality << 1
	              : 0;
	if (health_find(s->h, row->info.device, &device) >= 0)
		health = health_worse(health, health_of_wire(&device));
	print |= (uint64_t)health << 60 | 1;
	if (print == chip->problem_print)
		return true;
	stream_message(s, &json);
	json_object(&json, NULL);
	json_bool(&json, "problem", first);
	json_string(&json, "health", health_word(health));
	json_string(&json, "why", first ? ows_quality_text(first->quality) : NULL);
	json_string(&json, "signal", first ? first->name : NULL);
	json_int(&json, "bad", bad);
	json_object_end(&json);
	plain_problem_topic(s, chip, topic);
	if (!stream_put(s, topic, true))
		return false;
	chip->problem_print = print;
	return true;
}

bool plain_value(struct stream *s, struct row *row)
{
	struct news news;
	bool due = stream_read(s, row, &news);
	struct json json;

	if (!publish_chip(s, row, news.value.v.quality) || !publish_limit(s, row))
		return false;
	if (s->live && health_is_key(&row->info) && !publish_key(s, row, &news.value.v))
		return false;
	if (due) {
		stream_message(s, &json);
		json_object(&json, NULL);
		plain_put_value(&json, s, &news.value.v, news.value.text);
		json_object_end(&json);
		if (!stream_put(s, row->topic, true))
			return false;
		stream_published(row, &news);
	}
	return publish_problem(s, row);
}

/* --- The rest -------------------------------------------------------------------------------- */

void plain_alarm(struct stream *s, const struct ows_alarm *alarm)
{
	struct when now = when_now();
	char topic[TOPIC_SIZE];
	struct json json;

	if (alarm->signal < 0 || alarm->signal >= s->count)
		return;
	stream_message(s, &json);
	json_object(&json, NULL);
	json_string(&json, "event_type", ows_alarm_event_text(alarm->event));
	json_string(&json, "kind", ows_alarm_kind_text(alarm->kind));
	json_string(&json, "text", alarm->text);
	put_time(&json, s, alarm->occurred_ns + now.wall - now.boot);
	json_object_end(&json);
	snprintf(topic, sizeof(topic), "%s/event", s->rows[alarm->signal].topic);
	stream_put(s, topic, false);
}

const char *const plain_below[] = {"+", "+/alarm", TOPIC_CHIP "/+/" TOPIC_STATE,
                                   TOPIC_CHIP "/+/" TOPIC_PROBLEM, NULL};

const struct profile profile_plain = {
	PLAIN,
	.name = "plain",
};
