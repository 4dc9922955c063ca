/* SPDX-License-Identifier: MIT */
/* libmicrohttpd in the loop of the face. */
#include <errno.h>
#include <microhttpd.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

#include "hal/base/time.h"
#include "src/faces/kit/look.h"
#include "src/faces/show/json.h"
#include "src/faces/web/head.h"
#include "src/faces/web/http.h"
#include "src/faces/web/origin.h"

#define MEMORY (24u << 10) /* of a connection: its head twice, and what is sent */
#define SHORT (16u << 10)  /* an answer that is always given */
#define HELD (64u << 20)   /* sum of the answers that are being sent */
#define POLICY \
	"default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; " \
	"connect-src 'self'; manifest-src 'self'; worker-src 'self'; frame-ancestors 'self'; " \
	"base-uri 'none'; form-action 'none'"
/* of a browser; the page needs none */
#define FEATURES \
	"camera=(), display-capture=(), geolocation=(), microphone=(), midi=(), payment=(), " \
	"serial=(), usb=()"

const char *http_header(const struct request *request, const char *name)
{
	return MHD_lookup_connection_value(request->connection, MHD_HEADER_KIND, name);
}

const char *http_argument(const struct request *request, const char *name)
{
	return MHD_lookup_connection_value(request->connection, MHD_GET_ARGUMENT_KIND, name);
}

const char *http_named(const struct request *request)
{
	bool tcp = person_is_tcp(http_descriptor(request), (char[PERSON_ADDRESS]){0});

	return http_header(request, tcp ? "X-Remote-User-Name" : "X-Remote-User");
}

int http_descriptor(const struct request *request)
{
	const union MHD_ConnectionInfo *info = MHD_get_connection_info(
		request->connection, MHD_CONNECTION_INFO_CONNECTION_FD);

	return info ? info->connect_fd : -1;
}

/* --- Answers --------------------------------------------------------------------------------- */

int http_answer(struct request *request, unsigned status, struct MHD_Response *response)
{
	enum MHD_Result result;

	if (!response)
		return MHD_NO;
	MHD_add_response_header(response, "Connection", "close");
	MHD_add_response_header(response, "Content-Security-Policy", POLICY);
	MHD_add_response_header(response, "X-Content-Type-Options", "nosniff");
	MHD_add_response_header(response, "Referrer-Policy", "no-referrer");
	MHD_add_response_header(response, "Cross-Origin-Resource-Policy", "same-origin");
	MHD_add_response_header(response, "Permissions-Policy", FEATURES);
	MHD_add_response_header(response, "Cache-Control", "no-cache");
	result = MHD_queue_response(request->connection, status, response);
	MHD_destroy_response(response);
	return result;
}

int http_json(struct request *request, unsigned status, char *text, size_t len)
{
	struct MHD_Response *response;

	if (!text)
		return MHD_NO;
	if (len > SHORT && request->web->held + len > HELD) {
		free(text);
		return http_error(request, 503,
		                  "too many answers wait for slow readers: try again later");
	}
	request->held = len;
	request->web->held += len;
	response = MHD_create_response_from_buffer(len, text, MHD_RESPMEM_MUST_FREE);
	if (!response)
		free(text);
	else
		MHD_add_response_header(response, "Content-Type", "application/json");
	return http_answer(request, status, response);
}

int http_error(struct request *request, unsigned status, const char *format, ...)
{
	struct job job = {0};
	char words[512];
	va_list args;

	va_start(args, format);
	vsnprintf(words, sizeof(words), format, args);
	va_end(args);
	job_error(&job, status, "%s", words);
	return http_json(request, status, job.text, job.len);
}

struct job *http_job(struct request *request, size_t size, void (*run)(struct job *job))
{
	struct job *job = calloc(1, size);

	if (!job)
		return NULL;
	job->run = run;
	job->instance = request->web->face->arguments->instance;
	memcpy(job->person, request->person, sizeof(job->person));
	job->posted = request->posted;
	request->posted = (struct posted){0};
	return job;
}

