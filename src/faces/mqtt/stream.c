/* SPDX-License-Identifier: MIT */
/* The rows of an instance, and which of them have to be published. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/time.h"
#include "src/faces/mqtt/stream.h"
#include "src/ground/signal/hash.h"
#include "src/ground/signal/utf8.h"

#define REPEAT_MOST_NS (300 * NS_PER_S)

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

bool stream_put_below(struct stream *s, const char *below, const char *text)
{
	char topic[TOPIC_SIZE];

	snprintf(topic, sizeof(topic), "%.300s/%.200s", s->prefix, below);
	return text ? stream_put_text(s, topic, text, true) : stream_put(s, topic, true);
}

/* --- The value of a row ---------------------------------------------------------------------- */

int64_t stream_repeat_ns(const struct ows_info *info)
{
	int64_t ns = info->stale_after_ns / 2;

	return ns < REPEAT_MOST_NS ? ns : REPEAT_MOST_NS;
}

bool stream_read(struct stream *s, struct row *row, struct news *news)
{
	struct face_value *value = &news->value;
	int64_t repeat_ns = s->live ? stream_repeat_ns(&row->info) : 0;

	news->now_ns = ows_now();
	/* rows may be of an image that is no more: of an owsd that is lost none is read */
	face_value(s->live ? s->h : NULL, (int)(row - s->rows), s->live, news->now_ns, value);
	face_value_text(value);
	news->print = face_value_print(&value->v, value->text) ^ (uint64_t)value->simulated << 8;
	return !row->published || news->print != row->print ||
	       (repeat_ns && value->good && news->now_ns - row->published_ns >= repeat_ns);
}

bool stream_published(struct row *row, const struct news *news)
{
	row->published = true;
	row->good = news->value.good;
	row->quality = news->value.v.quality;
	row->simulated = news->value.simulated;
	row->print = news->print;
	row->published_ns = news->now_ns;
	return true;
}

void stream_value(struct stream *s, const struct news *news, const char *yes, const char *no)
{
	const char *text = news->value.text, *at;
	size_t len = strlen(text);

	rewind(s->out);
	if (news->value.v.type == OWS_BOOL) {
		fputs(news->value.v.integer ? yes : no, s->out);
		return;
	}
	while (len) {
		at = text;
		if (utf8_next(&text, &len) < 0)
			fputs("\xef\xbf\xbd", s->out);
		/* the conventions have no sign but '-' in a number: "1e+20" */
		else if (news->value.v.type == OWS_STRING || *at != '+')
			fwrite(at, 1, (size_t)(text - at), s->out);
	}
}

/* --- The rows -------------------------------------------------------------------------------- */

int stream_open(struct stream *s)
{
	s->out = open_memstream(&s->text, &s->len);
	s->birth = -1;
	return s->out ? 0 : -ENOMEM;
}

static void free_row(struct row *row)
{
	free(row->name);
	free(row->level);
	free(row->topic);
}

void stream_clear(struct stream *s)
{
	for (int i = 0; i < s->count; i++)
		free_row(&s->rows[i]);
	for (int i = 0; i < s->chip_count; i++)
		free(s->chips[i].topic);
	free(s->rows);
	free(s->chips);
	free(s->queue);
	free(s->by_topic);
	free(s->by_chip);
	free(s->parts);
	s->parts = NULL;
	s->by_topic = s->by_chip = NULL;
	s->rows = NULL;
	s->chips = NULL;
	s->queue = NULL;
	s->count = s->chip_count = s->queue_len = s->queue_at = 0;
}

static void free_gone(struct stream *s)
{
	for (int i = s->gone_at; i < s->gone_count; i++) {
		free(s->gone[i].topic);
		free(s->gone[i].text);
	}
	free(s->gone);
	s->gone = NULL;
	s->gone_at = s->gone_count = s->gone_room = 0;
}

void stream_close(struct stream *s)
{
	stream_clear(s);
	free_gone(s);
	free(s->health);
	s->health = NULL;
	if (s->out)
		fclose(s->out);
	free(s->text);
	s->out = NULL;
	s->text = NULL;
}

