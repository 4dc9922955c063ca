/* SPDX-License-Identifier: MIT */
/* The rows of an instance, and which of them have to be published. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "src/mqtt/stream.h"

/* --- Messages -------------------------------------------------------------------------------- */

void stream_message(struct stream *s, struct json *json)
{
	rewind(s->out);
	json_open(json, s->out);
}

bool stream_put(struct stream *s, const char *topic, bool retain)
{
	if (fflush(s->out))
		return false;
	return stream_put_text(s, topic, NULL, retain);
}

bool stream_put_text(struct stream *s, const char *topic, const char *text, bool retain)
{
	return s->outlet.put(s->outlet.ctx, topic, text ? text : s->text,
	                     text ? strlen(text) : s->len, retain);
}

/* --- The rows -------------------------------------------------------------------------------- */

int stream_open(struct stream *s)
{
	s->out = open_memstream(&s->text, &s->len);
	s->birth = -1;
	return s->out ? 0 : -ENOMEM;
}

static void free_rows(struct stream *s)
{
	for (int i = 0; i < s->count; i++)
		free(s->rows[i].topic);
	for (int i = 0; i < s->chip_count; i++)
		free(s->chips[i].topic);
	free(s->rows);
	free(s->chips);
	free(s->queue);
	free(s->by_topic);
	free(s->by_chip);
	s->by_topic = s->by_chip = NULL;
	s->rows = NULL;
	s->chips = NULL;
	s->queue = NULL;
	s->count = s->chip_count = s->queue_len = s->queue_at = 0;
}

static void free_gone(struct stream *s)
{
	for (int i = 0; i < s->gone_count; i++) {
		free(s->gone[i].topic);
		free(s->gone[i].text);
	}
	free(s->gone);
	s->gone = NULL;
	s->gone_count = s->gone_room = 0;
}

void stream_close(struct stream *s)
{
	free_rows(s);
	free_gone(s);
	free(s->health);
	s->health = NULL;
	if (s->out)
		fclose(s->out);
	free(s->text);
	s->out = NULL;
	s->text = NULL;
}

static const char *property_of(const struct ows_info *info)
{
	const char *device = *info->device ? strstr(info->path, info->device) : NULL;
	const char *property = device ? device + strlen(info->device) : info->path;

	property += *property == '/';
	return *property ? property : info->name;
}

/* By chip, then by property: rows that have both in common stand together, in their order. */
static int by_chip(const void *a, const void *b)
{
	const struct row *x = *(struct row *const *)a, *y = *(struct row *const *)b;
	int order = strcmp(x->chip_id, y->chip_id);

	if (!order)
		order = strcmp(x->property, y->property);
	return order ? order : (x > y) - (x < y);
}

static int by_topic(const void *a, const void *b)
{
	return strcmp((*(struct row *const *)a)->topic, (*(struct row *const *)b)->topic);
}

static bool make_row(struct stream *s, int signal)
{
	struct row *row = &s->rows[signal];
	struct ows_alarm_state state = {0};
	char level[TOPIC_NAME];
	uint8_t rom[ROM_LEN];

	row->chip = -1;
	if (ows_info(s->h, signal, &row->info))
		return false;
	topic_escape(row->info.name, level);
	if (asprintf(&row->topic, "%s/%s", s->prefix, level) < 0) {
		row->topic = NULL;
		return false;
	}
	row->property = property_of(&row->info);
	row->id = ows_find(s->h, row->info.name);
	row->alarms = row->id >= 0 && !ows_alarm_state(s->h, row->id, &state) && state.limits;
	row->class = s->class_of ? s->class_of(s->class_ctx, row->info.name) : "";
	if (!rom_parse(row->info.device, strlen(row->info.device), rom))
		rom_print(rom, ROM_F_I, row->chip_id);
	s->by_topic[signal] = s->by_chip[signal] = row;
	return true;
}

