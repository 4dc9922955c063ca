/* SPDX-License-Identifier: MIT */
/*
 * The profile "sparkplug": an edge node of Sparkplug B 3.0. Each chip is a device, what has no chip
 * is a metric of the node.
 */
#include <ctype.h>
#include <inttypes.h>
#include <sparkplug.pb-c.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/time.h"
#include "src/faces/mqtt/health.h"
#include "src/faces/mqtt/plain.h"
#include "src/faces/show/when.h"
#include "src/ground/signal/utf8.h"
#include "src/ground/signal/value.h"

#define REBIRTH "Node Control/Rebirth"
#define REBOOT "Node Control/Reboot"
/* Data types, as chapter 6 numbers them */
enum {
	INT16 = 2,
	INT32 = 3,
	INT64 = 4,
	UINT8 = 5,
	UINT16 = 6,
	UINT32 = 7,
	FLOAT = 9,
	DOUBLE = 10,
	BOOLEAN = 11,
	STRING = 12
};
enum { GOOD = 192, BAD = 0, STALE = 500 };
/* An alias has the generation of the image, too: one of an earlier birth never is another signal.
   The first is that of bdSeq */
#define ALIAS_BITS 20
#define COMMAND_MOST 65536 /* bytes of a message */
#define COMMANDS_MOST 100
#define STAMP_OLD_MS 60000 /* of a command */

/* --- Payloads -------------------------------------------------------------------------------- */

struct out {
	ProtobufCBuffer base;
	FILE *file;
};

static void append(ProtobufCBuffer *buffer, size_t len, const uint8_t *bytes)
{
	fwrite(bytes, 1, len, ((struct out *)buffer)->file);
}

/* Payloads one behind the other are one with all their fields: so a birth needs no memory. */
static void pack(struct stream *s, const Spb__Payload *part)
{
	struct out out = {.base.append = append, .file = s->out};

	spb__payload__pack_to_buffer(part, &out.base);
}

static void put_metric(struct stream *s, Spb__Metric *metric)
{
	Spb__Payload part = SPB__PAYLOAD__INIT;
	struct part *one;

	part.n_metrics = 1;
	part.metrics = &metric;
	if (!s->parts) {
		pack(s, &part);
		return;
	}
	one = &s->parts[s->part_count++];
	one->time = metric->timestamp;
	one->at = ftell(s->out);
	pack(s, &part);
	one->len = ftell(s->out) - one->at;
}

static int by_time(const void *a, const void *b)
{
	const struct part *x = a, *y = b;

	return x->time != y->time ? (x->time > y->time) - (x->time < y->time)
	                          : (x->at > y->at) - (x->at < y->at);
}

/* The metrics of a message stand in the order of their time. False: no memory. */
static bool sort(struct stream *s)
{
	char *copy = NULL;

	if (s->part_count < 2)
		return true;
	if (!fflush(s->out))
		copy = malloc(s->len);
	if (!copy)
		return false;
	memcpy(copy, s->text, s->len);
	fseek(s->out, s->parts[0].at, SEEK_SET);
	qsort(s->parts, (size_t)s->part_count, sizeof(*s->parts), by_time);
	for (int i = 0; i < s->part_count; i++)
		fwrite(copy + s->parts[i].at, 1, (size_t)s->parts[i].len, s->out);
	free(copy);
	return true;
}

static uint64_t ms_of(int64_t wall_ns)
{
	return wall_ns > 0 ? (uint64_t)(wall_ns / NS_PER_MS) : 0;
}

static void sparkplug_begin(struct stream *s)
{
	Spb__Payload part = SPB__PAYLOAD__INIT;

	rewind(s->out);
	s->part_count = 0;
	part.has_timestamp = true;
	part.timestamp = ms_of(when_now().wall);
	pack(s, &part);
}

static bool sparkplug_put(struct stream *s, const char *topic)
{
	return !fflush(s->out) && s->outlet.put(s->outlet.ctx, topic, s->text, s->len, false);
}

