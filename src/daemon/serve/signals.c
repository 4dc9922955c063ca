/* SPDX-License-Identifier: MIT */
/* The table as /signals of the served protocol: read and set by name. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "src/daemon/serve/signals.h"
#include "src/ground/signal/value.h"
#include "src/memory/libows/alive.h"
#include "src/memory/libows/command.h"
#include "src/memory/libows/get.h"
#include "src/memory/libows/handle.h"
#include "src/memory/libows/map.h"
#include "src/memory/libows/meet.h"
#include "src/memory/libows/open.h"
#include "src/memory/libows/set.h"
#include "src/memory/shm/reader.h"

#define NAME "owserver protocol" /* of the controller that the clients of the protocol are */
/* owsd's own control room answers at once, if it is not busy. */
#define MEET_NS (20 * INT64_C(1000000))

/*
 * How many alarms of a signal clients have read. The key is the name: a reload changes the record.
 */
struct seen {
	char name[SIGNAL_NAME_MAX + 1];
	uint32_t alarms;
};

struct signals {
	struct ows *h;
	struct seen *seen; /* one entry for each signal with an alarm */
	size_t seen_count, seen_room;
};

/* Make room for all alarms. Without memory clients see an alarm again rather than never. */
static void room_for_alarms(struct signals *signals)
{
	const struct ows_map *map = &signals->h->map;
	size_t items = signals->seen_count;
	struct seen *grown;

	for (uint32_t record = 1; record < map->count; record++)
		items += (map_record(map, record)->flags & OWS_RECORD_ALARM) != 0;
	if (items <= signals->seen_room)
		return;
	grown = realloc(signals->seen, items * sizeof(*grown));
	if (!grown)
		return;
	signals->seen = grown;
	signals->seen_room = items;
}

/*
 * Open the new image after a reload; until the reload is done the old image is the right one. Where
 * owsd has no seat for who commands, reading goes on without, and the next command asks for one.
 */
static void signals_follow(struct signals *signals)
{
	int err = handle_state(signals->h) ? ows_reopen(signals->h) : -ENOENT;

	if (err && err != -ENOENT) {
		meet_leave(signals->h);
		err = ows_reopen(signals->h);
	}
	if (!err)
		room_for_alarms(signals);
}

int signals_open(const char *dir, const char *instance, struct signals **out)
{
	struct signals *signals = calloc(1, sizeof(*signals));
	int err = signals ? open_in(dir, instance, OWS_READ, NAME, &signals->h) : -ENOMEM;

	/* _DGNRESET is the only name for which a handle keeps state; it is reset for each client */
	if (!err && ows_find(signals->h, "_DGNRESET") < 0)
		err = -ENOMEM;
	if (err) {
		signals_close(signals);
		return err;
	}
	signals->h->mode = OWS_CONTROL;
	room_for_alarms(signals);
	*out = signals;
	return 0;
}

void signals_close(struct signals *signals)
{
	if (!signals)
		return;
	ows_close(signals->h);
	free(signals->seen);
	free(signals);
}

static int look_up(struct signals *signals, const char *name, struct ows_id *id)
{
	struct ows *h = signals->h;
	int record;

	signals_follow(signals);
	record = attribute_lookup(h->instance, name, map_find, &h->map, &id->attribute);
	if (record < 0)
		return -ENOENT;
	id->name = NULL;
	id->record = record;
	id->memory = 0;
	id->stale_after_ns = map_info(&h->map, record)->stale_after_ns;
	h->memories[0].alarms_seen = 0;
	h->memories[0].reset_level = h->memories[0].shot_level = false;
	h->memories[0].read_level = false;
	return 0;
}

int signals_record(struct signals *signals, const char *name)
{
	struct ows_id id;

	return look_up(signals, name, &id) ? -1 : id.record;
}

const char *signals_name(struct signals *signals, const char *name)
{
	struct ows_id id;

	if (look_up(signals, name, &id))
		return NULL;
	return id.record ? map_name(&signals->h->map, (uint32_t)id.record) : "";
}

/* Clients come and go, so all of them are one reader; `seen` has what this reader has read. */
static bool are_news(struct signals *signals, const char *name, uint32_t alarms)
{
	struct seen *seen = signals->seen;
	size_t i = 0;
	bool news;

	while (i < signals->seen_count && strcmp(seen[i].name, name) != 0)
		i++;
	news = i < signals->seen_count ? seen[i].alarms != alarms : alarms != 0;
	if (i == signals->seen_count && news && i < signals->seen_room &&
	    strlen(name) <= SIGNAL_NAME_MAX) {
		memcpy(seen[i].name, name, strlen(name) + 1);
		signals->seen_count++;
	}
	if (i < signals->seen_count)
		seen[i].alarms = alarms;
	return news;
}

static int read_alarms(struct signals *signals, const struct ows_id *id, char *text, size_t room)
{
	const struct ows_map *map = &signals->h->map;
	struct ows_slot slot;

	if (!reader_slot(map_record(map, (uint32_t)id->record), &slot))
		return -EIO;
	if (room < 1)
		return -EMSGSIZE;
	*text = are_news(signals, map_name(map, (uint32_t)id->record), slot.attrs.alarms) ? '1'
	                                                                                  : '0';
	return 1;
}

int signals_read(struct signals *signals, const char *name, int64_t now_ns, char *text, size_t room)
{
	struct ows_value value;
	struct ows_id id;
	int err = look_up(signals, name, &id);

	if (err)
		return err;
	if (id.attribute == ATTR_ALARM)
		return read_alarms(signals, &id, text, room);
	err = handle_get_text(signals->h, &id, now_ns, &value, text, room);
	if (err == -EACCES)
		return err;
	if (err == -ENOSPC)
		return -EMSGSIZE;
	if ((err && err != -ESTALE) || !ows_good(value.quality))
		return -EIO;
	return value.type == OWS_STRING ? (int)value.len : (int)strlen(text);
}