static bool make_chips(struct stream *s)
{
	const struct row *last = NULL;

	for (int i = 0; i < s->count; last = s->by_chip[i++]) {
		struct row *row = s->by_chip[i];
		bool same = last && !strcmp(last->chip_id, row->chip_id);
		struct chip *chip = &s->chips[s->chip_count];

		row->twice = same && !strcmp(last->property, row->property);
		if (!*row->chip_id)
			continue;
		if (!same) {
			*chip = (struct chip){
				.id = row->chip_id, .family = row->info.family, .first = i};
			if (asprintf(&chip->topic, "%s/" TOPIC_CHIP "/%s", s->prefix,
			             row->chip_id) < 0) {
				chip->topic = NULL;
				return false;
			}
			s->chip_count++;
		}
		row->chip = s->chip_count - 1;
		s->chips[row->chip].rows++;
	}
	return true;
}

struct chip *stream_chip(const struct stream *s, const char *id)
{
	int low = 0, high = s->chip_count;

	while (low < high) {
		int middle = (low + high) / 2, order = strcmp(id, s->chips[middle].id);

		if (!order)
			return &s->chips[middle];
		if (order < 0)
			high = middle;
		else
			low = middle + 1;
	}
	return NULL;
}

int stream_make(struct stream *s, struct ows *h)
{
	int count = ows_count(h);
	struct stream old = *s;
	size_t room = count > 0 ? (size_t)count : 1;
	bool made;

	s->h = h;
	s->chip_count = s->queue_at = s->queue_len = 0;
	s->rows = calloc(room, sizeof(*s->rows));
	s->chips = calloc(room, sizeof(*s->chips));
	s->queue = calloc(room, sizeof(*s->queue));
	s->by_topic = calloc(room, sizeof(struct row *));
	s->by_chip = calloc(room, sizeof(struct row *));
	made = s->rows && s->chips && s->queue && s->by_topic && s->by_chip;
	s->count = made ? count : 0;
	for (int i = 0; made && i < count; i++)
		made = make_row(s, i);
	if (made) {
		qsort(s->by_topic, (size_t)count, sizeof(struct row *), by_topic);
		qsort(s->by_chip, (size_t)count, sizeof(struct row *), by_chip);
		made = make_chips(s);
	}
	for (int i = 0; made && i < old.chip_count; i++) {
		struct chip *chip = stream_chip(s, old.chips[i].id);

		if (chip)
			chip->seen = old.chips[i].seen;
	}
	if (!made)
		free_rows(s);
	free_rows(&old);
	stream_begin(s);
	return made ? 0 : -ENOMEM;
}

/* --- What the broker keeps of what is no more ------------------------------------------------ */

void stream_places(const struct stream *s, int number, char topic[TOPIC_SIZE])
{
	static const char *const below[] = {"+", "+/alarm", TOPIC_CHIP "/+"};
	const int count = sizeof(below) / sizeof(below[0]);

	topic[0] = '\0';
	if (number < count)
		snprintf(topic, TOPIC_SIZE, "%s/%s", s->prefix, below[number]);
	else if (number == count && s->profile->births)
		s->profile->births(s, topic);
}

/* Does nobody write a topic below the prefix any more? */
static bool is_gone(const struct stream *s, const char *topic, size_t prefix_len)
{
	const char *level = topic + prefix_len + 1, *below = strchr(level, '/');
	char text[TOPIC_SIZE];
	struct row key = {.topic = text}, *wanted = &key, **found;

	if (below && !strncmp(level, TOPIC_CHIP "/", strlen(TOPIC_CHIP) + 1))
		return !stream_chip(s, below + 1);
	if (below && strcmp(below, "/alarm") != 0)
		return false;
	if (!below && (!strcmp(level, TOPIC_STATE) || !strcmp(level, TOPIC_HEALTH)))
		return false;
	snprintf(text, sizeof(text), "%.*s", below ? (int)(below - topic) : (int)strlen(topic),
	         topic);
	found = s->count ? bsearch(&wanted, s->by_topic, (size_t)s->count, sizeof(wanted), by_topic)
	                 : NULL;
	return !found || (below && !(*found)->alarms);
}