/* NULL as chip: of the node. A number that was not taken comes again. */
static bool put_numbered(struct stream *s, const char *verb, const struct chip *chip)
{
	Spb__Payload part = SPB__PAYLOAD__INIT;
	char topic[TOPIC_SIZE];

	if (!sort(s))
		return false;
	part.has_seq = true;
	part.seq = s->seq;
	pack(s, &part);
	snprintf(topic, sizeof(topic), "%s/%s%s/%s%s%s", s->prefix, chip ? "D" : "N", verb, s->node,
	         chip ? "/" : "", chip ? chip->id : "");
	if (!sparkplug_put(s, topic))
		return false;
	s->seq++;
	return true;
}

/* --- Metrics --------------------------------------------------------------------------------- */

struct metric {
	Spb__Metric metric;
	Spb__PropertySet set;
	Spb__PropertyValue values[4], *list[4];
	char *keys[4];
	char name[256], unit[64];
};

/* protobuf-c writes into none of the texts that it packs. */
static char *lent(const char *text)
{
	return (char *)(uintptr_t)text;
}

/* A text of protobuf is UTF-8. */
static void clean(char *text)
{
	const char *at = text;
	size_t len = strlen(text);

	while (len) {
		char *begin_of = text + (at - text);

		if (utf8_next(&at, &len) < 0)
			*begin_of = '?';
	}
}

static Spb__PropertyValue *add_property(struct metric *m, const char *key, uint32_t type)
{
	size_t i = m->set.n_keys++;
	Spb__PropertyValue *value = &m->values[i];

	spb__property_value__init(value);
	value->has_type = true;
	value->type = type;
	m->keys[i] = lent(key);
	m->list[i] = value;
	m->set.n_values = m->set.n_keys;
	return value;
}

static void add_flag(struct metric *m, const char *key, bool flag)
{
	Spb__PropertyValue *value = add_property(m, key, BOOLEAN);

	value->value_case = SPB__PROPERTY_VALUE__VALUE_BOOLEAN_VALUE;
	value->boolean_value = flag;
}

static void add_quality(struct metric *m, uint8_t quality, bool simulated)
{
	Spb__PropertyValue *value = add_property(m, "Quality", INT32);

	value->value_case = SPB__PROPERTY_VALUE__VALUE_INT_VALUE;
	value->int_value = ows_good(quality) ? GOOD : quality == OWS_Q_STALE ? STALE : BAD;
	if (simulated)
		add_flag(m, "Simulated", true);
}

/* Its alias, 0: none, and its time. */
static void metric_begin(struct metric *m, uint64_t alias, int64_t wall_ns)
{
	spb__metric__init(&m->metric);
	spb__property_set__init(&m->set);
	m->set.keys = m->keys;
	m->set.values = m->list;
	m->metric.has_alias = alias;
	m->metric.alias = alias;
	m->metric.has_timestamp = true;
	m->metric.timestamp = ms_of(wall_ns);
}

/* What a birth has of it. */
static void metric_describe(struct metric *m, const char *name, uint32_t datatype)
{
	snprintf(m->name, sizeof(m->name), "%s", name);
	clean(m->name);
	m->metric.name = m->name;
	m->metric.has_datatype = true;
	m->metric.datatype = datatype;
}

static void metric_put(struct stream *s, struct metric *m)
{
	if (m->set.n_keys)
		m->metric.properties = &m->set;
	put_metric(s, &m->metric);
}

static void set_bool(struct metric *m, bool value)
{
	m->metric.value_case = SPB__METRIC__VALUE_BOOLEAN_VALUE;
	m->metric.boolean_value = value;
}

static void set_long(struct metric *m, int64_t value)
{
	m->metric.value_case = SPB__METRIC__VALUE_LONG_VALUE;
	m->metric.long_value = (uint64_t)value;
}

