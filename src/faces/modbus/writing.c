/* SPDX-License-Identifier: MIT */
/* Hands commands to owsd, and beats for who gave them. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "src/config/read/modbus.h"
#include "src/faces/modbus/writing.h"
#include "src/ground/signal/value.h"

#define SAY_NS (10 * NS_PER_S)
#define AGAIN_NS NS_PER_S

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

static int64_t longest_delay_ns(const struct config *config)
{
	int64_t longest_ns = 0;

	for (size_t i = 0; i < config->item_count; i++)
		longest_ns = later_ns(longest_ns, config->items[i].safe_delay_ns);
	return longest_ns;
}

/*
 * The one that was silent for longest, if owsd has lost it: its outputs are at SafeValue, and the
 * goodbye of a way that is closed leaves none in force. NULL: all places are needed.
 */
static struct writer *find_lost(struct writing *w)
{
	int64_t now_ns = clock_ns(CLOCK_MONOTONIC);
	struct writer *lost = NULL;

	for (unsigned i = 0; i < WRITERS; i++)
		if (!lost || w->writers[i].heard_ns < lost->heard_ns)
			lost = &w->writers[i];
	if (lost->promised_ns &&
	    now_ns - lost->heard_ns <=
	            NS_PER_S + later_ns(lost->promised_ns, longest_delay_ns(w->face->config)))
		return NULL;
	return lost;
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
		free = find_lost(w);
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
	int err;

	writer->heard_ns = clock_ns(CLOCK_MONOTONIC);
	if (!writer->way.h || !beat_ns || now_ns < writer->again_ns)
		return;
	err = ows_beat(writer->way.h, (uint32_t)(beat_ns / NS_PER_MS));
	writer->again_ns = 0;
	writer->promised_ns = beat_ns;
	/* owsd has reloaded, or was started again */
	if (err == -ESTALE && ows_reopen(writer->way.h))
		writer->again_ns = now_ns + AGAIN_NS;
}

static void refuse(struct writing *w, const struct face_command *command,
                   const struct ows_info *info, int err)
{
	char words[FACE_REFUSAL];
	int64_t now_ns = ows_now();

	w->refused++;
	if (w->said_ns && now_ns - w->said_ns < SAY_NS)
		return;
	w->said_ns = now_ns;
	log_warning(w->face->log, "command to %s of %s refused: %s", command->name, command->person,
	            face_refusal(command, info, err, words));
}

enum exception writing_fits(struct writing *w, const struct ows_info *info, double number,
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
	if (err)
		refuse(w, &command, info, err);
	return writing_refusal(err);
}

enum exception writing_set(struct writing *w, const char *name, double number,
                           const struct listen_address *from, int64_t came_ns)
{
	struct writer *writer = find(w, from, true);
	char person[WRITING_PERSON], text[VALUE_TEXT_MAX];
	struct face_command command = {.program = w->face->ops->program,
	                               .instance = w->face->arguments->instance,
	                               .name = name,
	                               .text = text,
	                               .person = writing_person(from, person),
	                               .came_ns = came_ns};
	struct ows_info info = {0};
	int err;

	value_to_text(OWS_DOUBLE, value_of_double(number), text);
	err = writer ? face_command_give(&writer->way, &command, &info, NULL, NULL) : -ENOSPC;
	if (err) {
		refuse(w, &command, &info, err);
		return writing_refusal(err);
	}
	w->taken++;
	log_info(w->face->log, "%s set to %s for %s", name, text, person);
	beat(w, writer);
	return EXCEPTION_NONE;
}

void writing_heard(struct writing *w, const struct listen_address *from, bool by_register)
{
	struct writer *writer = find(w, from, false);

	if (!writer || writing_may(w, NULL, from))
		return;
	writer->by_register |= by_register;
	if (by_register || !writer->by_register)
		beat(w, writer);
}

void writing_close(struct writing *w)
{
	for (unsigned i = 0; i < WRITERS; i++)
		if (w->writers[i].used && !w->face->config->modbus.beat_ns)
			face_way_close(&w->writers[i].way);
}
