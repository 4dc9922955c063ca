/* SPDX-License-Identifier: MIT */
/*
 * owsd-notify: tells people of alarms. Entries of owsd's journal, values that stay bad and alarms
 * that nobody acknowledges become lines of a queue, and messages of it go by mail, POST or command.
 */
#include <errno.h>
#include <inttypes.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/time.h"
#include "src/faces/kit/look.h"
#include "src/faces/kit/loop.h"
#include "src/faces/kit/secret.h"
#include "src/faces/notify/kept.h"
#include "src/faces/notify/message.h"
#include "src/faces/notify/queue.h"
#include "src/faces/notify/rows.h"
#include "src/faces/notify/ways.h"
#include "src/faces/show/digits.h"
#include "src/faces/show/newest.h"
#include "src/faces/show/present.h"

#define AFTER_NS (2 * NS_PER_S) /* the value after a device's alarm */

static struct notifying {
	struct ways ways;
	struct rows rows;
	int64_t lost_ns; /* since when there is no owsd; 0: it is there */
	bool lost_told;
	int64_t known_ns;  /* entries of the journal up to there were told before this start */
	int64_t seen_ns;   /* and up to there are in the queue */
	int64_t looked_ns; /* alarms that were raised up to there were looked at for escalation */
	int64_t found_ns;  /* the same, when there was one last: to be kept */
	struct kept kept;
} notify;

static const struct config_notify *file_of(const struct face *face)
{
	return &face->config->notify;
}

/*
 * All that was entered in the journal up to then, until_ns at most, every way has told, or need
 * not: as escalated, or for the first time.
 */
static int64_t all_told(const struct face *face, bool escalated, int64_t until_ns)
{
	int64_t oldest = INT64_MAX;

	for (int i = 0; i < WAYS; i++)
		if (ways_has(file_of(face), (enum way_kind)i) &&
		    ways_tells((enum way_kind)i, escalated)) {
			int64_t ns = queue_oldest(&notify.ways.queue, notify.ways.way[i].next,
			                          escalated);

			oldest = ns < oldest ? ns : oldest;
		}
	return oldest <= until_ns ? oldest - 1 : until_ns;
}

static void keep(struct face *face, int64_t looked_ns, int64_t now_ns)
{
	kept_write(&notify.kept, face->log, all_told(face, false, notify.seen_ns),
	           all_told(face, true, looked_ns), now_ns);
}

/* --- What is told ---------------------------------------------------------------------------- */

/* signal: that it is about; -1: none */
static void put(struct face *face, int signal, const struct entry *entry)
{
	const struct config_notify *file = file_of(face);
	struct entry *one;

	if (!file->given || (!entry->severe && !strcmp(file->least, "critical")))
		return;
	one = ways_add(&notify.ways);
	*one = *entry;
	one->came_ns = ows_now();
	one->signal = signal;
	one->print = signal < 0 ? 0 : notify.rows.row[signal].print;
	log_info(face->log, "to be told: %s", entry->text);
}

/* Since when nobody acknowledges it: what is raised anew meanwhile is no new beginning. */
static void follow(const struct face *face, struct row *row, const struct ows_alarm *alarm)
{
	bool deed = alarm->event == OWS_ALARM_ACKNOWLEDGED || alarm->event == OWS_ALARM_SHELVED;
	struct ows_alarm_state state;
	struct ows_info info;

	if (alarm->event != OWS_ALARM_RAISED && alarm->event != OWS_ALARM_RETURNED && !deed)
		return;
	/* HH that falls to H is entered as returned, and the alarm stands on */
	if (alarm->event == OWS_ALARM_RETURNED && rules_of_limit(alarm->kind) &&
	    standing_find(face->ows, alarm->signal, &info, &state))
		return;
	if (alarm->event != OWS_ALARM_RAISED)
		queue_ended(&notify.ways.queue, alarm->signal, deed ? OWS_ALARM_H : alarm->kind,
		            ows_alarm_event_text(alarm->event), alarm->occurred_ns);
	if (!deed && !rules_of_limit(alarm->kind))
		return;
	if (alarm->event != OWS_ALARM_RAISED)
		row->raised_ns = 0;
	else if (row->raised_ns <= notify.looked_ns)
		row->raised_ns = alarm->occurred_ns;
}

