/* SPDX-License-Identifier: MIT */
/* The rows of an instance, and which of them have to be published. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "src/mqtt/stream.h"

uint64_t stream_hash(const char *text, size_t len, uint64_t seed)
{
	uint64_t number = 0xcbf29ce484222325u ^ seed;

	for (size_t i = 0; i < len; i++)
		number = (number ^ (unsigned char)text[i]) * 0x100000001b3u;
	return number;
}

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
	bool taken = s->outlet.put(s->outlet.ctx, topic, text ? text : s->text,
	                           text ? strlen(text) : s->len, retain);

	s->published += taken;
	return taken;
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
	s->rows = NULL;
	s->chips = NULL;
	s->queue = NULL;
	s->count = s->chip_count = s->queue_len = s->queue_at = 0;
}

static void free_gone(struct stream *s)
{
	for (int i = 0; i < s->gone_count; i++)
		free(s->gone[i]);
	free(s->gone);
	s->gone = NULL;
	s->gone_count = 0;
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

/* The chip of a ROM id; a new one at the end. -1: no memory. */
static int chip_of(struct stream *s, const struct ows_info *info, int last)
{
	struct chip *chip;

	/* signals of a chip mostly stand together */
	if (last >= 0 && !strcmp(s->chips[last].id, info->device))
		return last;
	for (int i = 0; i < s->chip_count; i++)
		if (!strcmp(s->chips[i].id, info->device))
			return i;
	chip = &s->chips[s->chip_count];
	*chip = (struct chip){.id = info->device, .family = info->family};
	if (asprintf(&chip->topic, "%s/" TOPIC_CHIP "/%s", s->prefix, info->device) < 0) {
		chip->topic = NULL;
		return -1;
	}
	return s->chip_count++;
}

static bool make_row(struct stream *s, int signal, int *last)
{
	struct row *row = &s->rows[signal];
	struct ows_alarm_state state = {0};
	char level[TOPIC_NAME];

	row->chip = -1;
	if (ows_info(s->h, signal, &row->info))
		return false;
	topic_escape(row->info.name, level);
	if (asprintf(&row->topic, "%s/%s", s->prefix, level) < 0) {
		row->topic = NULL;
		return false;
	}
	row->id = ows_find(s->h, row->info.name);
	row->alarms = row->id >= 0 && !ows_alarm_state(s->h, row->id, &state) && state.limits;
	if (*row->info.device) {
		row->chip = *last = chip_of(s, &row->info, *last);
		if (row->chip < 0)
			return false;
		s->chips[row->chip].rows++;
	}
	return true;
}

/* The row of a topic; *at: where it may be found, and the next one then. NULL: there is none. */
static const struct row *row_of(const struct stream *s, const char *topic, int *at)
{
	for (int k = 0; k < s->count; k++) {
		const struct row *row = &s->rows[(*at + k) % s->count];

		if (!strcmp(row->topic, topic)) {
			*at = (int)(row - s->rows) + 1;
			return row;
		}
	}
	return NULL;
}

/* A topic that nobody writes any more, besides those that no broker has been told of yet. */
static void add_gone(struct stream *s, const char *topic, const char *level)
{
	char *text;

	if (asprintf(&text, "%s%s", topic, level) < 0)
		return;
	for (int i = 0; i < s->gone_count; i++)
		if (!strcmp(s->gone[i], text)) {
			free(text);
			return;
		}
	s->gone[s->gone_count++] = text;
}

/* What was said of rows that the new table has not; and of chips, which rows know to be seen. */
static void take_over(struct stream *s, struct stream *old)
{
	size_t room = (size_t)s->gone_count + 2 * (size_t)old->count;
	char **gone = room ? realloc(s->gone, room * sizeof(*gone)) : NULL;
	int at = 0;

	if (gone)
		s->gone = gone;
	for (int i = 0; gone && i < old->count; i++) {
		const struct row *was = &old->rows[i], *row = row_of(s, was->topic, &at);

		if (!row)
			add_gone(s, was->topic, "");
		if (was->alarms && (!row || !row->alarms))
			add_gone(s, was->topic, "/alarm");
	}
	for (int i = 0; i < old->chip_count; i++)
		for (int k = 0; k < s->chip_count; k++)
			if (!strcmp(old->chips[i].topic, s->chips[k].topic))
				s->chips[k].seen = old->chips[i].seen;
}

int stream_make(struct stream *s, struct ows *h)
{
	int count = ows_count(h), last = -1;
	struct stream old = {.rows = s->rows,
	                     .count = s->count,
	                     .chips = s->chips,
	                     .chip_count = s->chip_count,
	                     .queue = s->queue};
	size_t room = count > 0 ? (size_t)count : 1;
	bool made;

	s->h = h;
	s->chip_count = s->queue_at = s->queue_len = 0;
	s->rows = calloc(room, sizeof(*s->rows));
	s->chips = calloc(room, sizeof(*s->chips));
	s->queue = calloc(room, sizeof(*s->queue));
	s->count = s->rows && s->chips && s->queue ? count : 0;
	made = s->count == count;
	for (int i = 0; made && i < count; i++)
		made = make_row(s, i, &last);
	if (made)
		take_over(s, &old);
	else
		free_rows(s);
	free_rows(&old);
	stream_begin(s);
	return made ? 0 : -ENOMEM;
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
	s->birth = 0;
}

void stream_begin(struct stream *s)
{
	for (int i = 0; i < s->count; i++) {
		s->rows[i].said = false;
		s->rows[i].alarm_print = 0;
	}
	for (int i = 0; i < s->chip_count; i++)
		s->chips[i].said = false;
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

	while (s->gone_count) {
		const char *topic = s->gone[s->gone_count - 1];

		if (!stream_put_text(s, topic, none, true) || !stream_put_text(s, topic, "", true))
			return false;
		free(s->gone[--s->gone_count]);
	}
	return true;
}

static bool pump_rows(struct stream *s)
{
	/* a row that gets news while it is said waits for the next call */
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
