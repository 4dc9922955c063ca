/* SPDX-License-Identifier: MIT */
/* Checks a command and hands it to owsd, or logs why not. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "src/faces/mqtt/commands.h"
#include "src/faces/mqtt/credit.h"
#include "src/faces/mqtt/entity.h"
#include "src/faces/mqtt/stream.h"
#include "src/ground/signal/hash.h"
#include "src/ground/signal/value.h"
#include "src/ground/text/printable.h"

#define UNDER_WAY_NS (10 * NS_PER_S) /* a command is written by then, or it failed */

/* Of commands to one signal; refusal_of() names it. */
static const struct credit_rate commands_rate = {NS_PER_S / 50, 100};

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

void commands_refuse(struct commands *c, const char *name, const char *why, int64_t now_ns)
{
	uint64_t print = hash_text(HASH_BEGIN, why, strlen(why));
	struct commands_cause *cause = &c->causes[print % COMMANDS_CAUSES];
	char claim[64];

	snprintf(claim, sizeof(claim), "%s", name);
	printable_quoted(claim);
	commands_tell(c, now_ns);
	c->refused++;
	snprintf(c->why, sizeof(c->why), "%s", why);
	c->trouble_ns = now_ns;
	snprintf(c->trouble, sizeof(c->trouble), "command to \"%s\" refused: %.150s", claim, why);
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

/*
 * on and off are all of a light or a cover that has a number, or nothing, and toggle is the other
 * one of them; else text. NULL: nothing says which is the other one.
 */
static const char *number_of(const struct commands *c, int id, int64_t given_ns,
                             const struct ows_info *info, const char *text,
                             char number[VALUE_TEXT_MAX])
{
	const struct stream *s = c->stream;
	bool toggle = !strcmp(text, "toggle"), is_bool = info->type == OWS_BOOL;
	double least = 0, most = 1;
	enum entity_kind kind;
	struct ows_value v;

	if (!toggle && (is_bool || (strcmp(text, "on") != 0 && strcmp(text, "off") != 0)))
		return text;
	kind = entity_kind(info, s->class_of(s->class_ctx, info->name), true);
	if (!is_bool && kind != ENTITY_LIGHT && kind != ENTITY_COVER)
		return text;
	if (!is_bool)
		entity_range(info, &least, &most);
	if (toggle) {
		if (ows_get(c->way.h, id, ows_now(), &v) || !ows_good(v.quality))
			return NULL;
		/* what was set just now is on its way, and the value that of before */
		if (v.measured_ns < given_ns && ows_now() - given_ns < UNDER_WAY_NS)
			return NULL;
		text = v.number > least ? "off" : "on";
	}
	value_to_text(OWS_DOUBLE, value_of_double(text[1] == 'n' ? most : least), number);
	return number;
}

/* That of the signal, by its id. NULL: no memory. */
static struct credit *credit_of(struct commands *c, int id)
{
	struct credit *more;

	if (id < c->credit_count)
		return &c->credits[id];
	more = realloc(c->credits, (size_t)(id + 1) * sizeof(*more));
	if (!more)
		return NULL;
	memset(more + c->credit_count, 0, (size_t)(id + 1 - c->credit_count) * sizeof(*more));
	c->credits = more;
	c->credit_count = id + 1;
	return &c->credits[id];
}

/* -EDQUOT: there is no credit for it. */
static int fit(void *ctx, int id, const struct ows_info *info, struct face_command *command)
{
	static char number[VALUE_TEXT_MAX];
	struct credit *credit = credit_of(ctx, id);

	if (!credit || !credit_spend(credit, &commands_rate, ows_now()))
		return credit ? -EDQUOT : -ENOMEM;
	if (command->reads)
		return 0;
	command->text = number_of(ctx, id, credit->given_ns, info, command->text, number);
	if (!command->text)
		return -ENODATA;
	credit->given_ns = ows_now();
	return 0;
}

static void forget_credits(struct commands *c)
{
	free(c->credits);
	c->credits = NULL;
	c->credit_count = 0;
}

const char *commands_fault(const struct broker_message *message)
{
	if (message->retained && message->len)
		return "it is retained, so nobody knows of when it is: publish it without retain";
	if (!message->len)
		return "it is empty";
	if (strlen(message->text) != message->len)
		return "there is a byte 0 in it";
	return NULL;
}

/* What the kit's words do not have: reasons of this door. */
static const char *refusal_of(int err)
{
	switch (-err) {
	case EDQUOT:
		return "more than 50 commands in a second";
	case ENODATA:
		return "nothing says which the other one is: its value is not good, or a command is "
		       "under way: send on or off";
	default:
		return NULL;
	}
}

int commands_take(struct commands *c, const char *name, bool known, enum commands_form form,
                  const struct broker_message *message, const char *place, int64_t now_ns)
{
	const char *wrong = ask_read(&c->ask, message->text, message->len, form == COMMANDS_TEXT);
	const char *fault = message->fault;
	bool reads = form == COMMANDS_READ;
	char person[BROKER_PERSON], words[FACE_REFUSAL];
	struct face_command command = {.program = c->program,
	                               .instance = c->instance,
	                               .name = name,
	                               .text = reads ? NULL : c->ask.value,
	                               .reads = reads,
	                               .person = person,
	                               .came_ns = message->came_ns};
	struct ows_info info = {0};
	int err;

	c->why[0] = '\0';
	if (!fault && (message->len || !reads))
		fault = commands_fault(message);
	fault = fault ? fault : wrong;
	if (!fault && !reads && !*c->ask.value)
		fault = "it has no \"v\"";
	c->ask.value = reads ? NULL : c->ask.value;
	if (fault) {
		commands_refuse(c, name, fault, now_ns);
		return -EINVAL;
	}
	snprintf(person, sizeof(person), "%.*s", BROKER_PERSON - 1,
	         *message->person ? message->person : place);
	err = !c->stream->live ? -ESTALE
	      : !known         ? -ENOENT
	                       : face_command_give(&c->way, &command, &info, fit, c);
	if (!c->way.h)
		forget_credits(c);
	if (err) {
		fault = refusal_of(err);
		commands_refuse(c, name, fault ? fault : face_refusal(&command, &info, err, words),
		                now_ns);
		return err;
	}
	c->taken++;
	c->trouble[0] = '\0';
	if (reads)
		log_info(c->log, "%s is read for %s", name, person);
	else
		log_info(c->log, "%s set to %.60s for %s", name, command.text, person);
	return 0;
}

const char *commands_trouble(const struct commands *c, int64_t now_ns)
{
	return now_ns - c->trouble_ns < COMMANDS_TROUBLE_NS ? c->trouble : "";
}

void commands_close(struct commands *c)
{
	face_way_close(&c->way);
	forget_credits(c);
}