static uint32_t datatype_of(uint8_t type)
{
	switch ((enum ows_type)type) {
	case OWS_BOOL:
		return BOOLEAN;
	case OWS_BYTE:
		return UINT8;
	case OWS_SHORT:
		return INT16;
	case OWS_LONG:
		return INT32;
	case OWS_WORD:
		return UINT16;
	case OWS_DWORD:
		return UINT32;
	case OWS_FLOAT:
		return FLOAT;
	case OWS_DOUBLE:
		return DOUBLE;
	case OWS_LARGE:
		return INT64;
	case OWS_STRING:
		return STRING;
	}
	return STRING;
}

/* A bad value has no number. */
static void set_value(struct metric *m, const struct ows_value *v, uint8_t type, char *text)
{
	Spb__Metric *metric = &m->metric;
	uint32_t datatype = datatype_of(type);

	if (!ows_good(v->quality)) {
		metric->has_is_null = metric->is_null = true;
		return;
	}
	switch (datatype) {
	case BOOLEAN:
		set_bool(m, v->integer != 0);
		return;
	case FLOAT:
		metric->value_case = SPB__METRIC__VALUE_FLOAT_VALUE;
		metric->float_value = (float)v->number;
		return;
	case DOUBLE:
		metric->value_case = SPB__METRIC__VALUE_DOUBLE_VALUE;
		metric->double_value = v->number;
		return;
	case INT64:
		set_long(m, v->integer);
		return;
	case STRING:
		clean(text);
		metric->value_case = SPB__METRIC__VALUE_STRING_VALUE;
		metric->string_value = text;
		return;
	default:
		metric->value_case = SPB__METRIC__VALUE_INT_VALUE;
		metric->int_value = datatype == INT16 ? (uint16_t)v->integer : (uint32_t)v->integer;
	}
}

static uint64_t first_alias(const struct stream *s)
{
	struct ows_daemon daemon = {0};

	ows_daemon(s->h, ows_now(), &daemon); /* it is filled for an old image, too */
	return ((uint64_t)daemon.generation << ALIAS_BITS) + 1;
}

static void add_description(struct metric *m, const struct ows_info *info)
{
	Spb__PropertyValue *value;

	metric_describe(m, info->name, datatype_of(info->type));
	add_flag(m, "readOnly", !info->output);
	if (!*info->unit)
		return;
	snprintf(m->unit, sizeof(m->unit), "%s", info->unit);
	clean(m->unit);
	value = add_property(m, "engUnit", STRING);
	value->value_case = SPB__PROPERTY_VALUE__VALUE_STRING_VALUE;
	value->string_value = m->unit;
}

/* What has not changed is not published again, however old it is. */
static bool is_new(const struct row *row, const struct news *news)
{
	return !row->published || news->print != row->print;
}

/* Of a limit alarm, as row.alarm_print has it: one that nobody knows is null. */
enum { LIMIT_UNKNOWN = 1, LIMIT_RESTS, LIMIT_STANDS };

static uint32_t limit_of(const struct stream *s, const struct row *row)
{
	struct ows_alarm_state state;

	if (!plain_limit(s, row, &state))
		return LIMIT_UNKNOWN;
	return plain_stands(&state) ? LIMIT_STANDS : LIMIT_RESTS;
}

static bool has_news(const struct stream *s, const struct row *row, const struct news *news)
{
	return is_new(row, news) || (row->alarms && limit_of(s, row) != row->alarm_print);
}

/* NAME/Alarm beside NAME: whether its limit alarm stands. Its alias is behind those of all rows. */
static bool put_limit(struct stream *s, struct row *row, uint64_t alias, bool data)
{
	uint32_t limit = limit_of(s, row);
	bool known = limit != LIMIT_UNKNOWN;
	struct metric m;
	char name[256];

	if (!row->alarms || (data && limit == row->alarm_print))
		return false;
	metric_begin(&m, alias + (uint64_t)(s->count + (row - s->rows)), when_now().wall);
	add_quality(&m, known ? OWS_Q_GOOD : OWS_Q_NO_OWSD, known && row->simulated);
	if (!data) {
		snprintf(name, sizeof(name), "%.240s/Alarm", row->info.name);
		metric_describe(&m, name, BOOLEAN);
		add_flag(&m, "readOnly", true);
	}
	m.metric.has_is_null = m.metric.is_null = !known;
	if (known)
		set_bool(&m, limit == LIMIT_STANDS);
	metric_put(s, &m);
	row->alarm_print = limit;
	return true;
}

