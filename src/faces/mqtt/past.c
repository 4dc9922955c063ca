/* SPDX-License-Identifier: MIT */
/* Stretches of time that a broker has missed, and the batches of rows that fill them. */
#include "src/faces/mqtt/past.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "hal/base/time.h"
#include "src/faces/show/when.h"
#include "src/ground/signal/hash.h"
#include "src/ground/signal/value.h"
#include "src/public/ows_history.h"

#define NS_PER_US 1000
#define US_PER_S INT64_C(1000000)
#define US_PER_MS 1000
/* After an outage of a broker a thousand nodes send again at once: 500 rows of each in a second */
#define BATCH 256
#define PACE_NS (500 * NS_PER_MS)
#define MESSAGE_MOST 100 /* metrics */
#define MARK_NS NS_PER_S
#define KEEP_NS (60 * NS_PER_S)
#define BATCHES_NS (10 * NS_PER_S) /* ... while batches go out */
/* The recorder writes once in a minute, and at least each ten minutes */
#define WAIT_NS (2 * NS_PER_S)
#define WAIT_MOST_NS (30 * NS_PER_S)
#define LATE_NS (660 * NS_PER_S)
/* So seldom a history is looked for that is not there */
#define LOOK_MOST_NS (600 * NS_PER_S)
/* A value that was measured before a moment may reach us after it */
#define SLACK_US (2 * US_PER_S)
/* In the history rows of the same time are microseconds apart */
#define SAME_NS NS_PER_MS
/* Of an outage that lasted longer only the end is sent again */
#define MOST_US (30 * 86400 * US_PER_S)
#define WORTH_US (10 * US_PER_S)

static struct replay_point point_of(const struct past *p, int64_t ns)
{
	struct when now = when_now();

	return (struct replay_point){p->boot, ns / NS_PER_US,
	                             (ns + now.wall - now.boot) / NS_PER_US};
}

/* --- What is kept ---------------------------------------------------------------------------- */

static void complain(struct past *p, const char *what, int err)
{
	if (!p->logged)
		log_warning(p->face->log,
		            "%s: %s; after a restart of owsd-mqtt too little is sent "
		            "again, or something twice",
		            what, strerror(err));
	p->logged = true;
}

static void find_path(struct past *p)
{
	char place[HISTORY_PATH] = "";
	int err = history_place_state(p->face->ops->program, "mqtt", p->face->arguments->instance,
	                              place);

	if (err)
		complain(p, place, -err);
	snprintf(p->path, sizeof(p->path), "%s%s", err ? "" : place, err ? "" : "/reached");
}

static void print_point(FILE *f, const struct replay_point *point)
{
	fprintf(f, "%" PRId64 " %" PRId64 " %" PRId64 "\n", point->boot, point->us, point->wall_us);
}

static bool scan_point(FILE *f, struct replay_point *point)
{
	/* NOLINTNEXTLINE(cert-err34-c): a number out of range is no point of ours either */
	return fscanf(f, "%" SCNd64 " %" SCNd64 " %" SCNd64, &point->boot, &point->us,
	              &point->wall_us) == 3;
}

static void keep(struct past *p, int64_t now_ns)
{
	char part[sizeof(p->path) + 8];
	FILE *f;
	int bad;

	p->kept_ns = now_ns;
	if (!p->there || !*p->path)
		return;
	snprintf(part, sizeof(part), "%s.part", p->path);
	bad = history_make_above(part);
	f = bad ? NULL : fopen(part, "we");
	if (!f) {
		complain(p, part, bad ? -bad : errno);
		return;
	}
	fprintf(f, "owsd-mqtt 2 %016" PRIx64 " %d\n", p->key, p->count);
	print_point(f, &p->reached);
	for (int i = 0; i < p->count; i++) {
		print_point(f, &p->windows[i].from);
		print_point(f, &p->windows[i].until);
	}
	fputs("end\n", f);
	bad = fflush(f) || fsync(fileno(f)) < 0;
	if (fclose(f) || bad || rename(part, p->path) < 0)
		complain(p, p->path, errno);
}

