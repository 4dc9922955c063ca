/* SPDX-License-Identifier: MIT */
/* Commands, on the worker for them: libows waits for owsd's answer. */
#include <errno.h>
#include <microhttpd.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/time.h"
#include "src/show/json.h"
#include "src/show/names.h"
#include "src/signal/error.h"
#include "src/signal/value.h"
#include "src/web/body.h"
#include "src/web/guard.h"
#include "src/web/http.h"
#include "src/web/paths.h"

#define WAIT_NS (5 * NS_PER_S)  /* for the commands before it */
#define CONFIRM_NS NS_PER_S     /* so long a page waits for the bus */
#define TAKEN_NS (2 * NS_PER_S) /* and for owsd */

struct order {
	struct job job;
	char instance[128], person[PERSON];
	int64_t given_ns;
	struct body body;
	struct ows *h;
	int id;
	struct ows_info info;
};

static void command_answer(struct order *order, const char *result)
{
	struct json json;

	if (!json_start(&json, &order->job.text, &order->job.len))
		return;
	order->job.status = 200;
	json_bool(&json, "ok", true);
	json_string(&json, "result", result);
	json_finish(&json);
}

static void command_refuse(struct order *order, int err)
{
	const struct body_member *value = body_find(&order->body, "value");
	const char *name = body_string(&order->body, "name");
	char words[ERROR_WORDS];

	switch (-err) {
	case EACCES:
		job_error(
			&order->job, 403,
			"%s: owsd refuses owsd-web: add its user to the group owsd-control, or name "
			"it in ControlAllow",
			name);
		break;
	case EROFS:
		job_error(&order->job, 403, "%s is an input: Writable is off in the configuration",
		          name);
		break;
	case ERANGE:
	case EINVAL:
		job_error(&order->job, 400,
		          "%s: %s is no value for it, or beyond the range of its type, Min or Max",
		          name, value ? value->text : "that");
		break;
	case EOPNOTSUPP:
		job_error(&order->job, 400, "%s has no limit alarms", name);
		break;
	case ENOENT:
		job_error(&order->job, 404, "there is no signal %s", name);
		break;
	case ENOSPC:
	case EBUSY:
	case EAGAIN:
		job_error(&order->job, 503, "%s: too many commands: try again in a second", name);
		break;
	case ESTALE:
	case ETIMEDOUT:
		job_error(&order->job, 503, "%s: owsd does not answer: does it run?", name);
		break;
	default:
		job_error(&order->job, 500, "%s: %s", name, error_words(err, words));
	}
}

/* Connect, and find the signal. False after answering. */
static bool command_begin(struct order *order)
{
	const char *name = body_string(&order->body, "name");
	int err;

	/* whoever gave it has given it up: nothing may move a minute later */
	if (ows_now() - order->given_ns > WAIT_NS) {
		job_error(&order->job, 503, "%s: not set: too many commands wait", name);
		return false;
	}
	err = ows_open_as(order->instance, OWS_CONTROL, "owsd-web", &order->h);
	if (err == -ENOENT)
		err = -ESTALE; /* of owsd, not of the name */
	if (!err)
		err = ows_for(order->h, order->person);
	if (!err && !names_info(order->h, order->instance, name, &order->info))
		err = -ENOENT;
	if (!err) {
		order->id = ows_find(order->h, name);
		err = order->id < 0 ? order->id : 0;
	}
	if (err)
		command_refuse(order, err);
	return !err;
}

/* --- Values ---------------------------------------------------------------------------------- */

static int command_put(struct order *order, uint32_t *stamp)
{
	const struct body_member *value = body_find(&order->body, "value");
	enum ows_type type = (enum ows_type)order->info.type;
	int64_t number;
	int err;

	if (!value || value->kind == BODY_NULL)
		return -EINVAL;
	if (type == OWS_STRING)
		return ows_set_text(order->h, order->id, value->text, stamp);
	err = value_parse(type, value->text, &number);
	if (err)
		return err;
	if (value_is_float(type))
		return ows_set(order->h, order->id, value_number(type, number), stamp);
	return ows_set_integer(order->h, order->id, number, stamp);
}

static void run_set(struct job *job)
{
	struct order *order = (struct order *)job;
	int64_t until_ns = ows_now() + CONFIRM_NS;
	struct ows_command command = {0};
	uint32_t stamp = 0, news = 0;
	int err;

	if (command_begin(order)) {
		err = command_put(order, &stamp);
		while (!err && ows_now() < until_ns) {
			err = ows_command(order->h, order->id, &command);
			if (err || (int32_t)(command.applied - stamp) >= 0)
				break;
			if (command.taken == stamp && command.refused)
				err = command.refused;
			else
				ows_wait(order->h, &news, 50 * NS_PER_MS);
		}
		if (err)
			command_refuse(order, err);
		else
			command_answer(order, (int32_t)(command.applied - stamp) >= 0 ? "taken"
			                                                              : "pending");
	}
	ows_close(order->h);
}

