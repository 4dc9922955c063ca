/* SPDX-License-Identifier: MIT */
/* The places of the signals, what is served of each, and what the news of owsd do to it. */
#include "src/faces/modbus/modbus.h"

#include <errno.h>
#include <math.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "src/faces/kit/look.h"
#include "src/faces/kit/loop.h"
#include "src/faces/show/newest.h"
#include "src/faces/show/stats.h"

#define HEART_NS (100 * NS_PER_MS)
/* Clients read the image themselves: of changes only the time of the newest is of use */
#define PACE_NS (500 * NS_PER_MS)
/* A map that cannot be read or written is tried again after that time */
#define AGAIN_NS (10 * NS_PER_S)

/* --- Rows ------------------------------------------------------------------------------------ */

static uint16_t alarm_of(struct ows *ows, int id)
{
	struct ows_alarm_state state = {0};
	int err = id < 0 ? -ENOENT : ows_alarm_state(ows, id, &state);
	bool limit = state.limit_state == OWS_LIMIT_UNACKNOWLEDGED ||
	             state.limit_state == OWS_LIMIT_ACKNOWLEDGED;
	bool wants = state.limit_state == OWS_LIMIT_UNACKNOWLEDGED ||
	             state.limit_state == OWS_LIMIT_RETURNED;

	if (err && err != -ESTALE)
		return 0;
	return (uint16_t)((limit ? LAYOUT_ALARM_LIMIT : 0) |
	                  (wants ? LAYOUT_ALARM_UNACKNOWLEDGED : 0) |
	                  (state.stands ? LAYOUT_ALARM_DEVICE : 0) |
	                  (state.shelved ? LAYOUT_ALARM_SHELVED : 0) | state.limit_kind << 8);
}

/* info: NULL where owsd has no such signal, or is not there. */
static void set_quality(struct layout_row *row, const struct ows_info *info, uint8_t quality)
{
	bool simulated = row->flags & LAYOUT_FLAG_SIMULATED;

	row->quality = quality;
	row->flags |= (info ? health_of_signal(info, quality, simulated) : quality_health(quality))
	              << LAYOUT_FLAG_HEALTH;
}

/* Of a signal that owsd has, and of one that it has no more or that nobody knows of now. */
static enum exception row_of(void *ctx, unsigned place, struct layout_row *row, bool *has)
{
	const struct modbus *m = ctx;
	struct face *face = m->face;
	const struct served *served = &m->served[place];
	int signal = m->map.places[place].signal;
	struct face_value value;
	struct ows_info info;

	if (!m->map.places[place].identity)
		return EXCEPTION_ADDRESS;
	*has = signal != MAP_NO_SIGNAL;
	*row = (struct layout_row){.age_ns = -1};
	if (!*has) {
		set_quality(row, NULL, OWS_Q_NO_PROPERTY);
		return EXCEPTION_NONE;
	}
	row->decimals = served->decimals;
	row->flags = served->flags;
	if (!face->live) {
		set_quality(row, NULL, OWS_Q_NO_OWSD);
		return EXCEPTION_NONE;
	}
	if (!look_is_current(face))
		return EXCEPTION_BUSY;
	face_value(face->ows, signal, true, m->now_ns, &value);
	row->good = value.good && isfinite(value.v.number);
	row->number = value.v.number;
	row->age_ns = value.v.measured_ns ? value.v.age_ns : -1;
	row->count = (uint16_t)value.v.count;
	row->flags |= value.simulated ? LAYOUT_FLAG_SIMULATED : 0;
	set_quality(row, ows_info(face->ows, signal, &info) ? NULL : &info, value.v.quality);
	row->alarm = alarm_of(face->ows, served->id);
	return EXCEPTION_NONE;
}

static int64_t utc_s(void)
{
	return clock_ns(CLOCK_REALTIME) / NS_PER_S;
}