void stream_kept(struct stream *s, const char *topic, const char *text)
{
	size_t len = strlen(s->prefix);
	struct gone *more, gone;

	if (!s->live || !s->count || !*text)
		return;
	if (!strncmp(topic, s->prefix, len) && topic[len] == '/')
		text = is_gone(s, topic, len) ? "" : NULL;
	else
		text = s->profile->outlived ? s->profile->outlived(s, topic, text) : NULL;
	if (!text)
		return;
	if (s->gone_count == s->gone_room) {
		more = realloc(s->gone, (size_t)(s->gone_room + 64) * sizeof(*more));
		if (!more)
			return;
		s->gone = more;
		s->gone_room += 64;
	}
	gone = (struct gone){.topic = strdup(topic),
	                     .text = *text ? strndup(text, s->len) : strdup("")};
	if (gone.topic && gone.text) {
		s->gone[s->gone_count++] = gone;
	} else {
		free(gone.topic);
		free(gone.text);
	}
}

/* --- What has news --------------------------------------------------------------------------- */

static void queue_row(struct stream *s, int signal)
{
	struct row *row = &s->rows[signal];

	if (row->queued)
		return;
	row->queued = true;
	s->queue[(s->queue_at + s->queue_len++) % s->count] = signal;
}

void stream_changes(struct stream *s, const int *signals, int n)
{
	for (int i = 0; i < (signals ? n : s->count); i++)
		if (!signals || signals[i] < s->count)
			queue_row(s, signals ? signals[i] : i);
}

void stream_announce(struct stream *s)
{
	for (int i = 0; i < s->chip_count; i++)
		s->chips[i].announced = false;
	s->announced = false;
	s->birth = s->profile->birth ? 0 : -1;
}

void stream_begin(struct stream *s)
{
	free_gone(s);
	for (int i = 0; i < s->count; i++) {
		s->rows[i].published = false;
		s->rows[i].alarm_print = 0;
	}
	for (int i = 0; i < s->chip_count; i++)
		s->chips[i].published = false;
	free(s->health);
	s->health = NULL;
	s->online = !s->live;
	stream_announce(s);
	stream_changes(s, NULL, 0);
}

void stream_live(struct stream *s, bool live)
{
	if (s->live == live)
		return;
	s->live = live;
	s->online = !live;
	stream_changes(s, NULL, 0);
}

/* Who has the last value in mind unlearns it, and who comes later finds nothing. */
static bool pump_gone(struct stream *s)
{
	static const char none[] = "{\"v\":null,\"good\":false,\"q\":4,\"why\":\"not configured\"}";

	while (s->settled && s->gone_count) {
		struct gone *last = &s->gone[s->gone_count - 1];
		const char *topic = last->topic;
		size_t len = strlen(s->prefix);
		bool value = !strncmp(topic, s->prefix, len) && topic[len] == '/' &&
		             !strchr(topic + len + 1, '/');

		if ((value && !stream_put_text(s, topic, none, true)) ||
		    !stream_put_text(s, topic, last->text, true))
			return false;
		/* it names what is gone alone: what there is follows */
		if (*last->text)
			stream_announce(s);
		free(last->topic);
		free(last->text);
		s->gone_count--;
	}
	return true;
}

static bool pump_rows(struct stream *s)
{
	/* a row that gets news while it is published waits for the next call */
	for (int left = s->queue_len; left; left--) {
		struct row *row = &s->rows[s->queue[s->queue_at]];

		if (!s->profile->value(s, row))
			return false;
		row->queued = false;
		s->queue_at = (s->queue_at + 1) % s->count;
		s->queue_len--;
	}
	return true;
}

static bool pump_birth(struct stream *s)
{
	bool more = true;

	while (s->live && s->birth >= 0) {
		if (!s->profile->birth(s, s->birth, &more))
			return false;
		s->birth = more ? s->birth + 1 : -1;
	}
	return true;
}

/* The births of devices go before their values, and values before "the node is there". */
bool stream_pump(struct stream *s)
{
	if (!pump_gone(s))
		return false;
	if (!s->live && s->online) {
		if (!s->profile->state(s, false))
			return false;
		s->online = false;
	}
	/* a value may show that a chip is there, which has to be announced then */
	if (!pump_birth(s) || !pump_rows(s) || !pump_birth(s))
		return false;
	if (s->live && !s->online) {
		if (!s->profile->state(s, true))
			return false;
		s->online = true;
	}
	return true;
}