/* A row as it is now. data: only if it is another than was published, and by its alias alone. */
static bool put_row(struct stream *s, struct row *row, uint64_t alias, bool data)
{
	struct when now = when_now();
	struct news news;
	struct metric m;

	stream_read(s, row, &news);
	if (data && !is_new(row, &news))
		return put_limit(s, row, alias, data);
	row->moment_ns = face_value_time(&news.value.v, now.boot);
	row->told = face_value_print(&news.value.v, news.value.text);
	if (!data && s->clock_set && !row->born_ns)
		row->born_ns = row->moment_ns;
	metric_begin(&m, alias + (uint64_t)(row - s->rows), row->moment_ns + now.wall - now.boot);
	add_quality(&m, news.value.v.quality, news.value.simulated);
	if (!data)
		add_description(&m, &row->info);
	set_value(&m, &news.value.v, row->info.type, news.value.text);
	metric_put(s, &m);
	stream_published(row, &news);
	put_limit(s, row, alias, data);
	return true;
}

/* All rows of a chip, NULL: without one; data: those of them that wait and have changed. */
static bool put_rows(struct stream *s, const struct chip *chip, bool data)
{
	uint64_t alias = first_alias(s);
	int first = chip ? chip->first : 0, index = chip ? (int)(chip - s->chips) : -1;
	bool any = false;

	for (int i = first; i < s->count && s->by_chip[i]->chip == index; i++)
		if (!data || s->by_chip[i]->queued)
			any = put_row(s, s->by_chip[i], alias, data) || any;
	return any;
}

/* --- Births and deaths ----------------------------------------------------------------------- */

/* alias: 0 for none. */
static void put_bdseq(struct stream *s, uint64_t alias)
{
	struct metric m;

	metric_begin(&m, alias, when_now().wall);
	metric_describe(&m, "bdSeq", INT64);
	set_long(&m, s->bdseq);
	metric_put(s, &m);
}

static void put_rebirth(struct stream *s)
{
	struct metric m;

	metric_begin(&m, 0, when_now().wall);
	metric_describe(&m, REBIRTH, BOOLEAN);
	set_bool(&m, false);
	metric_put(s, &m);
}

/* Metrics of the node, with aliases behind those of all rows; data: those that have changed. */
static bool put_health(struct stream *s, bool data)
{
	static const char *const names[HEALTH_NUMBERS] = {
		[HEALTH_DOWN] = "Health/Targets Down",
		[HEALTH_BAD] = "Health/Signals Not Good",
		[HEALTH_ERRORS] = "Health/Errors",
		[HEALTH_RECONNECTS] = "Health/Reconnects",
	};
	int64_t numbers[HEALTH_NUMBERS];
	bool any = false;

	health_count(s, numbers);
	for (int i = 0; i < HEALTH_NUMBERS; i++) {
		struct metric m;

		if (data && numbers[i] == s->numbers[i])
			continue;
		metric_begin(&m, first_alias(s) + (uint64_t)(2 * s->count + i), when_now().wall);
		set_long(&m, numbers[i]);
		if (!data) {
			metric_describe(&m, names[i], INT64);
			add_flag(&m, "readOnly", true);
		}
		metric_put(s, &m);
		any = true;
		s->numbers[i] = numbers[i];
	}
	return any;
}

static bool numbers(struct stream *s)
{
	int64_t before[HEALTH_NUMBERS];

	if (!s->announced)
		return true;
	memcpy(before, s->numbers, sizeof(before));
	sparkplug_begin(s);
	if (!put_health(s, true) || put_numbered(s, "DATA", NULL))
		return true;
	memcpy(s->numbers, before, sizeof(before));
	return false;
}

