/* SPDX-License-Identifier: MIT */
/* Stretches of time that a peer has missed, kept in a file, and read from the history. */
#include "src/faces/kit/missed.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "src/faces/kit/face.h"
#include "src/faces/show/when.h"
#include "src/public/ows_history.h"

#define NS_PER_US 1000
#define US_PER_S INT64_C(1000000)
/* The recorder writes after ten minutes, or what Flush says */
#define BATCHES_NS (10 * NS_PER_S) /* between two writes of a position that nothing was sent for */
#define WAIT_NS (2 * NS_PER_S)
#define WAIT_MOST_NS (30 * NS_PER_S)
#define LATE_NS (660 * NS_PER_S)
/* So seldom a history is looked for that is not there */
#define LOOK_MOST_NS (600 * NS_PER_S)
/* A value that was measured before a moment may reach us after it */
#define SLACK_US (2 * US_PER_S)
/* Of an outage that lasted longer only the end is sent again */
#define MOST_US (30 * 86400 * US_PER_S)
#define WORTH_US (10 * US_PER_S)

struct replay_point missed_point(const struct missed *m, int64_t ns)
{
	struct when now = when_now();

	return (struct replay_point){m->boot, ns / NS_PER_US,
	                             (ns + now.wall - now.boot) / NS_PER_US};
}

/* --- What is kept ---------------------------------------------------------------------------- */

#define KEPT_VERSION 4

static void complain(struct missed *m, const char *what, int err)
{
	if (!m->logged)
		log_warning(m->face->log,
		            "%s: %s; after a restart of %s too little is sent again, or something "
		            "twice",
		            what, strerror(err), m->face->ops->program);
	m->logged = true;
}

static void find_path(struct missed *m)
{
	char place[HISTORY_PATH] = "";
	int err = history_place_state(m->face->ops->program, m->what, m->face->arguments->instance,
	                              place);

	if (err)
		complain(m, m->what, -err);
	snprintf(m->path, sizeof(m->path), "%s%s", err ? "" : place, err ? "" : "/reached");
}

static void print_point(FILE *f, const struct replay_point *point)
{
	fprintf(f, " %" PRId64 " %" PRId64 " %" PRId64, point->boot, point->us, point->wall_us);
}

static bool scan_point(FILE *f, struct replay_point *point)
{
	/* NOLINTNEXTLINE(cert-err34-c): a number out of range is no point of ours either */
	return fscanf(f, "%" SCNd64 " %" SCNd64 " %" SCNd64, &point->boot, &point->us,
	              &point->wall_us) == 3;
}

void missed_keep(struct missed *m, int64_t least_ns, int64_t now_ns)
{
	char part[sizeof(m->path) + 8];
	FILE *f;
	int bad;

	if (least_ns && now_ns - m->kept_ns < least_ns)
		return;
	m->kept_ns = now_ns;
	if (!m->there || !*m->path || m->unread)
		return;
	snprintf(part, sizeof(part), "%s.part", m->path);
	bad = history_make_above(part);
	f = bad ? NULL : fopen(part, "we");
	if (!f) {
		complain(m, part, bad ? -bad : errno);
		return;
	}
	fprintf(f, "owsd %d %016" PRIx64 " %d", KEPT_VERSION, m->key, m->count);
	print_point(f, &m->reached);
	print_point(f, &m->resumed);
	for (int i = 0; i < m->count; i++) {
		print_point(f, &m->stretches[i].from);
		print_point(f, &m->stretches[i].until);
	}
	fputs(" end\n", f);
	bad = fflush(f) || fsync(fileno(f)) < 0;
	if (fclose(f) || bad || rename(part, m->path) < 0)
		complain(m, m->path, errno);
}

static void number_path(const struct missed *m, char path[sizeof(m->path) + 8])
{
	snprintf(path, sizeof(m->path) + 8, "%.*s/number", (int)(strrchr(m->path, '/') - m->path),
	         m->path);
}

int missed_number(const struct missed *m)
{
	char path[sizeof(m->path) + 8];
	int number = -1;
	FILE *f;

	if (!*m->path)
		return -1;
	number_path(m, path);
	f = fopen(path, "re");
	/* NOLINTNEXTLINE(cert-err34-c): a number out of range is none of ours */
	if (!f || fscanf(f, "%3d", &number) != 1 || number < 0)
		number = -1;
	if (f)
		fclose(f);
	return number;
}

/* One that is damaged in a power cut is none: this one is written over itself. */
void missed_keep_number(struct missed *m, int number)
{
	char path[sizeof(m->path) + 8];
	FILE *f;
	int bad;

	if (!*m->path)
		return;
	number_path(m, path);
	bad = history_make_above(path);
	f = bad ? NULL : fopen(path, "we");
	if (!f) {
		complain(m, path, bad ? -bad : errno);
		return;
	}
	fprintf(f, "%d\n", number);
	if (fclose(f))
		complain(m, path, errno);
}