/* False: there is none, of another broker, or damaged. */
static bool read_kept(struct past *p)
{
	FILE *f = fopen(p->path, "re");
	struct past old = *p;
	char end[4] = "";
	uint64_t key;
	bool good;

	if (!f)
		return false;
	/* NOLINTNEXTLINE(cert-err34-c): a number out of range is neither the key nor a count */
	good = fscanf(f, "owsd-mqtt 2 %" SCNx64 " %d", &key, &old.count) == 2 && key == p->key &&
	       old.count >= 0 && old.count <= PAST_WINDOWS && scan_point(f, &old.reached);
	for (int i = 0; good && i < old.count; i++)
		good = scan_point(f, &old.windows[i].from) && scan_point(f, &old.windows[i].until);
	good = good && fscanf(f, " %3s", end) == 1 && !strcmp(end, "end");
	fclose(f);
	if (good)
		*p = old;
	else
		log_notice(p->face->log,
		           "%s is of another broker or damaged: what was missed before is not sent",
		           p->path);
	return good;
}

/* --- The history ----------------------------------------------------------------------------- */

static void close_history(struct past *p)
{
	ows_history_close(p->history);
	p->history = NULL;
}

static bool open_history(struct past *p)
{
	int err = 0;

	if (!p->history)
		err = ows_history_open(p->face->arguments->instance,
		                       p->face->config->recorder.directory, &p->history);
	p->there = !err;
	if (err && !p->logged)
		log_notice(p->face->log,
		           "what the broker misses is not sent again: the history of owsd-recorder "
		           "cannot be read: %s%s",
		           strerror(-err),
		           err == -EACCES ? "; put the user into the group owsd" : "");
	p->logged = p->logged || err;
	return !err;
}

static int by_identity(const void *a, const void *b)
{
	const struct row *x = *(const struct row *const *)a, *y = *(const struct row *const *)b;

	return strcmp(x->info.identity, y->info.identity);
}

/* False: no memory. */
static bool map_rows(struct past *p)
{
	int signals = ows_history_signals(p->history), count = p->stream->count;

	free(p->by_identity);
	free(p->rows);
	p->by_identity = calloc((size_t)count + 1, sizeof(struct row *));
	p->rows = calloc((size_t)signals + 1, sizeof(*p->rows));
	if (!p->by_identity || !p->rows)
		return false;
	for (int i = 0; i < count; i++)
		p->by_identity[i] = &p->stream->rows[i];
	qsort(p->by_identity, (size_t)count, sizeof(struct row *), by_identity);
	for (int i = 0; i < signals; i++)
		p->rows[i] = -2;
	return true;
}

/* NULL: the configuration has it no more, or with another type. */
static struct row *row_of(struct past *p, const struct replay_row *r)
{
	int *index = &p->rows[r->signal];
	struct row *row;

	if (*index == -2) {
		struct ows_history_signal signal;
		struct row key = {0};
		const struct row *wanted = &key, **found = NULL;

		if (!ows_history_signal(p->history, r->signal, &signal)) {
			key.info.identity = signal.identity;
			found = bsearch(&wanted, p->by_identity, (size_t)p->stream->count,
			                sizeof(struct row *), by_identity);
		}
		*index = found ? (int)(*found - p->stream->rows) : -1;
	}
	if (*index < 0)
		return NULL;
	row = &p->stream->rows[*index];
	return row->info.type == r->v.type ? row : NULL;
}

/* --- A batch --------------------------------------------------------------------------------- */

/* For now no more follows of chips that are away. */
static void let_die(struct past *p)
{
	struct stream *s = p->stream;

	for (int i = 0; i < s->chip_count; i++) {
		int first = (int)(s->by_chip[s->chips[i].first] - s->rows);

		if (s->chips[i].lent)
			stream_changes(s, &first, 1);
		s->chips[i].lent = false;
	}
}

/* Nothing has gone out yet of what is sent next. */
static void begin_anew(struct past *p)
{
	for (int i = 0; i < p->stream->count; i++)
		p->stream->rows[i].past_print = 0;
	for (int i = 0; i < p->stream->chip_count; i++)
		p->stream->chips[i].filled = false;
}

static void drop_batch(struct past *p)
{
	for (int i = 0; i < p->value_count; i++)
		free(p->values[i].text);
	free(p->values);
	free(p->by_identity);
	free(p->rows);
	p->values = NULL;
	p->by_identity = NULL;
	p->rows = NULL;
	p->value_count = p->put = 0;
	p->read = false;
}