static bool birth_of_node(struct stream *s)
{
	struct news news;

	/* which chips are there is to be known before the devices are born */
	for (int i = 0; i < s->count; i++) {
		stream_read(s, &s->rows[i], &news);
		plain_chip_look(s, &s->rows[i], news.value.v.quality);
	}
	s->seq = 0;
	sparkplug_begin(s);
	put_bdseq(s, first_alias(s) - 1);
	put_rebirth(s);
	put_health(s, false);
	put_rows(s, NULL, false);
	s->announced = put_numbered(s, "BIRTH", NULL);
	s->born = s->born || s->announced;
	return s->announced;
}

static bool birth(struct stream *s, int number, bool *more)
{
	struct chip *chip;

	*more = number < s->chip_count;
	if (!number && !s->announced && s->host && !s->host_there)
		return false;
	if (!number)
		return s->announced || birth_of_node(s);
	chip = &s->chips[number - 1];
	if (chip->announced || !chip->seen || !plain_chip_there(s, chip))
		return true;
	sparkplug_begin(s);
	put_rows(s, chip, false);
	chip->announced = put_numbered(s, "BIRTH", chip);
	return chip->announced;
}

/* The null of a value that is lost goes before the death of its device. */
static bool value(struct stream *s, struct row *row)
{
	struct chip *chip = row->chip < 0 ? NULL : &s->chips[row->chip];
	struct news news;

	if (!s->announced)
		return true;
	stream_read(s, row, &news);
	plain_chip_look(s, row, news.value.v.quality);
	if (chip && !chip->announced) {
		if (chip->seen && plain_chip_there(s, chip))
			s->birth = 0;
		return true;
	}
	if (has_news(s, row, &news)) {
		sparkplug_begin(s);
		if (put_rows(s, chip, true) && !put_numbered(s, "DATA", chip)) {
			for (int i = 0; i < s->count; i++)
				if (s->rows[i].chip == row->chip && s->rows[i].queued) {
					s->rows[i].published = false;
					s->rows[i].alarm_print = 0;
				}
			return false;
		}
	}
	if (!chip || plain_chip_there(s, chip) || (chip->lent && s->live))
		return true;
	sparkplug_begin(s);
	chip->announced = !put_numbered(s, "DEATH", chip);
	return !chip->announced;
}

/*
 * Data needs a device that is born: a chip that is away, and was there then, is born for it once,
 * with what it is now, and dies when no more follows. Of one that was not there either nothing is
 * to be said.
 */
static bool sparkplug_past(struct stream *s, const struct past_value *values, int n)
{
	uint64_t alias = first_alias(s);
	struct chip *chip = values->row->chip < 0 ? NULL : &s->chips[values->row->chip];
	struct part *parts = s->parts;

	if (chip && !chip->announced) {
		int bad = 0;

		while (bad < n && !ows_good(values[bad].v.quality))
			bad++;
		if (bad == n && !chip->filled)
			return true;
		sparkplug_begin(s);
		put_rows(s, chip, false);
		chip->announced = put_numbered(s, "BIRTH", chip);
		if (!chip->announced)
			return false;
		chip->filled = chip->lent = true;
	}
	sparkplug_begin(s);
	s->parts = NULL; /* they are in their order, and may be more than there are rows */
	for (int i = 0; i < n; i++) {
		const struct past_value *value = &values[i];
		struct metric m;

		metric_begin(&m, alias + (uint64_t)(value->row - s->rows), value->wall_us * 1000);
		m.metric.has_is_historical = m.metric.is_historical = true;
		add_quality(&m, value->v.quality, value->row->simulated);
		set_value(&m, &value->v, value->row->info.type, value->text);
		metric_put(s, &m);
	}
	s->parts = parts;
	return put_numbered(s, "DATA", chip);
}

/* That owsd is lost the values say, and deaths of devices. */
static bool sparkplug_state(struct stream *s, enum stream_node node)
{
	char topic[TOPIC_SIZE];

	if (node == STREAM_THERE || node == STREAM_LOST)
		return true;
	sparkplug_begin(s);
	put_bdseq(s, 0);
	snprintf(topic, sizeof(topic), "%s/NDEATH/%s", s->prefix, s->node);
	return sparkplug_put(s, topic);
}

