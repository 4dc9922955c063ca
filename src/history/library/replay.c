/* SPDX-License-Identifier: MIT */
/* The rows of all signals in the order of their ids. */
#include <errno.h>
#include <stdlib.h>

#include "src/history/file/sql.h"
#include "src/history/library/open.h"
#include "src/history/library/replay.h"
#include "src/history/library/steps.h"

int64_t replay_place(const struct ows_history *h, const struct replay_point *point)
{
	int64_t place = -ENOENT;

	for (int i = 0; i < h->session_count; i++) {
		const struct session *session = &h->sessions[i];
		int64_t id = handle_within(point->us, 0, MOST_US) + session->base;

		if (session->boot != point->boot || (place >= 0 && id < session->start))
			continue;
		place = id < session->start ? session->start : id;
		/* Later than the run: its last row is the gap. The next id is of the next run. */
		if (i + 1 < h->session_count && place > session->end)
			place = session->end - 1;
	}
	if (place >= 0 || point->boot == h->boot)
		return place;
	place = replay_end(h);
	for (int i = h->session_count; i-- > 0; place = h->sessions[i].start)
		if (h->sessions[i].boot != h->boot &&
		    handle_wall_us(&h->sessions[i], h->sessions[i].start) < point->wall_us)
			break;
	return place;
}

int64_t replay_end(const struct ows_history *h)
{
	return h->end + 1;
}

int replay_rows(struct ows_history *h, int64_t first, int64_t end, struct replay_row *rows, int n)
{
	sqlite3_stmt *from = h->statements[H_ALL];
	int count = 0, got = 0, session = 0;

	open_allow(h);
	sql_bind(from, "iii", first, end, (int64_t)n);
	while (count < n && (got = sql_next(from)) == 1) {
		struct replay_row *row = &rows[count];
		int64_t number = sqlite3_column_int64(from, 4);
		int signal = number ? handle_signal(h, number) : -1;
		const struct session *of;
		struct step step = {0};

		if (number && signal < 0)
			continue;
		got = steps_take(from, number ? &h->signals[signal] : &(struct known_signal){0},
		                 &step);
		if (got < 0)
			break;
		while (session + 1 < h->session_count && step.id >= h->sessions[session].end)
			session++;
		of = &h->sessions[session];
		*row = (struct replay_row){
			.at = {of->boot, handle_boot_us(of, step.id), handle_wall_us(of, step.id)},
			.wall_us = handle_wall_us(of, step.id),
			.dated = of->trusted,
			.signal = signal,
			.v = {.number = step.number,
		              .integer = step.integer,
		              .type = step.type,
		              .quality = step.quality},
			.text = step.text,
		};
		count++;
	}
	sqlite3_reset(from);
	for (int i = 0; got < 0 && i < count; i++)
		free(rows[i].text);
	return got < 0 ? got : count;
}