void past_drop(struct past *p)
{
	drop_batch(p);
	if (p->marking)
		p->mark_published = UINT64_MAX; /* its answer is not waited for */
	p->marking = false;
	begin_anew(p);
	close_history(p); /* the file may name another */
}

static void wait_more(struct past *p, int64_t now_ns, int64_t most_ns)
{
	p->next_ns = now_ns + p->wait_ns;
	p->wait_ns = 2 * p->wait_ns < most_ns ? 2 * p->wait_ns : most_ns;
}

static void say_once(struct past *p, bool *said, const char *words)
{
	if (p->worth && !*said)
		log_notice(p->face->log, "what the broker has missed is sent again%s", words);
	*said = *said || p->worth;
}

static void end_window(struct past *p, int64_t now_ns)
{
	memmove(p->windows, p->windows + 1, sizeof(p->windows[0]) * (size_t)--p->count);
	p->next_ns = now_ns;
	p->wait_ns = WAIT_NS;
	begin_anew(p);
	if (!p->count) {
		if (p->said)
			log_notice(p->face->log,
			           "%" PRIu64 " values that the broker had missed are sent",
			           p->filled);
		if (p->undated)
			log_notice(p->face->log,
			           "%" PRIu64 " values are of a time when the clock was never set: "
			           "they are not sent",
			           p->undated);
		p->worth = p->said = p->waits = false;
		p->filled = p->undated = 0;
		let_die(p);
		close_history(p);
	}
	keep(p, now_ns);
}

/*
 * Of the newest outage the rows know more than its begin and end: what the broker had before. The
 * recorder may have looked later than we did, so its time of the same value may be later.
 */
static bool had_before(const struct past *p, const struct row *row, const struct replay_row *r)
{
	int64_t ns = r->at.us * NS_PER_US;

	if (p->count > 1 || r->at.boot != p->boot)
		return false;
	return (row->born_ns && ns > row->born_ns - NS_PER_US) ||
	       (row->past_ns && ns <= row->past_ns + SAME_NS);
}

/* A value that holds comes again each hour. */
static bool is_same(const struct past *p, struct row *row, const struct replay_row *r)
{
	uint64_t print = face_value_print(&r->v, r->text),
		 before = row->past_print || p->count > 1 ? row->past_print : row->past_told;

	row->past_print = print;
	row->past_told = 0;
	return print == before;
}

static void add_value(struct past *p, struct row *row, struct replay_row *r)
{
	struct past_value *value = &p->values[p->value_count++];
	struct when now = when_now();

	/* the recorder may not know yet that the clock was set, as we do */
	if (r->at.boot == p->boot)
		r->wall_us = r->at.us + (now.wall - now.boot) / NS_PER_US;
	*value = (struct past_value){.row = row, .wall_us = r->wall_us, .v = r->v, .text = r->text};
	/* who keeps values by their milliseconds keeps both */
	if (value->wall_us >= row->past_us && value->wall_us < row->past_us + US_PER_MS)
		value->wall_us = row->past_us + US_PER_MS;
	row->past_us = value->wall_us;
	value->place = p->value_count;
	r->text = NULL;
}

/* From then on nothing is known: no number, of no row that is there. */
static void add_gap(struct past *p, struct replay_row *r)
{
	r->v = (struct ows_value){.quality = OWS_Q_STALE};
	for (int i = 0; i < p->stream->count; i++) {
		struct row *row = &p->stream->rows[i];

		row->past_print = 0;
		if (row->chip < 0 || p->stream->chips[row->chip].announced)
			add_value(p, row, r);
	}
}

static int by_chip(const void *a, const void *b)
{
	const struct past_value *x = a, *y = b;

	return x->row->chip != y->row->chip ? x->row->chip - y->row->chip : x->place - y->place;
}

/* The type of a signal may have changed since the row was written; a row may be damaged. */
static bool is_sound(const struct replay_row *r)
{
	if (!ows_good(r->v.quality))
		return true;
	if (r->v.type == OWS_STRING)
		return r->text;
	return value_is_float((enum ows_type)r->v.type) ||
	       (!isnan(r->v.number) && value_holds((enum ows_type)r->v.type, r->v.integer));
}