static void take_alarm(struct face *face, const struct ows_alarm *alarm)
{
	struct when now = when_now();
	struct entry entry = {.critical = rules_urgent(alarm), .severe = rules_critical(alarm)};
	struct ows_info info;
	struct row *row;

	if (alarm->occurred_ns > notify.seen_ns)
		notify.seen_ns = alarm->occurred_ns;
	if (alarm->signal < 0 || alarm->signal >= notify.rows.count)
		return;
	row = &notify.rows.row[alarm->signal];
	if (!row->chosen || ows_info(face->ows, alarm->signal, &info))
		return;
	follow(face, row, alarm);
	if (alarm->occurred_ns <= notify.known_ns ||
	    (alarm->event != OWS_ALARM_RAISED && alarm->event != OWS_ALARM_FAILED &&
	     !(alarm->event == OWS_ALARM_RETURNED && file_of(face)->returns)))
		return;
	message_alarm(&entry, &info, alarm, &now);
	put(face, alarm->signal, &entry);
}

/* The words for an alarm that nobody acknowledges. False: it is none, or not any more. */
static bool write_escalated(struct face *face, int signal, int64_t raised_ns,
                            const struct when *now, struct entry *entry)
{
	struct face_value value;
	struct ows_alarm_state state;
	struct ows_info info;

	if (!standing_find(face->ows, signal, &info, &state))
		return false;
	face_value(face->ows, signal, face->live, now->boot, &value);
	if (value.good && value.v.type != OWS_STRING)
		digits_print((enum ows_type)value.v.type, value.v.number, value.v.integer,
		             info.decimals, value.text);
	else
		value.text[0] = '\0';
	entry->severe = entry->critical = rules_critical(
		&(struct ows_alarm){.kind = state.limit_kind});
	message_escalated(entry, &info, state.limit_kind, raised_ns, value.text, now);
	return true;
}

/* Alarms of the time that is over now, each once. */
static void look_for_escalation(struct face *face)
{
	struct when now = when_now();
	int64_t until_ns = now.boot - file_of(face)->escalate_ns;

	if (!file_of(face)->escalate_ns || !look_is_current(face) || until_ns <= notify.looked_ns)
		return;
	for (int i = 0; i < notify.rows.count; i++) {
		int64_t raised_ns = notify.rows.row[i].raised_ns;
		struct entry entry = {0};

		if (raised_ns <= notify.looked_ns || raised_ns > until_ns)
			continue;
		if (write_escalated(face, i, raised_ns, &now, &entry))
			put(face, i, &entry);
		notify.found_ns = until_ns;
	}
	notify.looked_ns = until_ns;
}

/*
 * Is what waits still to be told, now that it can be? What has happened is, and says how it ended;
 * that something is to be done only if it still is.
 */
static bool judge(void *ctx, struct entry *entry)
{
	struct face *face = ctx;
	const struct config_notify *file = file_of(face);
	struct when now = when_now();

	if (entry->signal >= 0 && !notify.rows.row[entry->signal].chosen)
		return false;
	if (entry->escalated &&
	    (!file->escalate_ns || entry->signal < 0 || entry->ended_ns ||
	     (face->live && !write_escalated(face, entry->signal, entry->entered_ns, &now, entry))))
		return false;
	message_renew(entry, &now);
	return entry->severe || strcmp(file->least, "critical") != 0;
}

static void tell_bad(struct face *face, int signal, struct row *row, const struct when *now)
{
	struct entry entry = {0};
	struct face_value value;
	struct ows_info info;

	if (ows_info(face->ows, signal, &info))
		return;
	face_value(face->ows, signal, face->live, now->boot, &value);
	row->told = true;
	message_bad(&entry, &info, row->bad_ns, face_value_why(&value), face_value_remedy(&value),
	            now);
	put(face, signal, &entry);
}

static void tell_owsd(struct face *face, uint8_t kind, const char *words)
{
	struct entry entry = {.kind = kind, .severe = true, .critical = kind == ENTRY_NO_OWSD};

	message_line(&entry, "owsd %s %s", face->arguments->instance, words);
	put(face, -1, &entry);
}

