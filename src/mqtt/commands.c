/* SPDX-License-Identifier: MIT */
/* Checks a command and hands it to owsd, or logs why not. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "src/libows/ows.h"
#include "src/mqtt/commands.h"
#include "src/mqtt/entity.h"
#include "src/show/names.h"
#include "src/signal/error.h"
#include "src/signal/hash.h"
#include "src/signal/value.h"

#define OPEN_NS NS_PER_S
#define COST_NS (NS_PER_S / COMMANDS_A_SECOND)

void commands_tell(struct commands *c, int64_t now_ns)
{
	for (size_t i = 0; i < COMMANDS_CAUSES; i++) {
		struct commands_cause *cause = &c->causes[i];
		char others[LOG_OTHERS];

		if (!cause->lines || now_ns - cause->begun_ns < COMMANDS_SPAN_NS)
			continue;
		if (cause->others)
			log_warning(c->log, "%.190s%s", cause->last,
			            log_others(cause->others, others));
		*cause = (struct commands_cause){0};
	}
}

static void commands_refuse(struct commands *c, const char *name, const char *why, int64_t now_ns)
{
	uint64_t print = hash_text(HASH_BEGIN, why, strlen(why));
	struct commands_cause *cause = &c->causes[print % COMMANDS_CAUSES];

	commands_tell(c, now_ns);
	c->refused++;
	snprintf(c->trouble, sizeof(c->trouble), "command to %.63s refused: %.150s", name, why);
	if (!cause->lines)
		cause->begun_ns = now_ns;
	if (cause->lines < COMMANDS_LINES) {
		cause->lines++;
		log_warning(c->log, "%s", c->trouble);
	} else {
		cause->others++;
		memcpy(cause->last, c->trouble, sizeof(cause->last));
	}
}

static const char *why_not(int err, char words[ERROR_WORDS])
{
	switch (-err) {
	case EACCES:
		return "owsd refuses owsd-mqtt: add its user to the group owsd-control, or name it in "
		       "ControlAllow";
	case EROFS:
		return "it is an input: Writable is off in the configuration";
	case ERANGE:
	case EINVAL:
		return "it is no value for it, or beyond the range of its type, Min or Max";
	case ENOENT:
		return "there is no such signal";
	case ENOSPC:
	case EBUSY:
	case EAGAIN:
		return "too many commands or programs: try again in a second";
	case ESTALE:
	case ETIMEDOUT:
		return "owsd does not answer: does it run?";
	default:
		return error_words(err, words);
	}
}

/* 0, or a negative errno. */
static int connect_owsd(struct commands *c, int64_t now_ns)
{
	int err;

	if (c->h)
		return 0;
	if (now_ns < c->open_ns)
		return -ESTALE;
	err = ows_open_as(c->instance, OWS_CONTROL, c->program, &c->h);
	if (err)
		c->h = NULL;
	/* to wait for one that hangs takes longer than the pause */
	c->open_ns = ows_now() + OPEN_NS;
	return err == -ENOENT ? -ESTALE : err;
}

static int set_number(struct commands *c, int id, const struct ows_info *info, const char *text)
{
	const struct stream *s = c->stream;
	enum ows_type type = (enum ows_type)info->type;
	double least, most;
	int64_t value;
	int err;

	if (type != OWS_BOOL && (!strcmp(text, "on") || !strcmp(text, "off"))) {
		enum entity_kind kind = entity_kind(info, s->class_of(s->class_ctx, info->name),
		                                    true);

		/* all of it, or nothing; another number has no such words */
		if (kind != ENTITY_LIGHT && kind != ENTITY_COVER)
			return -EINVAL;
		entity_range(info, &least, &most);
		return ows_set(c->h, id, text[1] == 'n' ? most : least, NULL);
	}
	err = value_parse(type, text, &value);
	if (err)
		return err;
	return value_is_float(type) ? ows_set(c->h, id, value_number(type, value), NULL)
	                            : ows_set_integer(c->h, id, value, NULL);
}

static int set(struct commands *c, const char *name, const char *text, const char *person)
{
	struct ows_daemon daemon;
	struct ows_info info;
	int id, err;

	/* names and types may be others since a reload */
	if (ows_daemon(c->h, ows_now(), &daemon) == -ESTALE)
		return -ESTALE;
	if (!names_info(c->h, c->instance, name, &info))
		return -ENOENT;
	id = ows_find(c->h, name);
	err = id < 0 ? id : ows_for(c->h, person);
	if (err)
		return err;
	return info.type == OWS_STRING ? ows_set_text(c->h, id, text, NULL)
	                               : set_number(c, id, &info, text);
}

/* Is there credit for one more? It grows with time, up to that of a burst. */
static bool may_come(struct commands *c, int64_t now_ns)
{
	c->credit_ns += now_ns - c->counted_ns;
	c->counted_ns = now_ns;
	if (c->credit_ns > COMMANDS_BURST * COST_NS)
		c->credit_ns = COMMANDS_BURST * COST_NS;
	if (c->credit_ns < COST_NS)
		return false;
	c->credit_ns -= COST_NS;
	return true;
}

/* What is wrong with the message itself; NULL: nothing. */
static const char *fault_of(const struct broker_message *message)
{
	if (message->retained && message->len)
		return "it is retained, so nobody knows of when it is: publish it without retain";
	if (message->len > COMMANDS_TEXT)
		return "it is longer than 1024 bytes";
	if (!message->len)
		return "it is empty";
	if (strlen(message->text) != message->len)
		return "there is a byte 0 in it";
	return NULL;
}

void commands_take(struct commands *c, const char *name, bool known,
                   const struct broker_message *message, const char *place, int64_t now_ns)
{
	const char *why = !may_come(c, now_ns) ? "more than 50 commands in a second" : NULL;
	char person[BROKER_PERSON], words[ERROR_WORDS];
	int err;

	if (!why)
		why = message->fault ? message->fault : fault_of(message);
	if (!why && !c->stream->live)
		why = why_not(-ESTALE, words);
	if (!why && !known)
		why = why_not(-ENOENT, words);
	if (why) {
		commands_refuse(c, name, why, now_ns);
		return;
	}
	snprintf(person, sizeof(person), "%.*s", BROKER_PERSON - 1,
	         *message->person ? message->person : place);
	err = connect_owsd(c, now_ns);
	if (!err)
		err = set(c, name, message->text, person);
	if (err == -ESTALE && c->h) {
		/* owsd has reloaded, or was started again */
		err = ows_reopen(c->h);
		err = err ? -ESTALE : set(c, name, message->text, person);
	}
	if (err == -ESTALE && c->h) {
		commands_close(c);
		c->open_ns = ows_now() + OPEN_NS;
	}
	if (err) {
		commands_refuse(c, name, why_not(err, words), now_ns);
		return;
	}
	c->taken++;
	c->trouble[0] = '\0';
	log_info(c->log, "%s set to %.60s for %s", name, message->text, person);
}

void commands_close(struct commands *c)
{
	ows_close(c->h);
	c->h = NULL;
}