/* The device and the property that the row began with: others know it by them. */
static void identify(struct row *row)
{
	const struct ows_info *info = &row->info;
	const char *identity = info->identity;
	const char *device = *info->device ? strstr(identity, info->device) : NULL;
	size_t len = strlen(info->device);
	struct path path;
	uint8_t rom[ROM_LEN];

	if (!device && !path_split(identity, strlen(identity), &path) && path.has_rom) {
		device = path.last.text;
		len = path.last.len;
	}
	row->property = device ? device + len : identity;
	row->property += *row->property == '/';
	if (!*row->property)
		row->property = info->name;
	if (!rom_parse(device ? device : info->device, len, rom))
		rom_print(rom, ROM_F_I, row->chip_id);
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

static int by_level(const void *a, const void *b)
{
	return strcmp((*(struct row *const *)a)->level, (*(struct row *const *)b)->level);
}

static bool make_row(struct stream *s, int signal)
{
	struct row *row = &s->rows[signal];
	struct ows_alarm_state state = {0};
	char level[TOPIC_NAME];
	char dash = s->profile->dash;

	row->chip = -1;
	if (ows_info(s->h, signal, &row->info))
		return false;
	if (dash)
		topic_slug(row->info.name, dash, level, sizeof(level));
	else
		topic_escape(row->info.name, level);
	row->name = strdup(row->info.name);
	row->level = strdup(level);
	if (!row->name || !row->level)
		return false;
	identify(row);
	row->id = ows_find(s->h, row->info.name);
	row->alarms = row->id >= 0 && !ows_alarm_state(s->h, row->id, &state) && state.limits;
	row->class = s->class_of ? s->class_of(s->class_ctx, row->info.name) : "";
	s->by_topic[signal] = s->by_chip[signal] = row;
	return true;
}

/* Rows whose names have the same slug get a hash of the name behind it, and all their topics. */
static bool make_topics(struct stream *s)
{
	char topic[TOPIC_SIZE], dash = s->profile->dash;
	bool same = false, next;

	qsort(s->by_topic, (size_t)s->count, sizeof(struct row *), by_level);
	for (int i = 0; dash && i < s->count; i++, same = next) {
		struct row *row = s->by_topic[i];

		next = i + 1 < s->count && !by_level(&s->by_topic[i], &s->by_topic[i + 1]);
		/* a name that is its own slug keeps it */
		row->twin = (same || next) && strcmp(row->name, row->level) != 0;
	}
	for (int i = 0; i < s->count; i++) {
		struct row *row = &s->rows[i];

		if (row->twin) {
			snprintf(topic, sizeof(topic), "%s%c%c%016llx", row->level, dash, dash,
			         (unsigned long long)hash_text(HASH_BEGIN, row->name,
			                                       strlen(row->name)));
			free(row->level);
			row->level = strdup(topic);
		}
		if (!row->level)
			return false;
		s->profile->topic(s, row, topic);
		row->topic = strdup(topic);
		if (!row->topic)
			return false;
	}
	qsort(s->by_topic, (size_t)s->count, sizeof(struct row *), by_topic);
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
			if (asprintf(&chip->topic, "%s/" TOPIC_CHIP "/%s/" TOPIC_STATE, s->prefix,
			             row->chip_id) < 0) {
				chip->topic = NULL;
				return false;
			}
			s->chip_count++;
		}
		row->chip = s->chip_count - 1;
		s->chips[row->chip].rows++;
		s->chips[row->chip].inputs += !row->info.output;
	}
	return true;
}

static int by_id(const void *id, const void *chip)
{
	return strcmp(id, ((const struct chip *)chip)->id);
}

struct chip *stream_chip(const struct stream *s, const char *id)
{
	return s->chip_count
	               ? bsearch(id, s->chips, (size_t)s->chip_count, sizeof(*s->chips), by_id)
	               : NULL;
}

void stream_announce(struct stream *s, bool all)
{
	for (int i = 0; i < s->chip_count; i++) {
		struct chip *chip = &s->chips[i];

		chip->announced = chip->lent = false;
		if (all)
			chip->birth_print = 0;
	}
	if (all)
		s->birth_print = 0;
	s->announced = false;
	s->each = 0;
	s->birth = s->profile->birth ? 0 : -1;
}

/* All is to be published, but for births that the broker has. */
static void begin(struct stream *s)
{
	free_gone(s);
	for (int i = 0; i < s->count; i++) {
		s->rows[i].published = false;
		s->rows[i].alarm_print = 0;
		s->rows[i].born_ns = 0;
	}
	for (int i = 0; i < s->chip_count; i++) {
		s->chips[i].published = false;
		s->chips[i].problem_print = 0;
	}
	free(s->health);
	s->health = NULL;
	s->online = !s->live;
	stream_announce(s, false);
	stream_changes(s, NULL, 0);
}

