/* SPDX-License-Identifier: MIT */
/* Hands commands to owsd, and beats for who gave them. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "src/config/read/modbus.h"
#include "src/faces/modbus/writing.h"
#include "src/ground/service/command_age.h"
#include "src/ground/signal/attribute.h"
#include "src/ground/signal/value.h"

#define SAY_NS (10 * NS_PER_S)
#define AGAIN_NS NS_PER_S
#define SEVERAL (SIGNAL_NAME_MAX + 24) /* bytes of a name, and how many more */

const char *writing_person(const struct listen_address *from, char person[WRITING_PERSON])
{
	char text[LISTEN_TEXT_MAX];
	size_t most = WRITING_PERSON - sizeof("modbus:"), len;

	listen_print_host(from, text);
	len = strlen(text);
	snprintf(person, WRITING_PERSON, "modbus:%s", text + (len > most ? len - most : 0));
	return person;
}

enum exception writing_refusal(int err)
{
	switch (-err) {
	case 0:
		return EXCEPTION_NONE;
	case ENOENT:
	case EROFS:
		return EXCEPTION_ADDRESS;
	case EINVAL:
	case ERANGE:
		return EXCEPTION_VALUE;
	case EAGAIN:
	case EBUSY:
	case ENOSPC:
	case ESTALE:
	case ETIME:
	case ETIMEDOUT:
		return EXCEPTION_BUSY;
	default:
		return EXCEPTION_FAILURE;
	}
}

/* For how long may it still be silent until owsd may have lost it? */
static int64_t left_ns(const struct writer *writer)
{
	return writer->heard_ns + writer->promised_ns + COMMAND_OLD_NS - clock_ns(CLOCK_MONOTONIC);
}

/*
 * Is a command of it in force that SafeValue has still to replace? owsd alone knows: it counts no
 * time in which it did not run, and a goodbye before it is done would leave the command in force.
 */
static bool commands_still(const struct writing *w, const struct writer *writer)
{
	const struct config *config = w->face->config;
	struct ows *ows = w->face->ows;
	char person[WRITING_PERSON];
	bool still = !w->face->live;

	writing_person(&writer->from, person);
	for (size_t i = 0; i < config->item_count && !still; i++) {
		struct ows_origin origin = {0};
		int err;

		if (!config->items[i].has_safe)
			continue;
		err = ows_origin(ows, ows_find(ows, config->items[i].name), &origin);
		still = err ? err != -ENOENT
		            : origin.reason != OWS_REASON_SAFE &&
		                        !strcmp(origin.who.person, person);
	}
	return still;
}

/* One without a promise is not lost, and leaves its commands. */
static bool is_spare(const struct writing *w, const struct writer *writer)
{
	return !writer->promised_ns || (left_ns(writer) < 0 && !commands_still(w, writer));
}

/* The one that was silent for longest of those that need no place. NULL: all do. */
static struct writer *find_spare(struct writing *w)
{
	struct writer *spare = NULL;

	for (unsigned i = 0; i < WRITERS; i++)
		if ((!spare || w->writers[i].heard_ns < spare->heard_ns) &&
		    is_spare(w, &w->writers[i]))
			spare = &w->writers[i];
	return spare;
}

static struct writer *find(struct writing *w, const struct listen_address *from, bool new)
{
	struct listen_address host = *from;
	struct writer *free = NULL;

	host.port = 0;
	for (unsigned i = 0; i < WRITERS; i++)
		if (!w->writers[i].used)
			free = free ? free : &w->writers[i];
		else if (listen_same(&w->writers[i].from, &host))
			return &w->writers[i];
	if (new && !free)
		free = find_spare(w);
	if (!new || !free)
		return NULL;
	face_way_close(&free->way);
	*free = (struct writer){.from = host, .used = true};
	return free;
}

enum exception writing_may(const struct writing *w, const char *name,
                           const struct listen_address *from)
{
	const struct config_modbus *options = &w->face->config->modbus;

	if (!options->write || !options->allow)
		return EXCEPTION_FUNCTION;
	return !name || modbus_allows(options->allow, name, from) ? EXCEPTION_NONE
	                                                          : EXCEPTION_ADDRESS;
}

static void beat(struct writing *w, struct writer *writer)
{
	int64_t beat_ns = w->face->config->modbus.beat_ns, now_ns = ows_now();
	int64_t period_ns = beat_ns ? beat_ns : writer->promised_ns;
	int err;

	writer->heard_ns = clock_ns(CLOCK_MONOTONIC);
	if (!writer->way.h || !period_ns || now_ns < writer->again_ns)
		return;
	err = ows_beat(writer->way.h, (uint32_t)(period_ns / NS_PER_MS));
	writer->again_ns = 0;
	writer->promised_ns = period_ns;
	/* owsd has reloaded, or was started again */
	if (err == -ESTALE && ows_reopen(writer->way.h)) {
		writer->again_ns = now_ns + AGAIN_NS;
	} else if (!beat_ns) {
		/* only a goodbye ends a promise */
		face_way_close(&writer->way);
		writer->promised_ns = writer->way.open_ns = 0;
	}
}