/* False: there is none, of another peer, damaged, or unread: then it stays for the next start. */
static bool read_kept(struct missed *m)
{
	FILE *f = fopen(m->path, "re");
	struct missed old = *m;
	const char *fault = "damaged";
	char end[4] = "";
	int version, found;
	uint64_t key;
	bool good;

	m->unread = !f && errno != ENOENT;
	if (m->unread)
		complain(m, m->path, errno);
	if (!f)
		return false;
	/* NOLINTNEXTLINE(cert-err34-c): a number out of range is neither the key nor a count */
	found = fscanf(f, "owsd %d %" SCNx64 " %d", &version, &key, &old.count);
	if (found >= 1 && version != KEPT_VERSION)
		fault = "of another version of owsd";
	else if (found == 3 && key != m->key)
		fault = "of another peer";
	good = found == 3 && version == KEPT_VERSION && key == m->key && old.count >= 0 &&
	       old.count <= MISSED_STRETCHES && scan_point(f, &old.reached) &&
	       scan_point(f, &old.resumed);
	for (int i = 0; good && i < old.count; i++)
		good = scan_point(f, &old.stretches[i].from) &&
		       scan_point(f, &old.stretches[i].until);
	good = good && fscanf(f, " %3s", end) == 1 && !strcmp(end, "end");
	m->unread = ferror(f);
	if (m->unread)
		complain(m, m->path, EIO);
	fclose(f);
	if (good)
		*m = old;
	else if (!m->unread)
		log_notice(m->face->log, "%s is %s: what was missed before is not sent", m->path,
		           fault);
	return good;
}

/* --- The history ----------------------------------------------------------------------------- */

static void close_history(struct missed *m)
{
	ows_history_close(m->history);
	m->history = NULL;
	free(m->rows);
	m->rows = NULL;
}

bool missed_open(struct missed *m)
{
	int err = 0;

	if (!m->history)
		err = ows_history_open(m->face->arguments->instance,
		                       m->face->config->recorder.directory, &m->history);
	m->there = !err;
	if (err && !m->logged)
		log_notice(m->face->log,
		           "cannot read the history of owsd-recorder: %s%s; what %s misses is not "
		           "sent again",
		           strerror(-err),
		           err == -EACCES ? "; put the user into the group owsd" : "", m->peer);
	m->logged = m->logged || err;
	return !err;
}

static void wait_more(struct missed *m, int64_t now_ns, int64_t most_ns)
{
	m->next_ns = now_ns + m->wait_ns;
	m->wait_ns = 2 * m->wait_ns < most_ns ? 2 * m->wait_ns : most_ns;
}

/* One that appears is found when there is something else to do. */
bool missed_look(struct missed *m, int64_t now_ns)
{
	if (m->there)
		return true;
	if (now_ns < m->next_ns)
		return false;
	wait_more(m, now_ns, LOOK_MOST_NS);
	if (!missed_open(m))
		return false;
	log_notice(m->face->log,
	           "there is a history of owsd-recorder now: what %s misses is sent again",
	           m->peer);
	m->logged = false;
	m->wait_ns = WAIT_NS;
	return true;
}

/* What was recorded before there were identities has names alone. */
static bool is_same(const struct ows_info *info, const struct ows_history_signal *known)
{
	return *known->identity ? !strcmp(info->identity, known->identity)
	                        : !strcmp(info->name, known->name);
}

/*
 * The row of the face; mostly both have the same order. What was written when the signal had
 * another type is none of it.
 */
static int row_of(struct missed *m, const struct replay_row *r, int count)
{
	struct ows_history_signal known;
	int *row = &m->rows[r->signal];

	if (ows_history_signal(m->history, r->signal, &known) || r->v.type != known.type)
		return MISSED_NONE;
	if (*row != -1)
		return *row;
	*row = MISSED_NONE;
	for (int k = 0; k < count && *row < 0; k++) {
		int i = (r->signal + k) % count;
		struct ows_info info;

		if (m->info(m->ctx, i, &info) && info.type == known.type && is_same(&info, &known))
			*row = i;
	}
	return *row;
}

static void say_once(struct missed *m, bool *said, const char *words)
{
	if (m->worth && !*said)
		log_notice(m->face->log, "what %s has missed is sent again%s", m->peer, words);
	*said = *said || m->worth;
}

static void end_stretch(struct missed *m, int64_t now_ns)
{
	memmove(m->stretches, m->stretches + 1, sizeof(m->stretches[0]) * (size_t)--m->count);
	m->wait_ns = WAIT_NS;
	m->next_ns = now_ns;
	if (!m->count) {
		if (m->said)
			log_notice(m->face->log, "%" PRIu64 " values that %s had missed are sent",
			           m->given, m->peer);
		if (m->undated)
			log_notice(m->face->log,
			           "%" PRIu64 " values are of a time when the clock was never set: "
			           "they are not sent",
			           m->undated);
		m->worth = m->said = m->waits = false;
		m->given = m->undated = 0;
		close_history(m);
	}
	missed_keep(m, 0, now_ns);
}

