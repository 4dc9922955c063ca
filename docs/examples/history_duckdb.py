#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Questions to the history of owsd-recorder by DuckDB; run it beside history.sqlite.

DuckDB reads the file with its extension sqlite, which "install" fetches once; Python needs pytz too.
SQLite runs the text in sqlite_query(), and so finds the days. DuckDB takes columns of views for
text: hence ::double.
"""

import duckdb

db = duckdb.connect()
db.sql("install sqlite")
db.sql("load sqlite")
db.sql("attach 'history.sqlite' as history (type sqlite, read_only)")
db.sql("set timezone = 'Europe/Berlin'")


def ask(text):
    return f"sqlite_query('history', $$ {text} $$)"


trend = """select time, name, value, quality, id from trend where day >= date('now', '-7 days')
    and typeof(value) <> 'text'"""
room1 = trend + " and name = 'room1'"
last_day = db.sql(f"""select time::timestamptz as time, value::double as value, quality
    from {ask(room1)} where time::timestamptz >= now() - interval 1 day order by id""")
minutes = db.sql(f"""select time::timestamptz as time, mean::double as mean
    from {ask('''select time, mean from trend_minute
    where name = 'room1' and day >= date('now', '-1 day')''')} order by time""")
days = db.sql(f"""select time::timestamptz::date as date, min(least::double) as least,
    max(most::double) as most from {ask('''select time, least, most from trend_hour
    where name = 'room1' and day >= date('now', '-31 days')''')} group by date order by date""")
alarms = db.sql(f"""select time::timestamptz as time, name, alarm,
    seconds::double as seconds
    from {ask('select time, name, alarm, seconds from trend_alarm')} order by time""")
then = db.sql(f"""select name, arg_max_null(value::double, id) as value,
    arg_max(quality, id) as quality from {ask(trend)} where time::timestamptz
    between now() - interval 125 minute and now() - interval 1 hour group by name order by name""")
gaps = db.sql(f"""select * from (select name, time::timestamptz as since, lead(time::timestamptz)
    over (partition by name order by id) as until, quality as why, value from {ask(trend)})
    where value is null order by since, name""")