int http_defer(struct request *request, enum web_worker worker, struct job *job)
{
	struct web *web = request->web;
	struct jobs **jobs = &web->workers[worker];

	if (!job)
		return MHD_NO;
	if (!*jobs && !web->ends && web->bell >= 0)
		*jobs = jobs_start(web->bell);
	job->peer = person_number(http_descriptor(request), &web->face->config->web,
	                          http_named(request));
	if (!*jobs || !jobs_give(*jobs, job)) {
		job_free(job);
		return http_error(request, 503, "too many requests: try again in a second");
	}
	request->job = job;
	job->request = request;
	MHD_suspend_connection(request->connection);
	return MHD_YES;
}

static void done(struct job *job)
{
	if (!job->request) {
		job_free(job);
		return;
	}
	job->request->answered = true;
	MHD_resume_connection(job->request->connection);
}

void http_done(struct web *web)
{
	struct job *job;

	for (int i = 0; i < WEB_WORKERS; i++)
		while (web->workers[i] && (job = jobs_take(web->workers[i])))
			done(job);
}

static int answer_job(struct request *request)
{
	struct job *job = request->job;
	char *text = job->text;

	job->text = NULL;
	return http_json(request, job->status, text, job->len);
}

static int answer_file(struct request *request, const char *path)
{
	bool gzip = files_takes_gzip(http_header(request, "Accept-Encoding"));
	const char *known = http_header(request, "If-None-Match");
	struct MHD_Response *response;
	unsigned status = 200;
	struct file file;
	int fd = files_find(request->web->files, path, gzip, &file);

	if (fd < 0 && !*path)
		return http_error(request, 404,
		                  "the files of the page are not here: install them, "
		                  "or name their directory by Files in Web { }");
	if (fd < 0)
		return http_error(request, 404, "there is no such path");
	if (known && strcmp(known, file.tag) == 0) {
		status = 304;
		close(fd);
		response = MHD_create_response_from_buffer(0, NULL, MHD_RESPMEM_PERSISTENT);
	} else {
		response = MHD_create_response_from_fd64(file.size, fd);
		if (!response)
			close(fd);
	}
	if (!response)
		return MHD_NO;
	MHD_add_response_header(response, "ETag", file.tag);
	MHD_add_response_header(response, "Vary", "Accept-Encoding");
	if (status == 200)
		MHD_add_response_header(response, "Content-Type", file.type);
	if (status == 200 && file.gzip)
		MHD_add_response_header(response, "Content-Encoding", "gzip");
	return http_answer(request, status, response);
}

/* --- Rights ---------------------------------------------------------------------------------- */

static bool is_json(const char *type)
{
	size_t len = strlen("application/json");

	return type && strncasecmp(type, "application/json", len) == 0 &&
	       (!type[len] || type[len] == ';' || type[len] == ' ');
}

bool http_may(const struct request *request, enum person_deed deed, char person[PERSON],
              const char **why)
{
	return person_may_do(http_descriptor(request), &request->web->face->config->web, deed,
	                     http_named(request), person, why);
}

/*
 * May this request do what it asks? By headers that only the page sends, and the person. Returns 0,
 * or the status of the refusal, with the reason in *why. Looks at the head alone, and reads
 * /etc/passwd and /etc/group.
 */
static unsigned guard(struct request *request, const struct web_path *path, const char **why)
{
	const char *mark = http_header(request, "X-Owsd");

	if (path->deed == PERSON_LOOK)
		return 0;
	*why = "expected Content-Type: application/json";
	if (path->post && !is_json(http_header(request, "Content-Type")))
		return 415;
	*why = "expected the header X-Owsd: 1";
	return mark && strcmp(mark, "1") == 0 && http_may(request, path->deed, request->person, why)
	               ? 0
	               : 403;
}

/* --- Requests -------------------------------------------------------------------------------- */

static bool is_foreign(const struct request *request)
{
	return origin_foreign(http_header(request, "Host"), http_header(request, "Origin"),
	                      http_header(request, "Sec-Fetch-Site"));
}