static void look_for_bad(struct face *face, int64_t now_ns)
{
	int64_t after_ns = file_of(face)->bad_after_ns;
	struct when now = when_now();

	if (!after_ns)
		return;
	if (notify.lost_ns && !notify.lost_told && now_ns - notify.lost_ns >= after_ns) {
		tell_owsd(face, ENTRY_NO_OWSD, "is not running; no value is known");
		notify.lost_told = true;
	}
	for (int i = 0; look_is_current(face) && i < notify.rows.count; i++) {
		struct row *row = &notify.rows.row[i];

		if (row->bad_ns && !row->told && now_ns - row->bad_ns >= after_ns)
			tell_bad(face, i, row, &now);
	}
}

/* --- The signals ----------------------------------------------------------------------------- */

static void make_rows(struct face *face)
{
	if (!rows_make(&notify.rows, face->ows, file_of(face), &notify.ways.queue))
		log_err(face->log, "no memory for %d signals: nothing is told",
		        ows_count(face->ows));
}

static void look_at(struct face *face, int signal, int64_t now_ns)
{
	struct row *row = &notify.rows.row[signal];
	struct face_value value;
	struct entry entry = {0};
	struct ows_info info;
	bool bad;

	if (!row->chosen)
		return;
	face_value(face->ows, signal, face->live, now_ns, &value);
	/* a fresh owsd has not read it yet: it may be as bad as it was */
	if (!value.known || value.v.quality == OWS_Q_INITIAL)
		return;
	bad = !(value.v.quality & 0xc0);
	if (bad && !row->bad_ns)
		row->bad_ns = now_ns;
	if (bad)
		return;
	if (row->told)
		queue_ended(&notify.ways.queue, signal, ENTRY_BAD, "good again", now_ns);
	if (row->told && file_of(face)->returns && !ows_info(face->ows, signal, &info)) {
		message_line(&entry, "%s no longer bad%s%s", info.name,
		             *info.description ? "; " : "", info.description);
		put(face, signal, &entry);
	}
	row->bad_ns = 0;
	row->told = false;
}

/* --- The table of the face ------------------------------------------------------------------- */

static int notify_check(const struct face *face)
{
	const struct config_notify *file = file_of(face);
	const char *const programs[] = {file->mail || file->escalate_mail ? file->sendmail : NULL,
	                                file->command};
	int err = secret_check(face->ops->program, "TokenFile", file->token_file, SECRET_TOKEN);

	for (int i = 0; !err && i < 2; i++)
		if (programs[i] && (err = run_check(programs[i])))
			face_complain(face->ops->program, "%s %s: %s; install it, or name another",
			              i ? "Command" : "Sendmail", programs[i], run_why(err));
	if (err || !face->arguments->option)
		return err;
	if (file->given)
		return ways_test(&notify.ways, file, face->ops->program, face->arguments->instance);
	face_complain(face->ops->program, "%s has no Notify block", face->arguments->file);
	return -ENOENT;
}

static int notify_start(struct face *face)
{
	int64_t now_ns = ows_now();

	ways_open(&notify.ways, face->log, face->arguments->instance, face_watch_anew, face);
	notify.ways.judge = judge;
	notify.ways.judge_ctx = face;
	if (!notify.ways.post) {
		face_complain(face->ops->program, "libcurl cannot be used: no memory");
		return -ENOMEM;
	}
	notify.seen_ns = notify.looked_ns = now_ns;
	if (kept_open(&notify.kept, face->log, face->ops->program, face->arguments->instance,
	              now_ns, &notify.seen_ns, &notify.looked_ns)) {
		face_complain(face->ops->program,
		              "%s is kept by another owsd-notify of %s, which tells the same "
		              "alarms: end it, or this one",
		              notify.kept.path, face->arguments->instance);
		ways_close(&notify.ways);
		return -EBUSY;
	}
	notify.known_ns = notify.seen_ns;
	notify.found_ns = notify.looked_ns;
	/* those that were told may be the ones that nobody acknowledges */
	face->alarms_after_ns = notify.seen_ns < notify.looked_ns ? notify.seen_ns
	                                                          : notify.looked_ns;
	face->after_ns = AFTER_NS;
	face->tick_ns = notify.lost_ns = now_ns;
	if (!file_of(face)->given)
		log_notice(face->log, "%s has no Notify block: nobody is told",
		           face->arguments->file);
	return 0;
}

