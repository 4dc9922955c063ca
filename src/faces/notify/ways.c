/* SPDX-License-Identifier: MIT */
/* The ways to people: which entries are due, one message at a time, its end, the next attempt. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "hal/base/time.h"
#include "src/faces/kit/arguments.h"
#include "src/faces/notify/message.h"
#include "src/faces/notify/queue.h"
#include "src/faces/notify/ways.h"
#include "src/public/ows.h"

#define TICK_NS NS_PER_S
#define RUNS_NS (100 * NS_PER_MS)

void ways_open(struct ways *ways, struct log *log, const char *instance,
               void (*watch)(void *ctx, int fd, short events), void *ctx)
{
	ways->log = log;
	ways->instance = instance;
	if (gethostname(ways->host, sizeof(ways->host) - 1))
		snprintf(ways->host, sizeof(ways->host), "?");
	ways->post = post_open(watch, ctx);
}

static const char *way_key(const struct config_notify *notify, enum way_kind kind)
{
	const char *const keys[] = {notify->mail, notify->escalate_mail, notify->url,
	                            notify->command};

	return keys[kind];
}

bool ways_has(const struct config_notify *notify, enum way_kind kind)
{
	return way_key(notify, kind);
}

static const char *ways_name(enum way_kind kind)
{
	static const char *const names[] = {"Mail", "EscalateMail", "Url", "Command"};

	return names[kind];
}

bool ways_tells(enum way_kind kind, bool escalated)
{
	return kind == WAY_MAIL ? !escalated : kind == WAY_ESCALATE ? escalated : true;
}

struct entry *ways_add(struct ways *ways)
{
	struct queue *queue = &ways->queue;
	uint64_t told = queue->end, leaves;

	/* what every way has told needs no place */
	for (int i = 0; i < WAYS; i++)
		told = ways->way[i].next < told ? ways->way[i].next : told;
	queue->first = told > queue->first ? told : queue->first;
	leaves = queue_leaves(queue);
	for (int i = 0; leaves < queue->end && i < WAYS; i++) {
		struct way *way = &ways->way[i];
		bool under_way = way->busy && leaves < way->end;

		if (leaves < way->next)
			continue;
		way->next++;
		way->end += way->busy && !under_way;
		if (ways_tells((enum way_kind)i, queue_at(queue, leaves)->escalated))
			*(under_way ? &way->gone : &way->missed) += 1;
	}
	return queue_add(queue);
}

/* --- The end of a message -------------------------------------------------------------------- */

static void way_over(struct way *way)
{
	free(way->data);
	way->data = NULL;
	way->busy = false;
}

static void told(struct ways *ways, struct way *way, int64_t now_ns)
{
	if (*way->why && ways->log)
		log_notice(ways->log, "%s works again",
		           ways_name((enum way_kind)(way - ways->way)));
	way->why[0] = '\0';
	way->told++;
	way->lost += way->out;
	way->missed -= way->out;
	way->gone = 0;
	way->next = way->end;
	way->sent_ns = now_ns;
	backoff_forget(&way->backoff);
	way_over(way);
}

static void not_told(struct ways *ways, struct way *way, enum backoff_why kind, const char *why,
                     int64_t now_ns)
{
	bool news = strncmp(way->why, why, sizeof(way->why) - 1) != 0;

	if (news && ways->log)
		log_err(ways->log, "%s: %s; %llu alarms wait",
		        ways_name((enum way_kind)(way - ways->way)), why,
		        (unsigned long long)(ways->queue.end - way->next));
	if (news)
		snprintf(way->why, sizeof(way->why), "%s", why);
	way->failed++;
	way->missed += way->gone;
	way->gone = 0;
	way->retry_ns = now_ns + backoff_pause(&way->backoff, kind, backoff_random());
	way_over(way);
}

static void post_over(struct ways *ways, const struct post_result *result, int64_t now_ns)
{
	struct way *way = &ways->way[WAY_POST];
	long status = result->status;

	if (status >= 200 && status < 300)
		told(ways, way, now_ns);
	else
		not_told(ways, way, post_why(status), result->words, now_ns);
}

static void run_over(struct ways *ways, struct way *way, int64_t now_ns)
{
	char why[RUN_WORDS];
	int err = run_step(&way->run, now_ns, why);

	if (err == -EINPROGRESS)
		return;
	if (err)
		not_told(ways, way, BACKOFF_REFUSED, why, now_ns);
	else
		told(ways, way, now_ns);
}

