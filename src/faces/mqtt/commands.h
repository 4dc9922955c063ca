/* SPDX-License-Identifier: MIT */
/*
 * Commands that came from the broker: the broker decides who may publish there, owsd what owsd-mqtt
 * may set. What is wrong with a command is a line of the log, and nothing else happens.
 */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "hal/base/time.h"
#include "src/faces/kit/command.h"
#include "src/faces/mqtt/ask.h"
#include "src/faces/mqtt/client.h"
#include "src/ground/text/log.h"

struct credit;
struct stream;

/* Lines of the log for each cause of refusals, in COMMANDS_SPAN_NS; the others are counted */
#define COMMANDS_LINES 10
#define COMMANDS_SPAN_NS (60 * NS_PER_S)
#define COMMANDS_CAUSES 32
#define COMMANDS_TROUBLE_NS (60 * NS_PER_S)

struct commands_cause {
	int64_t begun_ns;
	unsigned lines; /* since then */
	uint64_t others;
	char last[BROKER_WORDS]; /* of the others */
};

struct commands {
	struct log *log;
	const char *instance, *program;
	const struct stream *stream; /* whether owsd is there, and classes of signals */
	struct face_way way;
	struct credit *credits; /* by ids of way.h */
	int credit_count;
	struct commands_cause causes[COMMANDS_CAUSES]; /* by a hash of their words */
	uint64_t taken, refused;
	struct ask ask;             /* the last one */
	char why[FACE_REFUSAL];     /* it was refused; "": it was not */
	char trouble[BROKER_WORDS]; /* the last refusal, and what to do */
	int64_t trouble_ns;         /* when it was */
};

/* What the text of a command is. */
enum commands_form {
	COMMANDS_VALUE, /* the value, or JSON that has it */
	COMMANDS_TEXT,  /* the value: no text of it is JSON */
	COMMANDS_READ,  /* nothing, or JSON without a value: owsd is to read the signal */
};

/*
 * The command of a message for the signal name; known: it is one of those that are published.
 * place: for whom, if the message does not name one. Waits for owsd when it connects, two seconds
 * at most, once a second. 0, or why it was refused; -ETIME: it may be too old.
 */
int commands_take(struct commands *c, const char *name, bool known, enum commands_form form,
                  const struct broker_message *message, const char *place, int64_t now_ns);
/* What is wrong with the message itself, as one that asks for a change; NULL: nothing. */
const char *commands_fault(const struct broker_message *message);
/* Count a refusal, and log it, unless there were many of its cause. */
void commands_refuse(struct commands *c, const char *name, const char *why, int64_t now_ns);
/* Log how many refusals had no line, for each cause whose span is over by now. */
void commands_tell(struct commands *c, int64_t now_ns);
/* The last refusal, for a minute: then it is nothing that is wrong now. "": none. */
const char *commands_trouble(const struct commands *c, int64_t now_ns);
void commands_close(struct commands *c);