static void refuse(struct writing *w, const struct face_command *command,
                   const struct ows_info *info, int err)
{
	char words[FACE_REFUSAL];
	int64_t now_ns = ows_now();

	if (w->said_ns && now_ns - w->said_ns < SAY_NS)
		return;
	w->said_ns = now_ns;
	log_warning(w->face->log, "command to %s of %s refused: %s", command->name, command->person,
	            face_refusal(command, info, err, words));
}

enum exception writing_add(struct writing *w, const struct ows_info *info, double number,
                           const struct listen_address *from)
{
	enum ows_type type = (enum ows_type)info->type;
	char person[WRITING_PERSON], text[VALUE_TEXT_MAX];
	const struct face_command command = {.program = w->face->ops->program,
	                                     .name = info->name,
	                                     .text = text,
	                                     .person = writing_person(from, person)};
	int64_t value;
	int err;

	value_to_text(OWS_DOUBLE, value_of_double(number), text);
	err = value_parse(type, text, &value);
	if (!err &&
	    (value_number(type, value) < info->min || value_number(type, value) > info->max))
		err = -ERANGE;
	if (err) {
		refuse(w, &command, info, err);
		return writing_refusal(err);
	}
	w->names[w->count] = info->name;
	w->numbers[w->count++] = number;
	return EXCEPTION_NONE;
}

/* The first command stands for all: from whom, how old. */
struct deed {
	struct writing *w;
	const struct face_command *command;
	struct ows_info info;
};

static int set_all(struct ows *h, void *ctx)
{
	struct deed *deed = ctx;
	struct writing *w = deed->w;
	int err = face_command_find(h, deed->command, &deed->info);

	for (int i = 0; i < w->count && err >= 0; i++)
		err = w->ids[i] = ows_find(h, w->names[i]);
	return err < 0 ? err : ows_set_many(h, w->ids, w->numbers, w->count);
}

enum exception writing_set(struct writing *w, const struct listen_address *from, int64_t came_ns)
{
	struct writer *writer = find(w, from, true);
	char person[WRITING_PERSON], text[VALUE_TEXT_MAX], several[SEVERAL];
	struct face_command command = {.program = w->face->ops->program,
	                               .instance = w->face->arguments->instance,
	                               .name = w->names[0],
	                               .text = text,
	                               .person = writing_person(from, person),
	                               .came_ns = came_ns};
	struct deed deed = {.w = w, .command = &command};
	int err;

	value_to_text(OWS_DOUBLE, value_of_double(w->numbers[0]), text);
	err = writer ? face_way_try(&writer->way, &command, set_all, &deed) : -ENOSPC;
	if (err) {
		snprintf(several, sizeof(several), "%s and %d more", w->names[0], w->count - 1);
		command.name = w->count > 1 ? several : w->names[0];
		refuse(w, &command, &deed.info, err);
		return writing_refusal(err);
	}
	w->taken += (unsigned)w->count;
	for (int i = 0; i < w->count; i++) {
		value_to_text(OWS_DOUBLE, value_of_double(w->numbers[i]), text);
		log_info(w->face->log, "%s set to %s for %s", w->names[i], text, person);
	}
	beat(w, writer);
	return EXCEPTION_NONE;
}

enum exception writing_heard(struct writing *w, const struct listen_address *from, int64_t came_ns,
                             bool by_register)
{
	struct writer *writer;

	if (ows_now() - came_ns > COMMAND_OLD_NS)
		return EXCEPTION_BUSY;
	writer = writing_may(w, NULL, from) ? NULL : find(w, from, by_register);
	if (!writer)
		return EXCEPTION_NONE;
	writer->by_register |= by_register;
	if (by_register || !writer->by_register)
		beat(w, writer);
	return EXCEPTION_NONE;
}

int64_t writing_tick(struct writing *w, int64_t now_ns)
{
	int64_t next_ns = INT64_MAX;

	for (unsigned i = 0; i < WRITERS; i++) {
		struct writer *writer = &w->writers[i];

		if (!writer->way.h || !writer->promised_ns)
			continue;
		if (is_spare(w, writer)) {
			face_way_close(&writer->way);
			writer->promised_ns = writer->way.open_ns = 0;
		} else {
			next_ns = earlier_ns(next_ns, now_ns + later_ns(left_ns(writer), NS_PER_S));
		}
	}
	return next_ns;
}

void writing_close(struct writing *w)
{
	for (unsigned i = 0; i < WRITERS; i++)
		if (w->writers[i].used && !w->face->config->modbus.beat_ns)
			face_way_close(&w->writers[i].way);
}
