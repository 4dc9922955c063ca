#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Questions to the history of owsd-recorder by pandas; run it beside history.sqlite."""

import sqlite3

import pandas

db = sqlite3.connect("file:history.sqlite?mode=ro", uri=True)


def ask(text, *zones):
    frame = pandas.read_sql(text, db)
    for column in zones:
        utc = pandas.to_datetime(frame[column], format="ISO8601")
        frame[column] = utc.dt.tz_convert("Europe/Berlin")
    return frame


last_day = ask("""select time, value, quality from trend where name = 'room1'
    and day >= date('now', '-1 day') and datetime(time) >= datetime('now', '-1 day')
    order by id""", "time")
minutes = ask("""select time, mean from trend_minute where name = 'room1'
    and day >= date('now', '-1 day')""", "time").set_index("time")
hours = ask("""select time, least, most from trend_hour where name = 'room1'
    and day >= date('now', '-31 days')""", "time").set_index("time")
days = hours.resample("D").agg({"least": "min", "most": "max"})
alarms = ask("select time, name, alarm, value, until, seconds from trend_alarm", "time", "until")
week = ask("""select time, name, value, quality from trend where day >= date('now', '-7 days')
    order by id""", "time")
moment = pandas.Timestamp.now("UTC") - pandas.Timedelta("1h")
then = week[week.time.between(moment - pandas.Timedelta("65min"), moment)].groupby("name").tail(1)
week["until"] = week.groupby("name").time.shift(-1)
gaps = week[week.value.isna()]