static int answer_path(struct request *request, const struct web_path *path)
{
	const struct face *face = request->web->face;
	const char *why;
	unsigned status = guard(request, path, &why);
	struct json json;
	char *text;
	size_t len;

	if (status)
		return http_error(request, status, "%s", why);
	if (request->posted.dropped)
		return http_error(request, 503,
		                  "others are editing just now: try again in a second");
	if (path->need == WEB_IMAGE && !face->ows)
		return http_error(request, 503, "owsd %s has not run yet: start it",
		                  face->arguments->instance);
	if (path->need == WEB_OWSD && !look_is_current(face))
		return http_error(request, 503, "owsd %s is not running: start it",
		                  face->arguments->instance);
	if (path->answer)
		return path->answer(request);
	if (!json_start(&json, &text, &len))
		return MHD_NO;
	path->put(&json, request);
	json_finish(&json);
	return http_json(request, 200, text, len);
}

static int answer(struct request *request, const char *url, bool post)
{
	const struct web_path *path = request->web->route(url + 1, post);

	/* the files of the page may be asked for from anywhere, as by a link to it */
	if ((path || post) && is_foreign(request))
		return http_error(request, 403,
		                  "this request comes from another page: open that "
		                  "of this owsd-web itself");
	if (path)
		return answer_path(request, path);
	if (post)
		return http_error(request, 404, "there is no such path to post to");
	return answer_file(request, url + 1);
}

/*
 * 0, or the status of a refusal. Is it asked for under a name that is this machine's? The socket
 * has rights in place of that, and a proxy looks at the name itself.
 */
static unsigned refused(const struct request *request, const char **why)
{
	const struct config_web *options = &request->web->face->config->web;
	const char *host = http_header(request, "Host");
	char local[PERSON_ADDRESS], machine[256] = "";
	int fd = http_descriptor(request);

	if (!person_is_tcp(fd, local) || person_is_proxy(fd, options))
		return 0;
	*why = "at addresses the proxy alone is served, whose address Proxy in Web { } names";
	if (options->proxy_at.bits)
		return 403;
	gethostname(machine, sizeof(machine) - 1);
	*why = "this machine is not known by that name: add it to Hosts in Web { }";
	return host && origin_host(host, local, machine, options->hosts) ? 0 : 421;
}

/*
 * The head has passed head_check(): its length is a number. A large body is that of a
 * configuration, by a person who may edit it.
 */
static void expect_body(struct request *request, const char *url)
{
	const char *length = http_header(request, "Content-Length"), *why;
	size_t size = length ? strtoul(length, NULL, 10) : 0;
	const struct web_path *path = head_large(url) ? request->web->route(url + 1, true) : NULL;
	bool may = size > BODY_MAX && path && !is_foreign(request) && !guard(request, path, &why);

	posted_begin(&request->posted, size, &request->web->large, may, ows_now());
}

/* Notes when who begins a connection may have sent its head, until its end. */
static void meet(void *cls, struct MHD_Connection *connection, void **own,
                 enum MHD_ConnectionNotificationCode code)
{
	const union MHD_ConnectionInfo *info = MHD_get_connection_info(
		connection, MHD_CONNECTION_INFO_CONNECTION_FD);
	struct web *web = cls;
	int64_t *came_ns;

	if (code == MHD_CONNECTION_NOTIFY_CLOSED) {
		if (info)
			doors_leave(&web->doors, info->connect_fd);
		free(*own);
		return;
	}
	came_ns = malloc(sizeof(*came_ns));
	if (came_ns)
		*came_ns = web->doors.head_ns;
	*own = came_ns;
}

static int64_t came(struct MHD_Connection *connection)
{
	const union MHD_ConnectionInfo *info = MHD_get_connection_info(
		connection, MHD_CONNECTION_INFO_SOCKET_CONTEXT);

	return info && info->socket_context ? *(const int64_t *)info->socket_context : 0;
}

