/* SPDX-License-Identifier: MIT */
/* Commands, on the worker for them: libows waits for owsd's answer. */
#include <errno.h>
#include <math.h>
#include <microhttpd.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>

#include "hal/base/time.h"
#include "src/faces/kit/body.h"
#include "src/faces/kit/command.h"
#include "src/faces/show/json.h"
#include "src/faces/show/names.h"
#include "src/faces/show/present.h"
#include "src/faces/web/http.h"
#include "src/faces/web/paths.h"
#include "src/ground/signal/value.h"

#define CONFIRM_NS NS_PER_S     /* so long a page waits for the bus */
#define TAKEN_NS (2 * NS_PER_S) /* and for owsd */

struct order {
	struct job job;
	int64_t came_ns;
	int fd; /* of the request */
	struct body body;
	struct ows *h;
	int id;
	bool special; /* it is no value of a signal: no device confirms it */
	bool readable;
	struct ows_info info;
};

static void command_answer(struct order *order, const char *result)
{
	struct json json;

	if (!job_json(&order->job, 200, &json))
		return;
	json_bool(&json, "ok", true);
	json_string(&json, "result", result);
	json_finish(&json);
}

static struct face_command command_of(const struct order *order)
{
	const struct body_member *value = body_find(&order->body, "value");

	return (struct face_command){
		.program = "owsd-web",
		.instance = order->job.instance,
		.name = body_string(&order->body, "name"),
		.text = value && value->kind != BODY_NULL ? value->text : NULL,
		.person = order->job.person,
		.came_ns = order->came_ns,
	};
}

static unsigned status_of(int err)
{
	switch (-err) {
	case EACCES:
	case EROFS:
		return 403;
	case ERANGE:
	case EINVAL:
	case EOPNOTSUPP:
		return 400;
	case ENOENT:
		return 404;
	case ENOSPC:
	case EBUSY:
	case EAGAIN:
	case ETIME:
	case ESTALE:
	case ETIMEDOUT:
		return 503;
	default:
		return 500;
	}
}

static void command_refuse(struct order *order, int err)
{
	struct face_command command = command_of(order);
	char words[FACE_REFUSAL];

	job_error(&order->job, status_of(err), "%s: %s", command.name,
	          err == -EOPNOTSUPP ? "it has no limit alarms"
	                             : face_refusal(&command, &order->info, err, words));
}

/* A special signal that may be set, such as room_WriteEnable: info is that of a signal like it. */
static int find_special(struct order *order)
{
	enum attribute attribute;
	int signal, id, err;

	if (names_lookup(order->h, order->job.instance, body_string(&order->body, "name"), &signal,
	                 &attribute) ||
	    attribute_table[attribute].driver || !attribute_table[attribute].writable ||
	    ows_info(order->h, signal, &order->info))
		return -ENOENT;
	order->special = true;
	order->readable = attribute_table[attribute].readable;
	order->info.type = attribute_table[attribute].type;
	order->info.min = order->info.max = NAN;
	id = ows_find(order->h, body_string(&order->body, "name"));
	err = id < 0 ? id : ows_for(order->h, order->job.person);
	return err ? err : id;
}

/* Connect, and find the signal. False after answering. */
static bool command_begin(struct order *order)
{
	struct face_command command = command_of(order);
	int err;

	/* whoever gave it has given it up; the connection lasts as long as the job */
	if (recv(order->fd, &(char){0}, 1, MSG_PEEK | MSG_DONTWAIT) == 0) {
		job_error(&order->job, 503, "%s: not set: the client has hung up", command.name);
		return false;
	}
	err = ows_open_as(order->job.instance, OWS_CONTROL, "owsd-web", &order->h);
	if (err == -ENOENT)
		err = -ESTALE; /* of owsd, not of the name */
	if (!err) {
		order->id = face_command_find(order->h, &command, &order->info);
		if (order->id == -ENOENT)
			order->id = find_special(order);
		err = order->id < 0 ? order->id : 0;
	}
	if (err)
		command_refuse(order, err);
	return !err;
}

/* owsd shows what it has taken of a special signal; what none shows is only sent. */
static const char *special_result(struct order *order, const struct face_command *given)
{
	int64_t until_ns = ows_now() + TAKEN_NS;
	enum ows_type type = (enum ows_type)order->info.type;
	struct ows_value value = {0};
	int64_t wanted = 0;
	uint32_t news = 0;

	if (!order->readable || value_parse(type, given->text, &wanted))
		return "sent";
	while (ows_get(order->h, order->id, ows_now(), &value) || value.integer != wanted) {
		if (ows_now() >= until_ns)
			return "pending";
		ows_wait(order->h, &news, 50 * NS_PER_MS);
	}
	return "taken";
}

/* --- Values ---------------------------------------------------------------------------------- */

static void run_set(struct job *job)
{
	struct order *order = (struct order *)job;
	int64_t until_ns = ows_now() + CONFIRM_NS;
	struct face_command given = command_of(order);
	struct ows_command command = {0};
	uint32_t stamp = 0, news = 0;
	int err;

	if (command_begin(order)) {
		err = face_command_set(order->h, &given, order->id, &order->info, &stamp);
		while (!err && !order->special && ows_now() < until_ns) {
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
		else if (order->special)
			command_answer(order, special_result(order, &given));
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
	return standing_unacknowledged(&state);
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

static void run_alarm(struct job *job)
{
	struct order *order = (struct order *)job;
	const struct body_member *seconds = body_find(&order->body, "seconds");
	const char *why = body_string(&order->body, "why"), *what = body_string(&order->body, "do");
	int err;

	if (command_begin(order)) {
		if (order->special)
			err = -EOPNOTSUPP;
		else if (*what == 'a')
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

/* Reads the body; what is wrong in it, or NULL. */
static const char *wrong_body(struct order *order, const char *(*wrong)(const struct body *body))
{
	if (body_parse(order->job.posted.bytes, order->job.posted.len, &order->body))
		return "expected a JSON object, such as {\"name\":\"pump\",\"value\":true}";
	if (!*body_string(&order->body, "name"))
		return "expected \"name\": the name of a signal";
	return wrong(&order->body);
}

static int command_give(struct request *request, void (*run)(struct job *job),
                        const char *(*wrong)(const struct body *body))
{
	struct order *order = (struct order *)http_job(request, sizeof(*order), run);
	const char *why;
	int result;

	if (!order)
		return MHD_NO;
	order->came_ns = request->came_ns;
	order->fd = http_descriptor(request);
	why = wrong_body(order, wrong);
	if (!why)
		return http_defer(request, WEB_COMMANDS, &order->job);
	result = http_error(request, 400, "%s", why);
	job_free(&order->job);
	return result;
}

static const char *wrong_set(const struct body *body)
{
	const struct body_member *value = body_find(body, "value");

	return value && value->kind != BODY_NULL ? NULL : "expected \"value\": what to set";
}

static const char *wrong_alarm(const struct body *body)
{
	const struct body_member *seconds = body_find(body, "seconds");
	const char *what = body_string(body, "do");

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