static void take_rows(struct past *p, struct replay_row *rows, int n)
{
	/* a gap of all is a batch of its own */
	for (int i = 0; i < n && (!i || (rows[0].signal >= 0 && rows[i].signal >= 0)); i++) {
		struct row *row = rows[i].signal < 0 ? NULL : row_of(p, &rows[i]);

		p->next = rows[i].at;
		p->next.us++;
		/* a boot whose clock was never set has no times */
		if (rows[i].at.boot != p->boot && !rows[i].dated && p->dated)
			p->undated++;
		else if (rows[i].signal < 0)
			add_gap(p, &rows[i]);
		else if (row && is_sound(&rows[i]) && !had_before(p, row, &rows[i]) &&
		         !is_same(p, row, &rows[i]))
			add_value(p, row, &rows[i]);
	}
	for (int i = 0; i < n; i++)
		free(rows[i].text);
	qsort(p->values, (size_t)p->value_count, sizeof(*p->values), by_chip);
	p->read = true;
}

/* The next rows of the first window; at its end it is taken away. 0 or a negative errno. */
static int read_batch(struct past *p, int64_t now_ns)
{
	struct replay_row rows[BATCH];
	struct past_window *w = &p->windows[0];
	int most = p->stream->count > BATCH ? p->stream->count : BATCH, n = 0;
	int64_t from, until, end;

	if ((!p->history || !p->by_identity) &&
	    (!(p->history ? ows_history_refresh(p->history) == 0 : open_history(p)) ||
	     !map_rows(p))) {
		p->there = true; /* it was, and may be again */
		return -ENOENT;
	}
	from = replay_place(p->history, &w->from);
	until = replay_place(p->history, &w->until);
	if (from < 0 || until < 0)
		return -EAGAIN; /* it has written nothing yet */
	if (until - from > MOST_US)
		from = until - MOST_US;
	end = replay_end(p->history) < until ? replay_end(p->history) : until;
	if (from < end)
		n = replay_rows(p->history, from, end, rows, BATCH);
	if (n < 0)
		return n;
	if (!n) {
		if (end < until)
			return -EAGAIN;
		end_window(p, now_ns);
		return 0;
	}
	p->values = calloc((size_t)most, sizeof(*p->values));
	if (p->values)
		take_rows(p, rows, n);
	return p->values ? 0 : -ENOMEM;
}

static bool put_batch(struct past *p)
{
	while (p->put < p->value_count) {
		const struct past_value *first = &p->values[p->put];
		int n = 1;

		while (p->put + n < p->value_count && n < MESSAGE_MOST &&
		       first[n].row->chip == first->row->chip)
			n++;
		if (!p->stream->profile->past(p->stream, first, n))
			return false;
		p->put += n;
	}
	return true;
}

/* The broker has it. */
static void end_batch(struct past *p, int64_t now_ns)
{
	p->windows[0].from = p->next;
	p->sent += (uint64_t)p->value_count;
	p->filled += (uint64_t)p->value_count;
	p->next_ns = now_ns + (p->value_count ? PACE_NS : 0);
	p->moved_ns = now_ns;
	for (int i = 0; i < p->value_count; i++)
		free(p->values[i].text);
	free(p->values);
	p->values = NULL;
	if (now_ns - p->kept_ns >= BATCHES_NS)
		keep(p, now_ns);
	p->value_count = p->put = 0;
	p->read = false;
	p->wait_ns = WAIT_NS;
}

/* --- Sessions -------------------------------------------------------------------------------- */

void past_begin(struct past *p, uint64_t key)
{
	int64_t now_ns = ows_now();
	bool kept;

	p->on = p->stream->profile->past;
	p->key = key;
	p->boot = history_boot_present();
	p->reached = point_of(p, now_ns);
	p->count = 0;
	p->lost = true;
	p->logged = p->worth = p->said = p->waits = false;
	p->wait_ns = WAIT_NS;
	if (!p->on)
		return;
	find_path(p);
	kept = read_kept(p);
	if (open_history(p) && !kept)
		keep(p, now_ns);
	close_history(p);
}