static enum MHD_Result handle(void *cls, struct MHD_Connection *connection, const char *url,
                              const char *method, const char *version, const char *data,
                              size_t *size, void **own)
{
	struct request *request = *own;
	bool post = strcmp(method, "POST") == 0;
	unsigned status;
	const char *why;

	(void)version;
	if (!request) {
		request = calloc(1, sizeof(*request));
		if (!request)
			return MHD_NO;
		request->web = cls;
		request->connection = connection;
		request->came_ns = came(connection);
		*own = request;
		/* libmicrohttpd leaves out the body */
		request->head = strcmp(method, "HEAD") == 0;
		if (!post && !request->head && strcmp(method, "GET") != 0)
			return (enum MHD_Result)http_error(request, 405, "GET, HEAD or POST");
		status = refused(request, &why);
		if (status)
			return (enum MHD_Result)http_error(request, status, "%s", why);
		expect_body(request, url);
		return MHD_YES;
	}
	if (*size) {
		if (!post || !posted_add(&request->posted, data, *size, ows_now()))
			return MHD_NO;
		*size = 0;
		return MHD_YES;
	}
	return (enum MHD_Result)(request->job ? answer_job(request) : answer(request, url, post));
}

static void completed(void *cls, struct MHD_Connection *connection, void **own,
                      enum MHD_RequestTerminationCode code)
{
	struct request *request = *own;

	(void)cls;
	(void)connection;
	(void)code;
	if (request && request->job && request->answered)
		job_free(request->job);
	else if (request && request->job)
		request->job->request = NULL;
	if (request) {
		posted_free(&request->posted);
		request->web->held -= request->held;
	}
	free(request);
	*own = NULL;
}

/* --- The daemon ------------------------------------------------------------------------------ */

static void welcome(void *ctx, int fd, const struct sockaddr *address, socklen_t len)
{
	struct web *web = ctx;

	/* closes fd also when it fails */
	MHD_add_connection(web->daemon, fd, address, len);
}

static unsigned count_inside(void *ctx)
{
	const struct web *web = ctx;
	const union MHD_DaemonInfo *info = MHD_get_daemon_info(web->daemon,
	                                                       MHD_DAEMON_INFO_CURRENT_CONNECTIONS);

	return info ? info->num_connections : 0;
}

static bool is_proxy(void *ctx, int fd)
{
	const struct web *web = ctx;

	return person_is_proxy(fd, &web->face->config->web);
}

int http_open(struct web *web)
{
	const union MHD_DaemonInfo *info;

	web->daemon = MHD_start_daemon(
		MHD_USE_EPOLL | MHD_USE_NO_LISTEN_SOCKET | MHD_ALLOW_SUSPEND_RESUME, 0, NULL, NULL,
		handle, web, MHD_OPTION_CONNECTION_LIMIT, (unsigned)DOORS_CONNECTIONS,
		MHD_OPTION_NOTIFY_CONNECTION, meet, web, MHD_OPTION_CONNECTION_TIMEOUT,
		(unsigned)DOORS_IDLE_S, MHD_OPTION_CONNECTION_MEMORY_LIMIT, (size_t)MEMORY,
		MHD_OPTION_NOTIFY_COMPLETED, completed, NULL, MHD_OPTION_END);
	if (!web->daemon)
		return -ENOMEM;
	info = MHD_get_daemon_info(web->daemon, MHD_DAEMON_INFO_EPOLL_FD);
	web->epoll = info ? info->epoll_fd : -1;
	web->doors.welcome = welcome;
	web->doors.count_inside = count_inside;
	web->doors.is_proxy = is_proxy;
	web->doors.ctx = web;
	return web->epoll < 0 ? -ENOTSUP : 0;
}

void http_run(struct web *web)
{
	MHD_run(web->daemon);
}

int64_t http_next(const struct web *web, int64_t now_ns)
{
	MHD_UNSIGNED_LONG_LONG ms;

	if (MHD_get_timeout(web->daemon, &ms) != MHD_YES)
		return INT64_MAX;
	return now_ns + (int64_t)(ms > 60000 ? 60000 : ms) * NS_PER_MS;
}

void http_close(struct web *web)
{
	if (web->daemon)
		MHD_stop_daemon(web->daemon);
	web->daemon = NULL;
}
