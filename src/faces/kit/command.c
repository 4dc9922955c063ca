/* SPDX-License-Identifier: MIT */
/* A command from outside: how old it may be, what it sets, and why it is refused. */
#include <errno.h>
#include <math.h>
#include <stdio.h>

#include "hal/base/time.h"
#include "src/faces/kit/command.h"
#include "src/faces/show/digits.h"
#include "src/faces/show/names.h"
#include "src/ground/service/command_age.h"
#include "src/ground/signal/attribute.h"
#include "src/ground/signal/error.h"
#include "src/ground/signal/value.h"

#define OPEN_NS NS_PER_S
#define SPECIAL_NAME (SIGNAL_NAME_MAX + 32)

static bool is_old(const struct face_command *command)
{
	return ows_now() - command->came_ns > COMMAND_OLD_NS;
}

int face_command_find(struct ows *h, const struct face_command *command, struct ows_info *info)
{
	char special[SPECIAL_NAME];
	struct ows_daemon daemon;
	int id, err;

	if (is_old(command))
		return -ETIME;
	/* names and types may be others since a reload */
	if (ows_daemon(h, ows_now(), &daemon) == -ESTALE)
		return -ESTALE;
	if (!names_info(h, command->instance, command->name, info))
		return -ENOENT;
	snprintf(special, sizeof(special), "%s%s", info->name,
	         attribute_table[ATTR_READ_ONE_SHOT].name);
	id = ows_find(h, command->reads ? special : command->name);
	err = id < 0 ? id : ows_for(h, command->person);
	return err ? err : id;
}

/* The flag acts when it goes from 0 to 1, whatever this handle has set before. */
static int read_once(struct ows *h, int id)
{
	int err = ows_set_integer(h, id, 0, NULL);

	return err ? err : ows_set_integer(h, id, 1, NULL);
}

int face_command_set(struct ows *h, const struct face_command *command, int id,
                     const struct ows_info *info, uint32_t *stamp)
{
	enum ows_type type = (enum ows_type)info->type;
	int64_t value;
	int err;

	/* to connect to owsd may have taken long */
	if (is_old(command))
		return -ETIME;
	if (command->reads)
		return read_once(h, id);
	if (!command->text)
		return -EINVAL;
	if (type == OWS_STRING)
		return ows_set_text(h, id, command->text, stamp);
	err = value_parse(type, command->text, &value);
	if (err)
		return err;
	return value_is_float(type) ? ows_set(h, id, value_number(type, value), stamp)
	                            : ows_set_integer(h, id, value, stamp);
}

static int way_open(struct face_way *way, const struct face_command *command)
{
	int err;

	if (way->h)
		return 0;
	if (ows_now() < way->open_ns)
		return -ESTALE;
	err = ows_open_as(command->instance, OWS_CONTROL, command->program, &way->h);
	if (err)
		way->h = NULL;
	/* to wait for one that hangs takes longer than the pause */
	way->open_ns = ows_now() + OPEN_NS;
	return err == -ENOENT ? -ESTALE : err; /* of owsd, not of the name */
}

int face_way_try(struct face_way *way, const struct face_command *command, face_deed *deed,
                 void *ctx)
{
	int err = way_open(way, command);

	if (!err)
		err = deed(way->h, ctx);
	/* owsd has reloaded, or was started again */
	if (err == -ESTALE && way->h && ows_reopen(way->h) == 0)
		err = deed(way->h, ctx);
	if (err == -ESTALE && way->h) {
		face_way_close(way);
		way->open_ns = ows_now() + OPEN_NS;
	}
	return err;
}

struct given {
	struct face_command *command;
	struct ows_info *info;
	face_fit *fit;
	void *ctx;
};

static int give(struct ows *h, void *ctx)
{
	const struct given *g = ctx;
	const char *text = g->command->text;
	int id = face_command_find(h, g->command, g->info), err;

	if (id < 0)
		return id;
	err = g->fit ? g->fit(g->ctx, id, g->info, g->command) : 0;
	if (!err)
		err = face_command_set(h, g->command, id, g->info, NULL);
	g->command->text = text;
	return err;
}

int face_command_give(struct face_way *way, struct face_command *command, struct ows_info *info,
                      face_fit *fit, void *ctx)
{
	return face_way_try(way, command, give, &(struct given){command, info, fit, ctx});
}

void face_way_close(struct face_way *way)
{
	ows_close(way->h);
	way->h = NULL;
}

const char *face_refusal(const struct face_command *command, const struct ows_info *info, int err,
                         char words[FACE_REFUSAL])
{
	char range[RANGE_WORDS], own[ERROR_WORDS];
	const char *why = "";

	switch (-err) {
	case EACCES:
		snprintf(words, FACE_REFUSAL,
		         "owsd refuses %s: add its user to the group owsd-control and start it "
		         "again, or name it in ControlAllow",
		         command->program);
		return words;
	case ERANGE:
		/* neither its type nor Min and Max say which: the scale and the device do */
		if (value_is_float((enum ows_type)info->type) && isnan(info->min) &&
		    isnan(info->max)) {
			snprintf(words, FACE_REFUSAL, "\"%.60s\" is beyond the signal's range",
			         command->text ? command->text : "");
			return words;
		}
		/* fallthrough */
	case EINVAL:
		snprintf(words, FACE_REFUSAL, "\"%.60s\" is no value for it: expected %s",
		         command->text ? command->text : "",
		         info->name ? range_words((enum ows_type)info->type, info->min, info->max,
		                                  range)
		                    : "another");
		return words;
	case EROFS:
		why = "it is an input: Writable is off in the configuration";
		break;
	case ENOENT:
		why = "there is no such signal";
		break;
	case ENOSPC:
	case EBUSY:
	case EAGAIN:
		why = "too many commands or programs: try again in a second";
		break;
	case ETIME:
		why = "it may have waited for longer than 2 seconds: give it again";
		break;
	case ESTALE:
	case ETIMEDOUT:
		why = "owsd does not answer: does it run?";
		break;
	default:
		why = error_words(err, own);
	}
	snprintf(words, FACE_REFUSAL, "%s", why);
	return words;
}
