/* SPDX-License-Identifier: MIT */
/* The batches of rows that fill what a broker has missed. */
#include "src/faces/mqtt/past.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/time.h"
#include "src/ground/signal/value.h"

#define NS_PER_US 1000
#define US_PER_MS 1000
#define US_PER_S INT64_C(1000000)
/* After an outage of a broker a thousand nodes send again at once: 500 rows of each in a second */
#define BATCH 256
#define PACE_NS (500 * NS_PER_MS)
#define MESSAGE_MOST 100 /* metrics */
#define MARK_NS NS_PER_S
/* In the history rows of the same time are microseconds apart */
#define SAME_NS NS_PER_MS

/* missed.info */
static bool info_of(void *ctx, int row, struct ows_info *info)
{
	*info = ((struct past *)ctx)->stream->rows[row].info;
	return true;
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
	for (int i = 0; i < p->stream->count; i++) {
		p->stream->rows[i].past_print = 0;
		p->stream->rows[i].past_us = 0; /* the same may come once more */
	}
	for (int i = 0; i < p->stream->chip_count; i++)
		p->stream->chips[i].filled = false;
}

static void drop_batch(struct past *p)
{
	for (int i = 0; p->values && i < p->value_count; i++)
		free(p->values[i].text);
	free(p->values);
	p->values = NULL;
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
	missed_drop(&p->missed);
}

/*
 * Of one outage the rows know more than its begin and end: what the broker had before. The recorder
 * may have looked later than we did, so its time of the same value may be later.
 */
static bool had_before(const struct past *p, const struct row *row, const struct replay_row *r)
{
	int64_t ns = r->at.us * NS_PER_US;

	if (p->missed.count > 1 || r->at.boot != p->missed.boot)
		return false;
	return (row->born_ns && ns > row->born_ns - NS_PER_US) ||
	       (row->past_ns && ns <= row->past_ns + SAME_NS);
}

/* A value that holds comes again each hour. */
static bool is_same(const struct past *p, struct row *row, const struct replay_row *r)
{
	uint64_t print = face_value_print(&r->v, r->text),
		 before = row->past_print || p->missed.count > 1 ? row->past_print : row->past_told;

	row->past_print = print;
	row->past_told = 0;
	return print == before;
}

static void add_value(struct past *p, struct row *row, struct replay_row *r)
{
	struct past_value *value = &p->values[p->value_count++];

	*value = (struct past_value){.row = row,
	                             .wall_us = r->wall_us,
	                             .here = r->at.boot == p->missed.boot,
	                             .v = r->v,
	                             .text = r->text};
	/* who keeps values by their milliseconds keeps all of a burst, in their order */
	if (value->wall_us < row->past_us + US_PER_MS && value->wall_us > row->past_us - US_PER_S)
		value->wall_us = row->past_us + US_PER_MS;
	row->past_us = value->wall_us;
	value->place = p->value_count;
	r->text = NULL;
}

/* From then on nothing is known: no number, of no row that is there. */
static void add_gap(struct past *p, struct replay_row *r)
{
	assert(p->stream->rows);
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

/* A row may be damaged. */
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
	for (int i = 0; i < n; i++) {
		struct row *row = rows[i].signal < 0 ? NULL : &p->stream->rows[rows[i].signal];

		if (rows[i].signal == -1)
			add_gap(p, &rows[i]);
		else if (row && is_sound(&rows[i]) && !had_before(p, row, &rows[i]) &&
		         !is_same(p, row, &rows[i]))
			add_value(p, row, &rows[i]);
		free(rows[i].text);
	}
	qsort(p->values, (size_t)p->value_count, sizeof(*p->values), by_chip);
	p->last = rows[n - 1].at;
	p->read = true;
}

/* The broker has it. */
static void end_batch(struct past *p, int64_t now_ns)
{
	missed_given(&p->missed, &p->last, p->value_count, now_ns);
	p->missed.next_ns += p->value_count ? PACE_NS : 0;
	drop_batch(p);
}