/* --- The primary host ------------------------------------------------------------------------ */

static void listen_host(const struct stream *s, char topic[TOPIC_SIZE])
{
	snprintf(topic, TOPIC_SIZE, "spBv1.0/STATE/%.64s", s->host);
}

/* The value of a member of an object without others in it; "": there is none. */
static const char *member(const char *text, const char *key)
{
	const char *at = strstr(text, key), *blank = " \t\r\n";

	if (!at)
		return "";
	at += strlen(key);
	at += strspn(at, blank);
	return *at == ':' ? at + 1 + strspn(at + 1, blank) : "";
}

/*
 * {"online":true,"timestamp":1700000000000}. One that is older than the last of this connection
 * does not count. "offline" ends a session, whatever comes next.
 */
static bool heard(struct stream *s, const char *topic, const char *text, size_t len)
{
	const char *online = member(text, "\"online\""), *time = member(text, "\"timestamp\"");
	bool there = !strncmp(online, "true", 4);
	char state[TOPIC_SIZE];
	uint64_t ms;

	(void)len;
	if (!s->host || (!there && strncmp(online, "false", 5) != 0) ||
	    !isdigit((unsigned char)*time))
		return false;
	listen_host(s, state);
	ms = strtoull(time, NULL, 10);
	if (strcmp(topic, state) != 0 || ms < s->host_ms)
		return false;
	s->host_ms = ms;
	s->host_there = there && (s->host_there || !s->born);
	return false;
}

/* --- Commands -------------------------------------------------------------------------------- */

static void listen(const struct stream *s, char topic[TOPIC_SIZE])
{
	snprintf(topic, TOPIC_SIZE, "%s/NCMD/%s", s->prefix, s->node);
}

static void listen_write(const struct stream *s, char topic[TOPIC_SIZE])
{
	snprintf(topic, TOPIC_SIZE, "%s/DCMD/%s/+", s->prefix, s->node);
}

/* Some write 16 bits of a negative number, and some all. */
static int64_t signed_of(uint32_t value, uint32_t datatype)
{
	if (datatype == INT16 && value <= UINT16_MAX)
		return (int16_t)value;
	return datatype == INT16 || datatype == INT32 ? (int64_t)(int32_t)value : (int64_t)value;
}

/* The value as a text for the type of the birth; NULL: it is of another. */
static const char *text_of(const Spb__Metric *metric, uint8_t type, char text[VALUE_TEXT_MAX])
{
	uint32_t datatype = datatype_of(type);
	bool whole = datatype < FLOAT;

	if (metric->has_datatype && metric->datatype != datatype)
		return NULL;
	switch (metric->value_case) {
	case SPB__METRIC__VALUE_BOOLEAN_VALUE:
		return datatype != BOOLEAN ? NULL : metric->boolean_value ? "1" : "0";
	case SPB__METRIC__VALUE_STRING_VALUE:
		return datatype == STRING ? metric->string_value : NULL;
	case SPB__METRIC__VALUE_FLOAT_VALUE:
	case SPB__METRIC__VALUE_DOUBLE_VALUE:
		if (datatype != FLOAT && datatype != DOUBLE)
			return NULL;
		value_to_text(OWS_DOUBLE,
		              value_of_double(metric->value_case == SPB__METRIC__VALUE_FLOAT_VALUE
		                                      ? (double)metric->float_value
		                                      : metric->double_value),
		              text);
		return text;
	case SPB__METRIC__VALUE_INT_VALUE:
		snprintf(text, VALUE_TEXT_MAX, "%" PRId64, signed_of(metric->int_value, datatype));
		return whole ? text : NULL;
	case SPB__METRIC__VALUE_LONG_VALUE:
		snprintf(text, VALUE_TEXT_MAX, "%" PRId64, (int64_t)metric->long_value);
		return whole ? text : NULL;
	default:
		return NULL;
	}
}