/* The broker has the birth: what it has missed before is known. */
static void begin_session(struct past *p, int64_t now_ns)
{
	struct past_window *w;

	if (p->count < PAST_WINDOWS) {
		w = &p->windows[p->count++];
		w->from = p->reached;
		w->from.us -= SLACK_US;
		w->from.wall_us -= SLACK_US;
		if (w->from.boot == p->boot && w->from.us < p->born.us)
			w->from = p->born;
	}
	w = &p->windows[p->count - 1];
	w->until = p->born = p->mark;
	if (w->from.boot != p->boot || w->until.us - w->from.us > WORTH_US)
		p->worth = true;
	p->lost = false;
	p->moved_ns = now_ns;
	p->next_ns = now_ns + PACE_NS;
	p->wait_ns = WAIT_NS;
	p->kept_ns = 0;
}

static void mark(struct past *p, int64_t now_ns)
{
	bool batch = p->read && p->put == p->value_count;
	bool news = p->lost || p->broker->published != p->mark_published;

	if (p->marking || (!batch && !p->lost && (!news || now_ns - p->marked_ns < MARK_NS)))
		return;
	if (!broker_mark(p->broker))
		return;
	p->marking = true;
	p->mark_batch = batch;
	p->mark = point_of(p, p->lost ? now_ns : p->face->looked_ns);
	p->mark_published = p->broker->published;
	p->marked_ns = now_ns;
}

/* The answer to a mark: the broker has all that was published before it. */
static void marked(struct past *p, int64_t now_ns)
{
	p->marking = false;
	if (p->lost)
		begin_session(p, now_ns);
	p->reached = p->mark;
	for (int i = 0; i < p->stream->count; i++) {
		struct row *row = &p->stream->rows[i];

		if (!row->published || row->published_ns > p->marked_ns)
			continue;
		row->sure_ns = row->moment_ns;
		row->sure_told = row->told;
	}
	if (p->mark_batch)
		end_batch(p, now_ns);
	if (now_ns - p->kept_ns >= KEEP_NS)
		keep(p, now_ns);
}

void past_lost(struct past *p)
{
	/* it may have answered, and gone at once */
	if (p->marking && p->broker->marked)
		marked(p, ows_now());
	if (!p->on || (p->lost && !p->marking))
		return;
	for (int i = 0; !p->lost && i < p->stream->count; i++) {
		struct row *row = &p->stream->rows[i];

		row->past_ns = row->sure_ns;
		row->past_told = row->sure_told;
	}
	past_drop(p);
	if (!p->lost)
		keep(p, ows_now());
	p->lost = true;
}

void past_end(struct past *p)
{
	past_lost(p);
	past_drop(p);
}

/*
 * Without a history there are no marks: what is known of has gone out. One that appears is found
 * when there is something else to do.
 */
static bool has_come(struct past *p, int64_t now_ns)
{
	p->reached = point_of(p, p->face->looked_ns);
	if (now_ns < p->next_ns)
		return false;
	wait_more(p, now_ns, LOOK_MOST_NS);
	if (!open_history(p))
		return false;
	log_notice(p->face->log,
	           "there is a history of owsd-recorder now: what the broker misses is sent again");
	p->logged = false;
	p->wait_ns = WAIT_NS;
	return true;
}

void past_pump(struct past *p, int64_t now_ns)
{
	/* a time that is wrong does not count */
	if (!p->on || !p->stream->live || !p->stream->announced || !p->stream->clock_set)
		return;
	if (p->lost && !p->marking && !open_history(p)) {
		p->mark = point_of(p, now_ns);
		begin_session(p, now_ns);
	}
	if (!p->there && !has_come(p, now_ns))
		return;
	if (p->marking && p->broker->marked)
		marked(p, now_ns);
	if (!p->lost && p->count && !p->read && now_ns >= p->next_ns) {
		int err = read_batch(p, now_ns);

		if (err) {
			wait_more(p, now_ns, WAIT_MOST_NS);
			drop_batch(p);
			let_die(p);
			if (now_ns - p->moved_ns > LATE_NS)
				say_once(p, &p->waits,
				         " when owsd-recorder has written it: does that run?");
		} else if (p->read && !p->value_count) {
			end_batch(p, now_ns);
		} else if (p->read) {
			say_once(p, &p->said, ", from the history");
		}
	}
	if (!p->lost && !p->marking && p->broker->published == p->mark_published)
		p->reached = point_of(p, p->face->looked_ns);
	if (!p->read || put_batch(p))
		mark(p, now_ns);
	p->due = !p->lost && p->count && !p->read;
}

int64_t past_next(const struct past *p)
{
	return p->due ? p->next_ns : INT64_MAX;
}
