/* SPDX-License-Identifier: MIT */
/* The views of the file, as SQL. */
#include "src/history/file/views.h"

#include <stddef.h>

#include "src/history/file/record.h"
#include "src/history/file/sql.h"

#define ISO(us) "strftime('%Y-%m-%dT%H:%M:%fZ', (" us ") / 1000000.0, 'unixepoch')"
#define DAY "86400000000"
#define MINUTE "60000000"
#define HOUR "3600000000"
/* Of the outer of two tables only the rows of that day: cross join keeps their order. */
#define ROWS(table, id) \
	" from day cross join " table " on " id " >= day.start and " id " < day.until"
#define SUMS " least, most, mean, last, good, known, count, quality, worst"
#define SIGNAL(number) " cross join signal on signal.signal = " number

/* clang-format off */
static const char day[] =
	"create view day as with span as (select start, date, coalesce("
	" (select min(start) from session later where later.start > session.start),"
	/* the hour under way has a sum later */
	" 2 * " HOUR " + max(start, coalesce(seen, 0), coalesce((select max(id) from raw), 0),"
	" coalesce((select max(start) from gap), 0), coalesce((select max(id) from event), 0)))"
	" as until from session),"
	" days(number, start, until, date) as (select (start + date) / " DAY ", start, until, date"
	" from span union all select number + 1, start, until, date from days"
	" where (number + 1) * " DAY " < until + date)"
	" select date(number * 86400, 'unixepoch') as day, max(start, number * " DAY " - date) as start,"
	" min(until, (number + 1) * " DAY " - date) as until, date from days;";

static const char trend[] =
	/* the words stand in the time so that the name is looked at before one is made */
	"create view trend as select " ISO("raw.id + date + 0 * coalesce(q.quality, 0)") " as time, name,"
	/* a number that is not good could be believed */
	" case when raw.quality >= 192 then value end as value, unit, q.text as quality, day, id"
	ROWS("raw", "raw.id") SIGNAL("raw.signal") " left join quality q on q.quality = raw.quality"
	" union all select " ISO("gap.start + date") ", name, null, unit, r.text,"
	" day, gap.start" ROWS("gap", "gap.start") " cross join signal"
	" on gap.signal in (0, signal.signal) left join reason r on r.reason = gap.reason;";

/* number: of a minute or an hour of ids, by rows of day, name, unit, date and the sum */
#define SUM_VIEW(name, number, us, rows) \
	"create view trend_" name " as select " ISO(number " * " us " + date") " as time, name," \
	" least, most, mean, last, unit, good, known, count," \
	" (select text from quality q where q.quality = t.quality) as quality," \
	" (select text from quality q where q.quality = t.worst) as worst, day" \
	" from (" rows ") t;"

/*
 * An hour of minutes is a row, as src/history/file/minutes.h has it: what is missing at the end of
 * a minute is what it mostly is. A row that is the sum of a minute has a count.
 */
#define FIELD(at, name) " json_extract(value, '$[" at "]') as " name
#define VALUE(field) " (base + step * coalesce(" field ", last)) / 1e6,"
#define MINUTE_OF(id) id " / " MINUTE
static const char trend_minute[] = SUM_VIEW("minute", "number", MINUTE,
	"select day, date, name, unit, id >> 16 as number," SUMS " from day cross join minute"
	" on id >= " MINUTE_OF("day.start") " << 16 and id < " MINUTE_OF("day.until") " << 16"
	" and count is not null" SIGNAL("id & 65535")
	" union all select day, date, name, unit, number,"
	VALUE("least") VALUE("most") VALUE("mean / 1000.0") VALUE("last")
	" coalesce(good / 1e6, 60.0), coalesce(known / 1e6, 60.0), count,"
	" nullif(coalesce(quality, 192), -1), nullif(coalesce(worst, 192), -1)"
	" from (select day, date, name, unit, (minute.id >> 16) - 59 + json_extract(value, '$[0]')"
	" as number, start, until, json_extract(minutes, '$[0]') as base,"
	" json_extract(minutes, '$[1]') as step,"
	FIELD("1", "count,") FIELD("2", "last,") FIELD("3", "least,") FIELD("4", "most,")
	FIELD("5", "mean,") FIELD("6", "good,") FIELD("7", "known,") FIELD("8", "quality,")
	FIELD("9", "worst") " from day cross join minute on minute.id >= "
	MINUTE_OF("day.start") " << 16 and minute.id < " MINUTE_OF("day.until") " + 60 << 16"
	" and minutes is not null" SIGNAL("minute.id & 65535") " cross join json_each(minutes) each"
	" on each.key > 1)"
	" where number >= " MINUTE_OF("start") " and number < " MINUTE_OF("until"));

#define BLOCK_OF(id) "(" id " / " HOUR " >> 3"
static const char trend_hour[] = SUM_VIEW("hour", "number", HOUR,
	"select day, date, name, unit, " SCHEMA_HOUR("hour.id") " as number," SUMS
	" from day cross join hour on id >= " BLOCK_OF("day.start") ") << 19 and id < "
	BLOCK_OF("day.until") ") + 1 << 19 and " SCHEMA_HOUR("hour.id") " >= day.start / " HOUR
	" and " SCHEMA_HOUR("hour.id") " < day.until / " HOUR SIGNAL("(id >> 3) & 65535"));

_Static_assert(OWS_HISTORY_CLOCK == 6 && OWS_HISTORY_COMMAND == 7 && OWS_HISTORY_ALARM == 8 &&
               OWS_ALARM_RAISED == 1 && OWS_ALARM_RETURNED == 2, "these views have them");
static const char trend_event[] =
	"create view trend_event as select " ISO("event.time + date") " as time,"
	" case event.kind when 6 then 'clock' when 7 then 'command' else 'alarm' end as kind,"
	" case when event.kind <> 6 then coalesce(c.text, ltrim(coalesce(k.text, '') || ' ' || a.text))"
	" when value <> 0 then 'set' when value = 0 then 'trust changed' end as what, name, value,"
	" before, case event.kind when 6 then 's' else unit end as unit, q.text as quality, event.text,"
	" program, person, day" ROWS("event", "event.id") " left join signal using (signal)"
	" left join quality q on q.quality = event.quality left join command_reason c"
	" on event.kind = 7 and command_reason = event.reason left join alarm_kind k"
	" on event.kind = 8 and alarm_kind = event.reason left join alarm_event a"
	" on event.kind = 8 and alarm_event = event.event;";

static const char trend_alarm[] =
	"create view trend_alarm as select " ISO("us") " as time, name, k.text as alarm, value, unit, "
	ISO("ended") " as until, (ended - us) / 1000000.0 as seconds"
	" from (select event, signal, reason, value, event.time + date as us, lead(event.time + date)"
	" over (partition by signal, reason order by event.id) as ended"
	ROWS("event", "event.id") " where kind = 8 and event in (1, 2))"
	" join signal using (signal) left join alarm_kind k on alarm_kind = reason where event = 1;";
/* clang-format on */

int views_drop(sqlite3 *db)
{
	return sql_exec(db, "drop view if exists trend; drop view if exists trend_minute;"
	                    "drop view if exists trend_hour; drop view if exists trend_event;"
	                    "drop view if exists trend_alarm; drop view if exists day;");
}

int views_make(sqlite3 *db)
{
	static const char *const views[] = {
		day, trend, trend_minute, trend_hour, trend_event, trend_alarm,
	};
	int err = 0;

	for (size_t i = 0; !err && i < sizeof(views) / sizeof(views[0]); i++)
		err = sql_exec(db, views[i]);
	return err;
}