static void read_batch(struct past *p, int64_t now_ns)
{
	struct replay_row rows[BATCH];
	int count = p->stream->count, most = count > BATCH ? count : BATCH, n;
	int stretches = p->missed.count;

	p->offset_us = missed_point(&p->missed, 0).wall_us;
	p->values = calloc((size_t)most, sizeof(*p->values));
	n = p->values ? missed_read(&p->missed, count, rows, BATCH, now_ns) : 0;
	if (n) {
		take_rows(p, rows, n);
		if (!p->value_count)
			end_batch(p, now_ns);
		return;
	}
	drop_batch(p);
	if (p->missed.count < stretches)
		begin_anew(p);
	if (!p->missed.count || p->missed.count == stretches)
		let_die(p);
}

/* The clock may have been set while they waited. */
static void date_anew(struct past *p)
{
	int64_t by_us = missed_point(&p->missed, 0).wall_us - p->offset_us;

	p->offset_us += by_us;
	for (int i = p->put; i < p->value_count; i++)
		p->values[i].wall_us += p->values[i].here ? by_us : 0;
}

static bool put_batch(struct past *p)
{
	date_anew(p);
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

/* --- Sessions -------------------------------------------------------------------------------- */

void past_begin(struct past *p, uint64_t key)
{
	p->on = p->stream->profile->past;
	p->lost = true;
	p->missed.face = p->face;
	p->missed.peer = "the broker";
	p->missed.what = "mqtt";
	p->missed.info = info_of;
	p->missed.ctx = p;
	if (p->on)
		missed_begin(&p->missed, key, ows_now());
}

/* The broker has the birth: what it has missed before is known. */
static void begin_session(struct past *p, int64_t now_ns)
{
	missed_resume(&p->missed, &p->mark, now_ns);
	p->missed.next_ns += PACE_NS;
	p->lost = false;
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
	p->mark = missed_point(&p->missed, p->lost ? now_ns : p->face->looked_ns);
	p->mark_published = p->broker->published;
	p->marked_ns = now_ns;
}

/* The answer to a mark: the broker has all that was published before it. */
static void marked(struct past *p, int64_t now_ns)
{
	p->marking = false;
	if (p->lost)
		begin_session(p, now_ns);
	missed_has(&p->missed, &p->mark);
	for (int i = 0; i < p->stream->count; i++) {
		struct row *row = &p->stream->rows[i];

		if (!row->published || row->published_ns > p->marked_ns)
			continue;
		row->sure_ns = row->moment_ns;
		row->sure_told = row->told;
	}
	if (p->mark_batch)
		end_batch(p, now_ns);
	missed_keep(&p->missed, MISSED_KEEP_NS, now_ns);
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
		missed_keep(&p->missed, 0, ows_now());
	p->lost = true;
}

void past_end(struct past *p)
{
	past_lost(p);
	past_drop(p);
}

void past_pump(struct past *p, int64_t now_ns)
{
	struct missed *m = &p->missed;
	struct replay_point looked;

	/* a time that is wrong does not count */
	if (!p->on || !p->stream->live || !p->stream->announced || !p->stream->clock_set)
		return;
	if (p->lost && !p->marking && !missed_open(m)) {
		p->mark = missed_point(m, now_ns);
		begin_session(p, now_ns);
	}
	looked = missed_point(m, p->face->looked_ns);
	/* without a history there are no marks: what is known of has gone out */
	if (!m->there)
		missed_has(m, &looked);
	if (!missed_look(m, now_ns))
		return;
	if (p->marking && p->broker->marked)
		marked(p, now_ns);
	if (!p->lost && m->count && !p->read && now_ns >= m->next_ns)
		read_batch(p, now_ns);
	if (!p->lost && !p->marking && p->broker->published == p->mark_published)
		missed_has(m, &looked);
	if (!p->read || put_batch(p))
		mark(p, now_ns);
	p->due = !p->lost && m->count && !p->read;
}

int64_t past_next(const struct past *p)
{
	return p->due ? p->missed.next_ns : INT64_MAX;
}