static void notify_changes(struct face *face, const int *signals, int n)
{
	int64_t now_ns = ows_now();

	/* there are no rows if there was no memory for them */
	for (int i = 0; i < (signals ? n : notify.rows.count); i++)
		if (!signals || signals[i] < notify.rows.count)
			look_at(face, signals ? signals[i] : i, now_ns);
}

/* fd is ready; -1: none, but something may be due. */
static void go_on(struct face *face, int fd, short ready)
{
	int64_t now_ns = ows_now();

	/* in the middle of a reload nobody knows what still is */
	notify.ways.held = face->live && !look_is_current(face);
	ways_step(&notify.ways, file_of(face), fd, ready, now_ns);
	face->tick_ns = ways_next(&notify.ways, now_ns);
	keep(face, notify.found_ns, now_ns);
}

static const char *trouble_of(void)
{
	for (int i = 0; i < WAYS; i++)
		if (*notify.ways.way[i].why)
			return notify.ways.way[i].why;
	return NULL;
}

static void notify_tick(struct face *face, int64_t now_ns)
{
	look_for_escalation(face);
	look_for_bad(face, now_ns);
	go_on(face, -1, 0);
	face_status(face, "%s",
	            !file_of(face)->given ? "no Notify block: off"
	            : trouble_of()        ? trouble_of()
	            : face->live          ? "telling of alarms"
	                                  : "waiting for owsd");
}

static void notify_event(struct face *face, const struct face_event *event)
{
	switch (event->news) {
	case FACE_FOUND:
	case FACE_RELOADED:
		if (notify.lost_told)
			queue_ended(&notify.ways.queue, -1, ENTRY_NO_OWSD, "it runs again",
			            ows_now());
		if (notify.lost_told && file_of(face)->returns)
			tell_owsd(face, 0, "runs again");
		notify.lost_ns = 0;
		notify.lost_told = false;
		make_rows(face);
		ways_again(&notify.ways);
		break;
	case FACE_FILE:
		if (face->live && look_is_current(face))
			make_rows(face);
		ways_again(&notify.ways);
		break;
	case FACE_LOST:
		notify.lost_ns = ows_now();
		log_warning(face->log, "owsd is lost");
		break;
	case FACE_ENTRIES_LOST: {
		struct entry entry = {.critical = true, .severe = true};

		message_line(&entry, "%u entries of owsd's journals came too fast to be read",
		             event->count);
		put(face, -1, &entry);
		break;
	}
	case FACE_ALARM:
		take_alarm(face, event->alarm);
		break;
	case FACE_OVERRUN:
	case FACE_COMMAND:
		break;
	case FACE_DESCRIPTOR:
		go_on(face, event->fd, event->ready);
		break;
	}
}

static void notify_report(struct face *face, FILE *out)
{
	uint64_t told = 0, failed = 0, lost = 0, waiting = 0;

	for (int i = 0; i < WAYS; i++) {
		const struct way *way = &notify.ways.way[i];

		told += way->told;
		failed += way->failed;
		lost += way->lost;
		if (ways_has(file_of(face), (enum way_kind)i))
			waiting += notify.ways.queue.end - way->next;
	}
	if (trouble_of())
		fprintf(out, "trouble %s\ntroubled %" PRId64 "\n", trouble_of(), ows_now());
	fprintf(out, "count alarms %" PRIu64 "\ncount messages %" PRIu64 "\n",
	        notify.ways.queue.end, told);
	fprintf(out,
	        "count failed %" PRIu64 "\ncount waiting %" PRIu64 "\ncount lost %" PRIu64 "\n",
	        failed, waiting, lost);
}

static void notify_end(struct face *face)
{
	notify.kept.at_ns = 0;
	keep(face, notify.looked_ns, ows_now());
	kept_close(&notify.kept);
	ways_close(&notify.ways);
	free(notify.rows.row);
}

int main(int argc, char **argv)
{
	static const struct face_ops ops = {
		.program = "owsd-notify",
		.option = {'t', "test", NULL, "send a test message each way, and end"},
		.check = notify_check,
		.open = notify_start,
		.changes = notify_changes,
		.event = notify_event,
		.tick = notify_tick,
		.report = notify_report,
		.close = notify_end,
	};

	return face_main(&ops, argc, argv);
}