static bool history_ready(struct missed *m)
{
	int signals;

	if (m->history && m->rows)
		return true;
	if (!(m->history ? ows_history_refresh(m->history) == 0 : missed_open(m))) {
		m->there = true; /* it was, and may be again */
		return false;
	}
	signals = ows_history_signals(m->history);
	m->rows = calloc((size_t)signals + 1, sizeof(*m->rows));
	for (int i = 0; m->rows && i < signals; i++)
		m->rows[i] = -1;
	return m->rows;
}

/* How many; 0: the stretch is over; or a negative errno. */
static int next_rows(struct missed *m, struct replay_row *rows, int most, int64_t now_ns)
{
	const struct missed_stretch *first = &m->stretches[0];
	int64_t from, until, end;
	int n = 0;

	if (!history_ready(m))
		return -ENOENT;
	from = replay_place(m->history, &first->from);
	until = replay_place(m->history, &first->until);
	if (from < 0 || until < 0)
		return -EAGAIN; /* it has written nothing yet */
	if (until - from > MOST_US)
		from = until - MOST_US;
	end = replay_end(m->history) < until ? replay_end(m->history) : until;
	if (from < end)
		n = replay_rows(m->history, from, end, rows, most);
	if (n)
		return n;
	if (end < until)
		return -EAGAIN;
	end_stretch(m, now_ns);
	return 0;
}

/* The rows behind a gap of all, or the gap itself, come with the next batch. */
static int up_to_gap(struct replay_row *rows, int n)
{
	int kept = n > 0;

	while (kept && rows[0].signal >= 0 && kept < n && rows[kept].signal >= 0)
		kept++;
	for (int i = kept; i < n; i++)
		free(rows[i].text);
	return kept;
}

int missed_read(struct missed *m, int count, struct replay_row *rows, int most, int64_t now_ns)
{
	int64_t offset_us = missed_point(m, 0).wall_us;
	int n;

	if (!m->count || now_ns < m->next_ns)
		return 0;
	n = next_rows(m, rows, most, now_ns);
	if (n < 0) {
		wait_more(m, now_ns, WAIT_MOST_NS);
		free(m->rows); /* refresh it before the next look */
		m->rows = NULL;
		if (now_ns - m->moved_ns > LATE_NS)
			say_once(m, &m->waits,
			         " when owsd-recorder has written it: does that run?");
		return 0;
	}
	n = up_to_gap(rows, n);
	for (int i = 0; i < n; i++) {
		/* a boot whose clock was never set has no times */
		bool undated = rows[i].at.boot != m->boot && !rows[i].dated && m->dated;

		if (undated)
			rows[i].signal = MISSED_NONE;
		else if (rows[i].signal >= 0)
			rows[i].signal = row_of(m, &rows[i], count);
		m->undated += undated;
		/* the recorder may not know yet that the clock was set, as we do */
		if (rows[i].at.boot == m->boot)
			rows[i].wall_us = rows[i].at.us + offset_us;
	}
	return n;
}

void missed_given(struct missed *m, const struct replay_point *last, int sent, int64_t now_ns)
{
	m->stretches[0].from = *last;
	m->stretches[0].from.us++;
	m->given += (uint64_t)sent;
	m->sent += (uint64_t)sent;
	m->moved_ns = m->next_ns = now_ns;
	m->wait_ns = WAIT_NS;
	if (sent)
		say_once(m, &m->said, ", from the history");
	missed_keep(m, sent ? 0 : BATCHES_NS, now_ns);
}

/* --- Sessions -------------------------------------------------------------------------------- */

void missed_begin(struct missed *m, uint64_t key, int64_t now_ns)
{
	bool kept;

	m->key = key;
	m->boot = history_boot_present();
	m->reached = missed_point(m, now_ns);
	m->resumed = (struct replay_point){0};
	m->count = 0;
	m->logged = m->worth = m->said = m->waits = m->unread = false;
	m->wait_ns = WAIT_NS;
	m->next_ns = 0;
	find_path(m);
	kept = read_kept(m);
	if (missed_open(m) && !kept)
		missed_keep(m, 0, now_ns);
	close_history(m);
}

void missed_drop(struct missed *m)
{
	close_history(m); /* the file may name another */
}

void missed_has(struct missed *m, const struct replay_point *point)
{
	m->reached = *point;
}

void missed_resume(struct missed *m, const struct replay_point *point, int64_t now_ns)
{
	struct missed_stretch *last;

	/* without room what was between two outages is given again */
	if (m->count < MISSED_STRETCHES) {
		last = &m->stretches[m->count++];
		last->from = m->reached;
		last->from.us -= SLACK_US;
		last->from.wall_us -= SLACK_US;
		if (last->from.boot == m->resumed.boot && last->from.us < m->resumed.us)
			last->from = m->resumed;
	}
	last = &m->stretches[m->count - 1];
	last->until = m->resumed = m->reached = *point;
	if (last->from.boot != m->boot || last->until.us - last->from.us > WORTH_US)
		m->worth = true;
	m->moved_ns = m->next_ns = now_ns;
	m->wait_ns = WAIT_NS;
	m->kept_ns = 0;
}