/* --- Its begin ------------------------------------------------------------------------------- */

static int begin_mail(struct way *way, const struct message *message,
                      const struct config_notify *notify, const char *to)
{
	const char *const argv[] = {notify->sendmail, "-t", "-oi", NULL};
	const char *const none[] = {NULL};
	size_t len;
	FILE *out = open_memstream(&way->data, &len);

	if (!out)
		return -ENOMEM;
	message_mail(message, to, notify->mail_from, out);
	return fclose(out) ? -ENOMEM : run_begin(&way->run, argv, way->data, len, none);
}

static int begin_command(struct way *way, const struct message *message, const char *command)
{
	char title[MESSAGE_TITLE], instance[128], count[48];
	const char *argv[] = {command, message_title(message, title), NULL, NULL};
	const char *const more[] = {instance, count, NULL};
	size_t len;
	FILE *out = open_memstream(&way->data, &len);

	if (!out)
		return -ENOMEM;
	message_text(message, out);
	if (fclose(out))
		return -ENOMEM;
	argv[2] = way->data;
	snprintf(instance, sizeof(instance), "OWSD_INSTANCE=%.100s", message->instance);
	snprintf(count, sizeof(count), "OWSD_COUNT=%u", message->count);
	return run_begin(&way->run, argv, way->data, len, more);
}

static int begin_post(struct ways *ways, const struct message *message,
                      const struct config_notify *notify, char *why, size_t size)
{
	struct way *way = &ways->way[WAY_POST];
	bool within;
	size_t len;
	FILE *out;
	int err = secret_read(notify->token_file, ways->token, why, size);

	if (err)
		return err;
	out = ways->post ? open_memstream(&way->data, &len) : NULL;
	if (!out)
		return -ENOMEM;
	message_json(message, out);
	within = message_url(notify->url, ways->token, ways->url, sizeof(ways->url));
	if (fclose(out))
		return -ENOMEM;
	return post_begin(ways->post, &(struct post_what){.url = within ? ways->url : notify->url,
	                                                  .type = "application/json",
	                                                  .scheme = "Bearer",
	                                                  .token = within ? "" : ways->token,
	                                                  .data = way->data,
	                                                  .len = len});
}

/* Is it the time of the day at which no message goes but of critical alarms, or none? */
static bool is_quiet(const struct config_notify *notify)
{
	time_t now = time(NULL);
	struct tm local;

	return notify->quiet && localtime_r(&now, &local) &&
	       rules_quiet(notify->quiet, (unsigned)(local.tm_hour * 60 + local.tm_min));
}

/* All that waits for the way, critical entries first. False: nothing does, or it is not due. */
static bool gather(struct ways *ways, const struct config_notify *notify, enum way_kind kind,
                   int64_t now_ns, struct message *message)
{
	struct way *way = &ways->way[kind];
	struct queue *queue = &ways->queue;
	bool out[QUEUE_ENTRIES] = {false};
	int64_t came_ns = INT64_MAX;

	/* first of all: it may change how severe one is */
	for (uint64_t n = way->next; n < queue->end; n++)
		out[n % QUEUE_ENTRIES] = ways->judge &&
		                         !ways->judge(ways->judge_ctx, queue_at(queue, n));
	way->out = way->missed;
	way->end = queue->end;
	message->others = way->out;
	for (int critical = 1; critical >= 0; critical--)
		for (uint64_t n = way->next; n < way->end; n++) {
			struct entry *entry = queue_at(queue, n);

			if (entry->critical != critical || !ways_tells(kind, entry->escalated) ||
			    out[n % QUEUE_ENTRIES])
				continue;
			message_add(message, entry);
			if (entry->came_ns < came_ns)
				came_ns = entry->came_ns;
		}
	if (!message->count)
		way->next = way->end;
	return message->count && now_ns >= way->retry_ns && now_ns - came_ns >= notify->gather_ns &&
	       (!way->sent_ns || now_ns - way->sent_ns >= notify->every_ns) &&
	       ((message->list[0]->critical && !notify->quiet_all) || !is_quiet(notify));
}