static void header_of(void *ctx, uint16_t registers[LAYOUT_RECORD])
{
	struct modbus *m = ctx;
	struct ows_daemon daemon = {0};
	bool little = m->source.little;

	if (m->face->live && !ows_daemon(m->face->ows, m->now_ns, &daemon))
		m->heart = (uint16_t)((m->now_ns - daemon.beat_age_ns) / HEART_NS);
	memset(registers, 0, LAYOUT_RECORD * sizeof(*registers));
	layout_put_32(registers + LAYOUT_MAGIC, LAYOUT_MAGIC_NUMBER, little);
	registers[LAYOUT_VERSION] = 1;
	registers[LAYOUT_LIVE] = m->face->live && daemon.alive;
	registers[LAYOUT_HEART] = m->heart;
	registers[LAYOUT_GENERATION] = (uint16_t)m->generation;
	registers[LAYOUT_LAST] = (uint16_t)m->map.last;
	registers[LAYOUT_SIGNALS] = (uint16_t)m->signals;
	layout_put_32(registers + LAYOUT_CHANGED, (uint32_t)m->changed_s, little);
	layout_put_32(registers + LAYOUT_TIME, (uint32_t)utc_s(), little);
}

static enum exception write_to(void *ctx, unsigned place, double number)
{
	struct modbus *m = ctx;
	int signal = m->map.places[place].signal;
	enum exception wrong = writing_may(&m->writing, NULL, &m->client->from);
	struct ows_info info;

	if (wrong)
		return wrong;
	if (signal == MAP_NO_SIGNAL)
		return EXCEPTION_ADDRESS;
	if (!look_is_current(m->face) || ows_info(m->face->ows, signal, &info))
		return EXCEPTION_BUSY;
	wrong = writing_may(&m->writing, info.name, &m->client->from);
	return wrong ? wrong : writing_add(&m->writing, &info, number, &m->client->from);
}

static enum exception beat_of(void *ctx)
{
	struct modbus *m = ctx;

	m->beats = true;
	return writing_may(&m->writing, NULL, &m->client->from);
}

static enum exception commit(void *ctx)
{
	struct modbus *m = ctx;
	enum exception wrong = EXCEPTION_NONE;

	if (m->writing.count)
		wrong = writing_set(&m->writing, &m->client->from, m->client->came_ns);
	if (!wrong && m->beats)
		wrong = writing_heard(&m->writing, &m->client->from, m->client->came_ns, true);
	return wrong;
}

static size_t answer(void *ctx, const struct client *client, const uint8_t *request,
                     uint8_t answer[FRAME_MOST])
{
	struct modbus *m = ctx;
	size_t len;

	m->now_ns = ows_now();
	m->client = client;
	m->beats = false;
	m->writing.count = 0;
	writing_heard(&m->writing, &client->from, client->came_ns, false);
	len = frame_answer(&m->source, request, answer);
	m->refused += frame_refused(request, answer);
	return len;
}

/* --- Places ---------------------------------------------------------------------------------- */

/* To look a name up takes long where there are many. */
static int id_of(struct ows *ows, const struct ows_info *info)
{
	bool none = !info->alarm && isnan(info->limit_hh) && isnan(info->limit_h) &&
	            isnan(info->limit_l) && isnan(info->limit_ll);

	return none ? -1 : ows_find(ows, info->name);
}

/* False: it has no number, or no place is left. */
static bool place_signal(struct modbus *m, int signal)
{
	struct ows *ows = m->face->ows;
	struct ows_info info;
	int place;

	if (ows_info(ows, signal, &info) || info.type == OWS_STRING)
		return true;
	place = map_place(&m->map, info.identity);
	if (place < 0)
		return false;
	m->map.places[place].signal = signal;
	m->served[place].id = id_of(ows, &info);
	m->served[place].flags = info.output ? LAYOUT_FLAG_OUTPUT : 0;
	m->served[place].decimals = info.type == OWS_FLOAT || info.type == OWS_DOUBLE
	                                    ? (uint16_t)m->decimals
	                                    : 0;
	m->signals++;
	return true;
}

/*
 * The map belongs to one program alone; -EBUSY: to another one. A directory that is not there yet
 * is locked when the map is read or written in it.
 */