void stream_begin(struct stream *s)
{
	begin(s);
	stream_announce(s, true);
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
	s->parts = calloc(2 * room + 2 + HEALTH_NUMBERS, sizeof(*s->parts));
	made = s->rows && s->parts && s->chips && s->queue && s->by_topic && s->by_chip;
	s->count = made ? count : 0;
	for (int i = 0; made && i < count; i++)
		made = make_row(s, i);
	if (made) {
		qsort(s->by_chip, (size_t)count, sizeof(struct row *), by_chip);
		made = make_chips(s) && make_topics(s);
	}
	for (int i = 0; made && i < old.chip_count; i++) {
		struct chip *chip = stream_chip(s, old.chips[i].id);

		if (!chip)
			continue;
		chip->seen = old.chips[i].seen;
		chip->birth_print = old.chips[i].birth_print;
	}
	if (!made)
		stream_clear(s);
	stream_clear(&old);
	begin(s);
	return made ? 0 : -ENOMEM;
}

/* --- Topics ---------------------------------------------------------------------------------- */

const char *stream_below(const char *topic, const char *prefix)
{
	size_t len = strlen(prefix);

	return !strncmp(topic, prefix, len) && topic[len] == '/' ? topic + len + 1 : NULL;
}

const struct row *stream_row(const struct stream *s, const char *topic, size_t len)
{
	char text[TOPIC_SIZE];
	struct row key = {.topic = text}, *wanted = &key, **found;

	snprintf(text, sizeof(text), "%.*s", (int)len, topic);
	found = s->count ? bsearch(&wanted, s->by_topic, (size_t)s->count, sizeof(wanted), by_topic)
	                 : NULL;
	return found ? *found : NULL;
}

enum stream_ask stream_command(const struct stream *s, const char *topic, const struct row **row,
                               char name[TOPIC_SIZE])
{
	const char *below = stream_below(topic, s->prefix),
		   *last = below ? strrchr(below, '/') : NULL;
	const char *commands = s->profile->commands, *asks = s->profile->asks;
	enum stream_ask ask = STREAM_NO_ASK;

	if (last && commands && !strcmp(last, strrchr(commands, '/')))
		ask = STREAM_SET;
	if (last && asks && !strcmp(last, strrchr(asks, '/')))
		ask = STREAM_GET;
	if (last && asks && !strcmp(last + 1, TOPIC_READ))
		ask = STREAM_READ;
	if (last && asks && !strcmp(last + 1, TOPIC_RENAME))
		ask = STREAM_RENAME;
	if (!ask)
		return ask;
	*row = stream_row(s, topic, (size_t)(last - topic));
	if (*row)
		snprintf(name, TOPIC_SIZE, "%s", (*row)->name);
	else
		snprintf(name, TOPIC_SIZE, "%.*s", (int)(last - below), below);
	return ask;
}

void stream_gone(struct stream *s, const char *topic, const char *text)
{
	struct gone *more, gone;

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

/* An update within Deadband is no change. */
void stream_repeat(struct stream *s, int64_t now_ns)
{
	for (int i = 0; s->live && !s->profile->session && i < s->count; i++) {
		const struct row *row = &s->rows[i];
		int64_t repeat_ns = stream_repeat_ns(&row->info);

		if (repeat_ns && row->published && row->good &&
		    now_ns - row->published_ns >= repeat_ns)
			queue_row(s, i);
	}
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
	while (s->settled && s->gone_at < s->gone_count) {
		struct gone *first = &s->gone[s->gone_at];
		const char *topic = first->topic, *below = stream_below(topic, s->prefix);
		bool value = s->profile->none && below && !strchr(below, '/');

		if ((value && !stream_put_text(s, topic, s->profile->none, true)) ||
		    !stream_put_text(s, topic, first->text, true))
			return false;
		/* it names what is gone, too, or made room: what there is follows */
		if (*first->text || (!below && s->profile->outlived))
			stream_announce(s, false);
		free(first->topic);
		free(first->text);
		s->gone_at++;
	}
	if (s->gone_at == s->gone_count)
		s->gone_at = s->gone_count = 0;
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
		if (!s->profile->state(s, STREAM_LOST))
			return false;
		s->online = false;
	}
	/* a value may show that a chip is there, which has to be announced then */
	if (!pump_birth(s) || !pump_rows(s) || !pump_birth(s))
		return false;
	if (s->live && !s->online) {
		if (!s->profile->state(s, STREAM_THERE))
			return false;
		s->online = true;
	}
	return true;
}