static void begin(struct ways *ways, const struct config_notify *notify, enum way_kind kind,
                  int64_t now_ns)
{
	struct way *way = &ways->way[kind];
	struct message message = {.instance = ways->instance,
	                          .host = ways->host,
	                          .link = notify->link,
	                          .fields = notify->fields};
	char why[SECRET_PATH + 128] = "";
	int err = 0;

	if (ways->held || !gather(ways, notify, kind, now_ns, &message))
		return;
	if (kind == WAY_POST)
		err = begin_post(ways, &message, notify, why, sizeof(why));
	else if (kind == WAY_COMMAND)
		err = begin_command(way, &message, notify->command);
	else
		err = begin_mail(way, &message, notify, way_key(notify, kind));
	way->busy = !err;
	if (err && !*why)
		snprintf(why, sizeof(why), "%s: %s",
		         kind == WAY_POST      ? "a POST"
		         : kind == WAY_COMMAND ? notify->command
		                               : notify->sendmail,
		         run_why(err));
	if (err)
		not_told(ways, way, BACKOFF_REFUSED, why, now_ns);
}

void ways_step(struct ways *ways, const struct config_notify *notify, int fd, short ready,
               int64_t now_ns)
{
	struct post_result result;

	if (ways->post && (fd >= 0 || now_ns >= post_next(ways->post)) &&
	    post_step(ways->post, fd, ready, &result))
		post_over(ways, &result, now_ns);
	for (int i = 0; i < WAYS; i++) {
		struct way *way = &ways->way[i];

		if (way->busy && way->run.pid)
			run_over(ways, way, now_ns);
		if (!way->busy && !ways_has(notify, (enum way_kind)i)) {
			way->next = ways->queue.end;
			way->missed = 0;
			way->why[0] = '\0';
		} else if (!way->busy) {
			begin(ways, notify, (enum way_kind)i, now_ns);
		}
	}
}

void ways_again(struct ways *ways)
{
	for (int i = 0; i < WAYS; i++) {
		ways->way[i].retry_ns = 0;
		backoff_forget(&ways->way[i].backoff);
	}
}

int64_t ways_next(const struct ways *ways, int64_t now_ns)
{
	int64_t next_ns = now_ns + TICK_NS;

	for (int i = 0; i < WAYS; i++)
		if (ways->way[i].run.pid)
			next_ns = now_ns + RUNS_NS;
	return ways->post && post_next(ways->post) < next_ns ? post_next(ways->post) : next_ns;
}

void ways_close(struct ways *ways)
{
	for (int i = 0; i < WAYS; i++) {
		run_kill(&ways->way[i].run);
		if (i == WAY_POST && ways->post)
			post_cancel(ways->post);
		way_over(&ways->way[i]);
	}
	post_close(ways->post);
	ways->post = NULL;
}

/* --- The test -------------------------------------------------------------------------------- */

static void test_watch(void *ctx, int fd, short events)
{
	(void)ctx, (void)fd, (void)events;
}

/* Wait a moment for what is under way, and step: there is no loop of a face. */
static void ways_wait(struct ways *ways, const struct config_notify *notify)
{
	struct post_result result;
	int64_t now_ns = ows_now();

	ways_step(ways, notify, -1, 0, now_ns);
	if (!ways->post || !post_is_busy(ways->post))
		nanosleep(&(struct timespec){.tv_nsec = RUNS_NS}, NULL);
	else if (post_wait(ways->post, now_ns + RUNS_NS, &result))
		post_over(ways, &result, ows_now());
}

/* Each way by itself, with what it says. */
int ways_test(struct ways *ways, const struct config_notify *given, const char *program,
              const char *instance)
{
	struct config_notify file = *given;
	struct entry entry = {.critical = true, .signal = -1};
	int failed = 0;

	ways_open(ways, NULL, instance, test_watch, NULL);
	file.gather_ns = 0;
	file.quiet = NULL;
	for (int second = 0; second < 2; second++) {
		entry.escalated = second;
		message_line(&entry, "%s", "test; owsd-notify --test has sent this");
		*ways_add(ways) = entry;
	}
	for (int i = 0; i < WAYS; i++) {
		struct way *way = &ways->way[i];

		if (!ways_has(&file, (enum way_kind)i))
			continue;
		do {
			ways_wait(ways, &file);
		} while (!way->told && !way->failed);
		failed += !way->told;
		if (way->told)
			printf("%s: told\n", ways_name((enum way_kind)i));
		else
			face_complain(program, "%s: %s", ways_name((enum way_kind)i), way->why);
	}
	ways_close(ways);
	return failed ? -EIO : 0;
}