static int lock_map(struct modbus *m)
{
	char directory[sizeof(m->path)];

	if (m->lock >= 0 || !*m->path || history_make_above(m->path))
		return 0;
	memcpy(directory, m->path, sizeof(directory));
	*strrchr(directory, '/') = '\0';
	m->lock = history_lock(directory);
	return m->lock == -EBUSY ? m->lock : 0;
}

static bool is_ours(struct modbus *m)
{
	int err = lock_map(m);

	if (err && err != m->told)
		log_err(m->face->log,
		        "the map %s is kept by another owsd-modbus: no signal is served until that "
		        "has ended",
		        m->path);
	m->told = err ? err : m->told;
	return !err;
}

/* False: what is in the file is not known. */
static bool read_map(struct modbus *m, const char *path)
{
	unsigned line;
	int err = map_read(&m->map, path, &line);

	if (!err || (err == -ENOENT && path == m->path))
		return true;
	if (err != m->told)
		log_err(m->face->log,
		        "the map %s, line %u: %s: no signal is served until it can be read", path,
		        line, err == -EINVAL ? "no place and identity" : strerror(-err));
	m->told = err;
	return false;
}

static void keep_map(struct modbus *m)
{
	int err = *m->path ? history_make_above(m->path) : -ENOENT;

	if (!err)
		err = map_write(&m->map, m->path);
	m->kept = !err;
	if (err && err != m->told)
		log_err(m->face->log,
		        "the map %s cannot be written: %s: addresses may be others after the next "
		        "start",
		        m->path, strerror(-err));
	m->told = err;
}

/*
 * Places of the configuration win, then those that were given before, in the file and, as long as
 * it cannot be written, in memory; new ones are kept. With a map that cannot be read an address
 * could be that of another signal: then there is none.
 */
static void make_places(struct modbus *m)
{
	struct map before = m->map;
	const struct config_modbus *options = &m->face->config->modbus;
	const char *fixed = options->map;
	int count = m->face->ows ? ows_count(m->face->ows) : 0;
	unsigned left_out = 0, last;

	/* what is in memory has all that the file had */
	bool unkept = m->known && !m->kept;

	m->again_ns = ows_now() + AGAIN_NS;
	m->map = (struct map){0};
	m->signals = 0;
	m->known = !options->given || (is_ours(m) && (!fixed || read_map(m, fixed)) &&
	                               (!*m->path || read_map(m, m->path) || unkept));
	if (!m->known)
		map_free(&m->map);
	else if (!m->kept)
		map_join(&m->map, &before);
	map_free(&before);
	if (!m->known || !options->given)
		return;
	last = m->map.last;
	for (int i = 0; i < count; i++)
		left_out += !place_signal(m, i);
	if (left_out && !m->told)
		log_err(m->face->log, "%u signals have no address: there are %d", left_out,
		        LAYOUT_PLACES - 1);
	/* it has the fixed places, too: owsctl reads it */
	if (m->map.last != last || !m->kept || fixed)
		keep_map(m);
}

/* Nothing more can be done for the map. */
static bool is_well(const struct modbus *m)
{
	return m->known && (m->kept || !*m->path);
}

/* A disk that was full has room again, or what could not be read is mounted. */
static void try_again(struct modbus *m, int64_t now_ns)
{
	if (is_well(m) || now_ns < m->again_ns)
		return;
	m->again_ns = now_ns + AGAIN_NS;
	if (m->face->live && !look_is_current(m->face))
		return;
	make_places(m);
	if (!is_well(m))
		return;
	m->told = 0;
	log_notice(m->face->log, "the map %s is read and written: %u signals are served", m->path,
	           m->signals);
}

/* --- Of the face ----------------------------------------------------------------------------- */

static void show_status(struct modbus *m)
{
	if (!m->face->config->modbus.given)
		face_status(m->face, "nothing is served: there is no Modbus block");
	else
		face_status(m->face, "%u clients, %u signals%s", m->clients.count, m->signals,
		            m->face->live ? "" : ", owsd does not run");
}