/*
 * Ignore the end of the string, which some clients send along, and of a number blanks and the end
 * of the line, which a shell adds.
 */
static int take_text(const char *text, size_t len, bool is_string, char out[VALUE_STRING_MAX + 1])
{
	while (len && text[len - 1] == '\0')
		len--;
	if (memchr(text, '\0', len))
		return -EINVAL;
	while (!is_string && len && strchr(" \t\r\n", text[len - 1]))
		len--;
	while (!is_string && len && *text == ' ') {
		text++;
		len--;
	}
	if (len > VALUE_STRING_MAX)
		return -EOVERFLOW;
	memcpy(out, text, len);
	out[len] = '\0';
	return 0;
}

/* An output takes commands only while it is enabled for writing. */
static bool takes_commands(const struct ows *h, const struct ows_id *id)
{
	struct ows_slot slot;

	return id->attribute != ATTR_VALUE ||
	       (reader_slot(map_record(&h->map, (uint32_t)id->record), &slot) &&
	        slot.attrs.flags & OWS_ATTR_WRITE_ENABLE);
}

/* The welcome has not come yet, or the next memory: the client waits, and it is tried again. */
static int not_yet(int err)
{
	return err == -EAGAIN || err == -ETIMEDOUT || err == -ENOENT ? -EBUSY : err;
}

/* Become a controller, at the first write: when owsd starts its control room is not open yet. */
static int become_controller(struct ows *h)
{
	int err = h->give.base ? 0 : meet(h, &h->map, ows_now() + MEET_NS);

	if (!err)
		meet_take(h);
	return not_yet(err);
}

/*
 * All clients are one controller, with one command for each signal: that of another client may only
 * be replaced after owsd has entered the person of that command.
 */
static int command_for(struct ows *h, const struct ows_id *id, const char *person)
{
	const struct ows_command_slot *own = give_slot(&h->give, (uint32_t)id->record);

	if (__atomic_load_n(&own->taken, __ATOMIC_ACQUIRE) != word_get(&own->stamp) &&
	    command_ready(h) == 0)
		return -EBUSY;
	return ows_for(h, person);
}

static int signals_set(struct signals *signals, const char *person, struct ows_id *id,
                       int64_t now_ns, const char *text, size_t len,
                       struct signals_command *command)
{
	struct ows *h = signals->h;
	char copy[VALUE_STRING_MAX + 1];
	uint32_t stamp = 0;
	int err = take_text(text, len,
	                    id->attribute == ATTR_VALUE &&
	                            map_record(&h->map, (uint32_t)id->record)->type == OWS_STRING,
	                    copy);

	if (err)
		return err;
	if (!takes_commands(h, id))
		return -EACCES;
	err = become_controller(h);
	if (!err)
		err = command_for(h, id, person);
	if (!err)
		err = handle_set_text(h, id, copy, &stamp);
	if (err == -ERANGE)
		return -EOVERFLOW;
	if (err == -EROFS)
		return -EACCES;
	if (err)
		return err == -EINVAL || err == -EACCES || err == -ESTALE || err == -EBUSY ? err
		                                                                           : -EIO;
	if (id->attribute == ATTR_VALUE)
		*command = (struct signals_command){(unsigned)id->record, h->map.image->generation,
		                                    stamp, now_ns};
	return 0;
}

int signals_write(struct signals *signals, const char *person, const char *name, int64_t now_ns,
                  const char *text, size_t len, struct signals_command *command)
{
	struct ows_id id;
	int err = look_up(signals, name, &id);

	*command = (struct signals_command){0};
	if (!err)
		err = signals_set(signals, person, &id, now_ns, text, len, command);
	if (err != -ESTALE)
		return err;
	/* a reload gave the signal another record meanwhile */
	err = not_yet(ows_reopen(signals->h));
	if (err == -EBUSY)
		return err;
	err = err ? -EIO : look_up(signals, name, &id);
	if (!err)
		err = signals_set(signals, person, &id, now_ns, text, len, command);
	return err == -ESTALE ? -EIO : err;
}

int signals_applied(struct signals *signals, const char *name, struct signals_command *command)
{
	struct ows *h = signals->h;
	const struct ows_command_slot *own;
	struct ows_sample sample;
	uint32_t applied;
	struct ows_id id;

	signals_follow(signals);
	if (h->map.image->generation != command->generation) {
		if (look_up(signals, name, &id) || id.attribute != ATTR_VALUE)
			return -ENOENT;
		command->record = (unsigned)id.record;
		command->generation = h->map.image->generation;
	}
	if (!h->give.base) /* this controller was refused after the reload */
		return -EIO;
	own = give_slot(&h->give, command->record);
	applied = give_applied(&h->give, command->record);
	if (applied && (int32_t)(applied - command->stamp) >= 0)
		return 0;
	if (__atomic_load_n(&own->taken, __ATOMIC_ACQUIRE) == command->stamp && own->err)
		return own->err == -ERANGE ? -EOVERFLOW : -EIO; /* the engine refused it */
	if (!reader_sample(map_record(&h->map, command->record), &sample))
		return -EAGAIN;
	if (sample.err && sample.tried_ns >= command->since_ns)
		return sample.err;
	return -EAGAIN;
}

bool signals_list(struct signals *signals, struct directory *directory)
{
	const struct ows_map *map = &signals->h->map;

	for (uint32_t record = 1; record < map->count; record++) {
		const char *name = map_name(map, record);

		/* a name with a comma would be two entries of the list */
		if (!strchr(name, ',') && !directory_add(directory, name, strlen(name)))
			return false;
	}
	return true;
}