/* --- Alarms ---------------------------------------------------------------------------------- */

static bool wants_eyes(struct order *order)
{
	struct ows_alarm_state state = {0};

	ows_alarm_state(order->h, order->id, &state);
	return state.limit_state == OWS_LIMIT_UNACKNOWLEDGED ||
	       state.limit_state == OWS_LIMIT_RETURNED;
}

static int acknowledge(struct order *order)
{
	int64_t until_ns = ows_now() + TAKEN_NS;
	struct ows_alarm_state state = {0};
	uint32_t news = 0;
	int err = ows_alarm_state(order->h, order->id, &state);

	if (!err && !state.limits)
		return -EOPNOTSUPP;
	if (!err)
		err = ows_acknowledge(order->h, order->id);
	while (!err && wants_eyes(order)) {
		if (ows_now() >= until_ns)
			return -ETIMEDOUT;
		ows_wait(order->h, &news, 50 * NS_PER_MS);
	}
	return err;
}

static const char *deed(const struct body *body)
{
	return *body_string(body, "do") ? body_string(body, "do") : body_string(body, "action");
}

static void run_alarm(struct job *job)
{
	struct order *order = (struct order *)job;
	const struct body_member *seconds = body_find(&order->body, "seconds");
	const char *why = body_string(&order->body, "why"), *what = deed(&order->body);
	int err;

	if (command_begin(order)) {
		if (*what == 'a')
			err = acknowledge(order);
		else
			err = ows_shelve(order->h, order->id,
			                 *what == 'u' ? 0
			                              : (uint32_t)strtoul(seconds->text, NULL, 10),
			                 *why ? why : NULL);
		if (err)
			command_refuse(order, err);
		else
			command_answer(order, "taken");
	}
	ows_close(order->h);
}

/* --- Requests -------------------------------------------------------------------------------- */

/* False after answering. */
static bool may(struct request *request, struct order *order, int *result)
{
	char words[GUARD_WORDS];
	unsigned status = guard_post(request, PERSON_WRITE, order->person, words);

	if (status)
		*result = http_error(request, status, "%s", words);
	else if (body_parse(order->job.posted.bytes, order->job.posted.len, &order->body))
		*result = http_error(request, 400,
		                     "expected a JSON object, such as {\"name\":\"pump\","
		                     "\"value\":true}");
	else if (!*body_string(&order->body, "name"))
		*result = http_error(request, 400, "expected \"name\": the name of a signal");
	else
		return true;
	return false;
}

static int command_give(struct request *request, void (*run)(struct job *job),
                        const char *(*wrong)(const struct body *body))
{
	struct order *order = (struct order *)http_job(request, sizeof(*order), run);
	int result = MHD_NO;

	if (!order)
		return MHD_NO;
	order->given_ns = ows_now();
	snprintf(order->instance, sizeof(order->instance), "%s",
	         request->web->face->arguments->instance);
	if (!may(request, order, &result)) {
		job_free(&order->job);
		return result;
	}
	if (wrong(&order->body)) {
		result = http_error(request, 400, "%s", wrong(&order->body));
		job_free(&order->job);
		return result;
	}
	return http_defer(request, request->web->commands, &order->job);
}

static const char *wrong_set(const struct body *body)
{
	const struct body_member *value = body_find(body, "value");

	return value && value->kind != BODY_NULL ? NULL : "expected \"value\": what to set";
}

static const char *wrong_alarm(const struct body *body)
{
	const struct body_member *seconds = body_find(body, "seconds");
	const char *what = deed(body);

	if (!strcmp(what, "ack") || !strcmp(what, "acknowledge") || !strcmp(what, "unshelve"))
		return NULL;
	if (strcmp(what, "shelve") != 0)
		return "expected \"do\": ack, shelve or unshelve";
	if (!seconds || seconds->kind != BODY_NUMBER ||
	    strspn(seconds->text, "0123456789") != strlen(seconds->text) ||
	    strlen(seconds->text) > 6 || strtol(seconds->text, NULL, 10) < 1 ||
	    strtol(seconds->text, NULL, 10) > OWS_SHELVE_MAX)
		return "expected \"seconds\": how long to shelve, from 1 to 604800";
	return strlen(body_string(body, "why")) < 64 ? NULL : "\"why\" is longer than 63 bytes";
}

int command_set(struct request *request)
{
	return command_give(request, run_set, wrong_set);
}

int command_alarm(struct request *request)
{
	return command_give(request, run_alarm, wrong_alarm);
}
