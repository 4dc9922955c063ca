/* SPDX-License-Identifier: MIT */
/* Sums on their way into the file. */
#include "src/history/file/sums.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "src/history/file/schema.h"
#include "src/history/file/sql.h"

static int put_sum(sqlite3_stmt *to, int64_t id, const struct minute *sum)
{
	sql_bind(to, "iddddddinn", id, sum->least, sum->most, sum->mean, sum->last,
	         (double)sum->good_us / 1e6, (double)sum->known_us / 1e6, (int64_t)sum->count);
	if (sum->quality >= 0)
		sqlite3_bind_int(to, 9, sum->quality);
	if (sum->worst >= 0)
		sqlite3_bind_int(to, 10, sum->worst);
	return sql_next(to);
}

/* In one row, or, if they do not fit, in one for each. */
static int put_minutes(struct sums *sums, int64_t hour, uint32_t signal, struct minute *minutes)
{
	char text[MINUTES_TEXT];
	int err = 0;

	if (minutes_pack(minutes, text)) {
		err = sql_run(sums->statements[S_MINUTES], "it", schema_minutes(hour, signal),
		              text);
	} else {
		for (int i = 0; !err && i < MINUTES; i++)
			if (minutes[i].there)
				err = put_sum(sums->statements[S_MINUTE],
				              schema_minute(hour * MINUTES + i, signal),
				              &minutes[i]);
	}
	memset(minutes, 0, MINUTES * sizeof(*minutes));
	return err;
}

int sums_give(void *ctx, bool hour, int64_t bucket, uint32_t signal, const struct rollup *sum,
              const struct rollup_state *state)
{
	struct sums *sums = ctx;
	struct minute **held = signal < SUMS_HELD ? &sums->held[signal] : NULL;
	const struct minute row = minute_of(sum, state);
	int err = 0;

	if ((hour ? bucket : bucket / MINUTES) < sums->hour)
		return 0;
	if (hour) {
		if (held && *held)
			err = put_minutes(sums, bucket, signal, *held);
		return err ? err
		           : put_sum(sums->statements[S_HOUR], schema_hour(bucket, signal), &row);
	}
	if (!held)
		return put_sum(sums->statements[S_MINUTE], schema_minute(bucket, signal), &row);
	if (!*held)
		*held = calloc(MINUTES, sizeof(**held));
	if (!*held)
		return -ENOMEM;
	(*held)[bucket % MINUTES] = row;
	return 0;
}

void sums_free(struct sums *sums)
{
	for (int i = 0; i < SUMS_HELD; i++)
		free(sums->held[i]);
	memset(sums->held, 0, sizeof(sums->held));
}

void sums_begin(struct sums *sums, int64_t hour)
{
	sums_free(sums);
	sums->hour = hour;
}