/* The row that a metric names, of the chip or of none; NULL: it has none. */
static const struct row *row_of(const struct stream *s, const Spb__Metric *metric, int chip)
{
	uint64_t index = metric->alias - first_alias(s);

	if (metric->has_alias)
		return index < (uint64_t)s->count && s->rows[index].chip == chip ? &s->rows[index]
		                                                                 : NULL;
	for (int i = 0; metric->name && i < s->count; i++)
		if (s->rows[i].chip == chip && !strcmp(s->rows[i].info.name, metric->name))
			return &s->rows[i];
	return NULL;
}

/* By the clock of the sender, which counts where ours is right; one that is ahead is wrong. */
static bool is_old(const struct stream *s, bool stamped, uint64_t stamp_ms)
{
	uint64_t now_ms = ms_of(when_now().wall);

	return s->clock_right && stamped && stamp_ms < now_ms && now_ms - stamp_ms > STAMP_OLD_MS;
}

/* old: the message is. */
static void sparkplug_command(const struct stream *s, const Spb__Metric *metric, int chip, bool old,
                              stream_take *take, void *ctx)
{
	const struct row *row = row_of(s, metric, chip);
	char buffer[VALUE_TEXT_MAX];
	const char *text;

	if (!row) {
		snprintf(buffer, sizeof(buffer), "alias %" PRIu64, metric->alias);
		take(ctx, metric->name ? metric->name : buffer, "",
		     "the last birth has no such metric there");
		return;
	}
	text = text_of(metric, row->info.type, buffer);
	take(ctx, row->info.name, text ? text : "",
	     old || is_old(s, metric->has_timestamp, metric->timestamp)
	             ? "its time stamp is more than a minute old: look at the clock of the sender"
	     : metric->has_is_null && metric->is_null ? "it is null"
	     : text                                   ? NULL
	                                              : "its datatype is not that of the birth");
}

static bool take_all(struct stream *s, const char *topic, const char *text, size_t len,
                     stream_take *take, void *ctx)
{
	size_t prefix_len = strlen(s->prefix);
	const char *device = strncmp(topic + prefix_len, "/DCMD/", 6) == 0 ? strrchr(topic, '/') + 1
	                                                                   : NULL;
	const struct chip *chip = device ? stream_chip(s, device) : NULL;
	Spb__Payload *payload;
	bool again = false;

	payload = len > COMMAND_MOST ? NULL
	                             : spb__payload__unpack(NULL, len, (const uint8_t *)text);
	if (!payload || payload->n_metrics > COMMANDS_MOST) {
		take(ctx, device ? device : s->node, "",
		     payload ? "more than 100 metrics" : "no payload of Sparkplug B");
		if (payload)
			spb__payload__free_unpacked(payload, NULL);
		return false;
	}
	for (size_t i = 0; i < payload->n_metrics; i++) {
		const Spb__Metric *metric = payload->metrics[i];

		if (!device && metric->name && !strcmp(metric->name, REBIRTH))
			again = again || (metric->value_case == SPB__METRIC__VALUE_BOOLEAN_VALUE &&
			                  metric->boolean_value);
		else if (!device && metric->name && !strcmp(metric->name, REBOOT))
			take(ctx, REBOOT, "",
			     "nothing restarts a plant over a broker: systemctl restart owsd-mqtt "
			     "on the machine itself");
		else
			sparkplug_command(s, metric,
			                  chip     ? (int)(chip - s->chips)
			                  : device ? s->chip_count /* none has that */
			                           : -1,
			                  is_old(s, payload->has_timestamp, payload->timestamp),
			                  take, ctx);
	}
	spb__payload__free_unpacked(payload, NULL);
	return again;
}

const struct profile profile_sparkplug = {
	.name = "sparkplug",
	.root = "spBv1.0/",
	.session = true,
	.topic = plain_topic,
	.birth = birth,
	.value = value,
	.state = sparkplug_state,
	.past = sparkplug_past,
	.numbers = numbers,
	.listen = listen,
	.listen_host = listen_host,
	.listen_write = listen_write,
	.heard = heard,
	.take = take_all,
};