static void run(struct modbus *m)
{
	int64_t now_ns = ows_now();

	m->face->tick_ns = earlier_ns(clients_tick(&m->clients, now_ns),
	                              writing_tick(&m->writing, now_ns));
	if (!is_well(m))
		m->face->tick_ns = earlier_ns(m->face->tick_ns, m->again_ns);
	show_status(m);
}

static void follow_file(struct modbus *m)
{
	const struct config_modbus *options = &m->face->config->modbus;

	if (!options->given && !m->idle)
		log_notice(m->face->log, "%s has no Modbus block: nothing is served",
		           m->face->arguments->file);
	m->idle = !options->given;
	m->told = 0;
	m->source.unit = options->unit;
	m->source.little = !strcmp(options->word_order, "little");
	m->source.exceptions = !strcmp(options->bad_value, "exception");
	m->decimals = options->decimals;
	clients_follow(&m->clients, options, ows_now());
}

int modbus_open(struct face *face)
{
	static struct modbus modbus;
	struct modbus *m = face->own = &modbus;
	int err;

	m->face = face;
	m->source.row = row_of;
	m->source.header = header_of;
	m->source.write = write_to;
	m->source.beat = beat_of;
	m->source.commit = commit;
	m->source.ctx = m->clients.ctx = m;
	m->clients.face = m->writing.face = face;
	m->clients.answer = answer;
	face->pace_ns = PACE_NS;
	m->lock = -1;
	if (map_path(face->arguments->instance, m->path))
		m->path[0] = '\0';
	if (lock_map(m)) {
		face_complain(face->ops->program, "another owsd-modbus serves %s: end it first",
		              face->arguments->instance);
		return -EBUSY;
	}
	err = clients_open(&m->clients);
	if (err) {
		face_complain(face->ops->program, "epoll: %s", strerror(-err));
		return err;
	}
	m->kept = true;
	follow_file(m);
	make_places(m);
	run(m);
	return 0;
}

void modbus_changes(struct face *face, const int *signals, int n)
{
	struct modbus *m = face->own;

	(void)signals, (void)n;
	m->changed_s = utc_s();
}

static void found(struct modbus *m)
{
	struct ows_daemon daemon = {0};

	ows_daemon(m->face->ows, ows_now(), &daemon);
	m->generation = daemon.generation;
	follow_file(m);
	make_places(m);
}

void modbus_event(struct face *face, const struct face_event *event)
{
	struct modbus *m = face->own;

	switch (event->news) {
	case FACE_FOUND:
	case FACE_RELOADED:
		found(m);
		break;
	case FACE_FILE:
		follow_file(m);
		make_places(m);
		break;
	case FACE_LOST:
		log_warning(face->log, "owsd is lost: no value is good");
		m->changed_s = utc_s();
		break;
	case FACE_DESCRIPTOR:
		clients_take(&m->clients);
		break;
	case FACE_OVERRUN:
	case FACE_ALARM:
	case FACE_COMMAND:
	case FACE_ENTRIES_LOST:
		return;
	}
	run(m);
}

void modbus_tick(struct face *face, int64_t now_ns)
{
	try_again(face->own, now_ns);
	run(face->own);
}

void modbus_report(struct face *face, FILE *out)
{
	const struct modbus *m = face->own;

	const struct {
		const char *name;
		uint64_t count;
	} counts[] = {
		{"requests", m->clients.requests},
		{"commands", m->writing.taken},
		{"refused", m->clients.refused + m->refused},
	};

	for (size_t i = 0; i < sizeof(counts) / sizeof(counts[0]); i++)
		fprintf(out, "count %s %llu\n", counts[i].name,
		        (unsigned long long)counts[i].count);
	if (!m->known || !m->kept)
		fprintf(out, "trouble the map of addresses cannot be %s\n",
		        m->known ? "written" : "read");
}

void modbus_close(struct face *face)
{
	struct modbus *m = face->own;

	clients_close(&m->clients);
	writing_close(&m->writing);
	map_free(&m->map);
	if (m->lock >= 0)
		close(m->lock);
}
