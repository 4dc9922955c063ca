/* SPDX-License-Identifier: MIT */
/*
 * All keys of the configuration: name in enum option, key, block, kind of value, the member that
 * holds it in the struct of the block, and the other members of struct option_def. OTHER() has no
 * such member: code of its own takes the value. BLOCK() is a block of a program, which stands once:
 * its place, its name, its member of struct config, which is a struct config_MEMBER. Included where
 * one or more of the three say what is made of each.
 */
#ifndef OTHER
#define OTHER(...)
#endif
#ifndef OPTION
#define OPTION OTHER
#endif
#ifndef BLOCK
#define BLOCK OTHER
#endif
/* clang-format off */
OTHER(VERSION, "Version", DRIVER, TEXT, .preset = "1.00", .help = "version of the file format")
OTHER(TARGET_NAME, "TargetName", DRIVER, TEXT, .preset = "localhost:4304",
      .help = "where owsd reaches the devices")
OPTION(MAX_CONS_ALARMS, "MaxConsAlarms", DRIVER, COUNT, max_cons_alarms, RANGE(0, 1000),
       .preset = "5", .help = "alarms served in a row before one write or read goes through")
OTHER(MAX_REQUESTS, "MaxRequests", DRIVER, COUNT, RANGE(0, 1000), .preset = "1",
      .help = "requests at a time, in older files; counts as 1")
OPTION(MAX_RETRIES, "MaxRetries", DRIVER, COUNT, max_retries, RANGE(0, 100), .preset = "3",
       .help = "retries after an item error")
OPTION(TIMEOUT, "Timeout", DRIVER, SECONDS, timeout_ns, RANGE(0.001, DAY), .preset = "20",
       .help = "time limit of a request, seconds")
OPTION(PERIOD, "Period", DRIVER, SECONDS, period_ns, RANGE(0.001, 60), .preset = "0.1",
       .help = "period of the driver, seconds")
OPTION(ALARM_PERIOD, "AlarmPeriod", DRIVER, SECONDS, alarm_period_ns, RANGE(0, DAY),
       .preset = "0.05", .help = "least time between two readings of /alarm, seconds")
OTHER(LISTEN, "Listen", DRIVER, TEXT, .help = "where the owserver protocol is served")
OPTION(LISTEN_SOCKET, "ListenSocket", DRIVER, TEXT, serve.socket, .check = text_is_socket,
       .help = "unix socket on which it is served")
OTHER(LISTEN_ALLOW, "ListenAllow", DRIVER, TEXT,
      .help = "addresses that may connect over the network")
OPTION(LISTEN_READ_ONLY, "ListenReadOnly", DRIVER, FLAG, serve.read_only, .preset = "off",
       .quiet = true, .help = "refuse all writes over the protocol")
OTHER(CONTROL_ALLOW, "ControlAllow", DRIVER, TEXT, .repeats = true,
      .help = "who may command the signals of a pattern")
OTHER(ITEM_COUNT, "ItemCount", DRIVER, COUNT, RANGE(0, 1e9), .help = "number of items")
OPTION(ALARM_LINE, "AlarmLine", DRIVER, TEXT, alarm_line, AT(config, alarm_line_at),
       .help = "GPIO line that is on while there is an alarm")
OPTION(HEARTBEAT_LINE, "HeartbeatLine", DRIVER, TEXT, heartbeat_line, AT(config, heartbeat_line_at),
       .help = "GPIO line that blinks while owsd is well")
OTHER(BUS, "Bus", DRIVER, BLOCK, .repeats = true, .help = "options of one target")
BLOCK(RECORDER, "Recorder", recorder,
      .help = "options of owsd-recorder, which keeps the history")
BLOCK(INFLUX, "Influx", influx,
      .help = "options of owsd-influx, which pushes values to a server")
BLOCK(WEB, "Web", web,
      .help = "options of owsd-web, which shows the signals in a browser")
BLOCK(MQTT, "Mqtt", mqtt,
      .help = "options of owsd-mqtt, which publishes the signals to a broker")
BLOCK(MODBUS, "Modbus", modbus,
      .help = "options of owsd-modbus, which serves the signals to PLCs")
BLOCK(NOTIFY, "Notify", notify, AT(config, notify.at),
      .help = "options of owsd-notify, which tells people of alarms")
OTHER(ITEM, "Item", DRIVER, BLOCK, .repeats = true, .help = "one signal")

/* Of an item */
OPTION(NAME, "Name", ITEM, TEXT, name, .help = "name of the signal")
OPTION(PATH, "Path", ITEM, TEXT, path, AT(config_item, path_at),
       .help = "OWFS path of the property")
OTHER(IO_TYPE, "IOType", ITEM, COUNT, RANGE(0, UINT32_MAX),
      .help = "type, direction and Uncached as bits")
OPTION(IDENTITY, "Identity", ITEM, TEXT, identity_text, .check = text_is_identity,
       .help = "the path that the signal began with, where its device was replaced")
OPTION(TYPE, "Type", ITEM, TYPE, type, AT(config_item, type_at), .help = "data type")
OPTION(IO, "IO", ITEM, IO, output, .preset = "input",
       .help = "read cyclically, or written when changed")
OPTION(READABLE, "Readable", ITEM, FLAG, readable,
       .help = "start value of _ReadEnable; on for inputs, off for outputs")
OPTION(WRITABLE, "Writable", ITEM, FLAG, writable,
       .help = "start value of _WriteEnable; on for outputs, off for inputs")
OPTION(UNCACHED, "Uncached", ITEM, FLAG, fresh, .preset = "off", .help = "read past the cache")
OPTION(INIT_VALUE, "InitValue", ITEM, TEXT, init_text, .preset = "",
       .help = "value until the first read; outputs: written once at start")
OPTION(SAFE_VALUE, "SafeValue", ITEM, TEXT, safe_text, HAS(config_item, has_safe), .empty = true,
       .help = "written when the control program stops beating")
OPTION(SAFE_DELAY, "SafeDelay", ITEM, SECONDS, safe_delay_ns, HAS(config_item, has_safe_delay),
       RANGE(0, DAY),
       .help = "how long SafeValue waits for a control program that is lost, seconds")
OPTION(START, "Start", ITEM, TEXT, start, .words = "init or last", .preset = "init", .quiet = true,
       .help = "what an output begins with: init (InitValue) or last (as it was)")
OPTION(CONFIRM, "Confirm", ITEM, FLAG, confirm, .preset = "off", .quiet = true,
       .help = "a person is asked once more before a set by hand")
OPTION(READ_BACK, "ReadBack", ITEM, SECONDS, read_back_ns, AT(config_item, read_back_at),
       RANGE(0, DAY),
       .help = "how often an output is read back, seconds; 0: never; 10 for switches")
OPTION(RESTORE, "Restore", ITEM, FLAG, restores, AT(config_item, restore_at), .preset = "off",
       .quiet = true,
       .help = "write a command again that the device does not have any more")
OPTION(PER_FACTOR, "PerFactor", ITEM, COUNT, per_factor, RANGE(1, 1e6), .preset = "1",
       .help = "read again no sooner than that many periods later")
OPTION(STALE_AFTER, "StaleAfter", ITEM, SECONDS, stale_after_ns, RANGE(0, 365 * DAY), .preset = "0",
       .help = "age at which a value is no longer good, seconds; 0: never")
OPTION(ALARM, "Alarm", ITEM, FLAG, alarm, .preset = "off", .help = "watch the device by its alarms")
OPTION(LATCH_ALARM, "LatchAlarm", ITEM, TEXT, latch_alarm, AT(config_item, latch_at), .empty = true,
       .help = "property that shows what changed")
OPTION(POR_ALARM, "PorAlarm", ITEM, TEXT, por_alarm, AT(config_item, por_at), .empty = true,
       .help = "property that shows that the device restarted")
OPTION(SET_ALARM, "SetAlarm", ITEM, TEXT, set_alarm, AT(config_item, set_at), .empty = true,
       .help = "property=value that arms the alarm")
OPTION(RESET_LATCH, "ResetLatch", ITEM, TEXT, reset_latch, AT(config_item, reset_at), .empty = true,
       .help = "property=value that clears the latch")
OPTION(LIMIT_HH, "LimitHH", ITEM, NUMBER, limits.limit[CONFIG_LIMIT_HH],
       HAS(config_item, limits.has[CONFIG_LIMIT_HH]),
       .help = "alarm at or above that value, higher than LimitH")
OPTION(LIMIT_H, "LimitH", ITEM, NUMBER, limits.limit[CONFIG_LIMIT_H],
       HAS(config_item, limits.has[CONFIG_LIMIT_H]), .help = "alarm at or above that value")
OPTION(LIMIT_L, "LimitL", ITEM, NUMBER, limits.limit[CONFIG_LIMIT_L],
       HAS(config_item, limits.has[CONFIG_LIMIT_L]), .help = "alarm at or below that value")
OPTION(LIMIT_LL, "LimitLL", ITEM, NUMBER, limits.limit[CONFIG_LIMIT_LL],
       HAS(config_item, limits.has[CONFIG_LIMIT_LL]),
       .help = "alarm at or below that value, lower than LimitL")
OPTION(HYSTERESIS, "Hysteresis", ITEM, NUMBER, limits.hysteresis, RANGE(0, DBL_MAX), .preset = "0",
       .quiet = true, .help = "how far a value returns inside a limit before its alarm ends")
OPTION(ON_DELAY, "OnDelay", ITEM, SECONDS, limits.on_delay_ns, RANGE(0, DAY), .preset = "0",
       .quiet = true,
       .help = "how long a limit alarm's condition stands before it is raised, seconds")
OPTION(OFF_DELAY, "OffDelay", ITEM, SECONDS, limits.off_delay_ns, RANGE(0, DAY), .preset = "0",
       .quiet = true, .help = "how long it is gone before the alarm returns, seconds")
OPTION(UNIT, "Unit", ITEM, TEXT, unit, .check = text_is_unit, .empty = true,
       .help = "unit of the value, such as bar")
OPTION(DECIMALS, "Decimals", ITEM, COUNT, decimals,
       HAS(config_item, has_decimals), RANGE(0, 15),
       .help = "most digits after the point, where people read the value")
OPTION(DESCRIPTION, "Description", ITEM, TEXT, description, .check = text_is_line,
       .help = "what the signal is, for people")
OPTION(GROUP, "Group", ITEM, TEXT, group, .check = text_is_line,
       .help = "where people look for the signal, such as a room")
OPTION(SCALE, "Scale", ITEM, NUMBER, factor, .preset = "1", .quiet = true,
       .help = "value = raw value * Scale + Offset")
OPTION(OFFSET, "Offset", ITEM, NUMBER, offset, .preset = "0", .quiet = true, .help = "see Scale")
OPTION(POINTS, "Points", ITEM, TEXT, points,
       .help = "a line through points RAW:VALUE, in place of Scale")
OPTION(MIN, "Min", ITEM, NUMBER, scale.min, HAS(config_item, scale.has_min),
       .help = "a value below it is out of range")
OPTION(MAX, "Max", ITEM, NUMBER, scale.max, HAS(config_item, scale.has_max),
       .help = "a value above it is out of range")
OPTION(MAX_STEP, "MaxStep", ITEM, NUMBER, max_step, RANGE(0, DBL_MAX), .preset = "0", .quiet = true,
       .help = "most that the value changes in a second: a larger jump is held back; 0: no limit")
OPTION(FILTER, "Filter", ITEM, SECONDS, filter_s, RANGE(0, DAY), .preset = "0", .quiet = true,
       .help = "time constant of a low-pass filter, seconds; 0: none")
OPTION(DEADBAND, "Deadband", ITEM, NUMBER, deadband, RANGE(0, DBL_MAX), .preset = "0",
       .quiet = true, .help = "a smaller change is not listed as one")
OPTION(CALIBRATED, "Calibrated", ITEM, TEXT, calibrated, .check = text_is_date,
       .help = "date of the last calibration, for the record")
OPTION(RECORD, "Record", ITEM, TEXT, record_text,
       .help = "when owsd-recorder keeps a value: change, deadband, interval, off")
OPTION(CLASS, "Class", ITEM, TEXT, device_class, .check = text_is_class,
       .help = "what it is to Home Assistant: light, cover, or a device class")

/* Of a Bus block */
OTHER(BUS_TARGET, "Target", BUS, TEXT, .help = "the target it is for")
OTHER(BUS_POWER_LINE, "PowerLine", BUS, TEXT,
      .help = "GPIO line that switches the supply of the wire")
OTHER(BUS_POWER_OFF_MS, "PowerOffMs", BUS, COUNT, RANGE(1, 60000), .preset = "500",
      .help = "how long the supply is off, milliseconds")
OTHER(BUS_SLEEP_LINE, "SleepLine", BUS, TEXT, .help = "GPIO line at the SLPZ pin of the chips")
OTHER(BUS_SENSORS, "Sensors", BUS, TEXT, .help = "file of the sensors behind bridges to I2C")
OTHER(BUS_ACTIVE_LOW, "ActiveLow", BUS, TEXT, .help = "lines that are 1 when low")
OTHER(BUS_PULL_UP, "PullUp", BUS, TEXT, .help = "lines with pull-up")
OTHER(BUS_PULL_DOWN, "PullDown", BUS, TEXT, .help = "lines with pull-down")
OTHER(BUS_OPEN_DRAIN, "OpenDrain", BUS, TEXT, .help = "outputs that only pull low")
OTHER(BUS_OPEN_SOURCE, "OpenSource", BUS, TEXT, .help = "outputs that only drive high")
OTHER(BUS_TOUCH, "Touch", BUS, FLAG, .preset = "off",
      .help = "keys that touch the wire are noticed at once")

/* Of the Recorder block */
OPTION(RECORDER_DIRECTORY, "Directory", RECORDER, TEXT, directory, .check = text_is_path,
       .help = "where the history is kept")
OPTION(RECORDER_KEEP, "Keep", RECORDER, COUNT, keep_days, RANGE(0, 36500), .preset = "90",
       .help = "days after which values are deleted; 0: never")
OPTION(RECORDER_KEEP_MINUTES, "KeepMinutes", RECORDER, COUNT, keep_minutes, RANGE(0, 36500),
       .preset = "730", .help = "the same of sums by the minute, and of events")
OPTION(RECORDER_KEEP_HOURS, "KeepHours", RECORDER, COUNT, keep_hours, RANGE(0, 36500),
       .preset = "0", .help = "the same of sums by the hour")
OPTION(RECORDER_SIZE, "Size", RECORDER, COUNT, size_mb, RANGE(0, 1e6), .preset = "2000",
       .help = "most megabytes of history, the oldest is deleted; 0: no limit")
OPTION(RECORDER_FLUSH, "Flush", RECORDER, SECONDS, flush_ns, RANGE(1, 600), .preset = "600",
       .help = "how long what is recorded may be in memory alone, seconds")
OPTION(RECORDER_RECORD, "Record", RECORDER, TEXT, record_text, .preset = "change",
       .help = "of items without a Record of their own")

/* Of the Influx block */
OPTION(INFLUX_URL, "Url", INFLUX, TEXT, url, .check = text_is_url,
       .needed = "http://127.0.0.1:8428/write",
       .help = "where the server takes line protocol: http or https")
OPTION(INFLUX_EVERY, "Every", INFLUX, SECONDS, every_ns, RANGE(0.1, 3600), .preset = "10",
       .help = "how often what has changed is sent, seconds")
OPTION(INFLUX_TOKEN_FILE, "TokenFile", INFLUX, TEXT, token_file, .check = text_is_file,
       .help = "file with the token, or name of a credential")
OPTION(INFLUX_MEASUREMENT, "Measurement", INFLUX, TEXT, measurement, .check = text_is_name,
       .preset = "ows", .help = "measurement of all points")
OPTION(INFLUX_CLOCK_WAIT, "ClockWait", INFLUX, SECONDS, clock_wait_ns, RANGE(0, DAY),
       .preset = "600", .help = "uptime from which a clock that nobody set is believed")

/* Of the Notify block */
OPTION(NOTIFY_MAIL, "Mail", NOTIFY, TEXT, mail, .check = text_is_mail,
       .help = "addresses that get a mail, with commas between them")
OPTION(NOTIFY_MAIL_FROM, "MailFrom", NOTIFY, TEXT, mail_from, .check = text_is_mail,
       .help = "sender of the mails")
OPTION(NOTIFY_SENDMAIL, "Sendmail", NOTIFY, TEXT, sendmail, .check = text_is_path,
       .preset = "/usr/sbin/sendmail", .help = "program that takes a mail, as sendmail does")
OPTION(NOTIFY_URL, "Url", NOTIFY, TEXT, url, .check = text_is_url,
       .help = "where a server takes a message as JSON: http or https")
OPTION(NOTIFY_FIELDS, "Fields", NOTIFY, TEXT, fields, .check = text_is_fields,
       .help = "more members of that JSON: NAME=TEXT, with blanks between them")
OPTION(NOTIFY_TOKEN_FILE, "TokenFile", NOTIFY, TEXT, token_file, .check = text_is_file,
       .help = "file with the token of that server, or name of a credential")
OPTION(NOTIFY_COMMAND, "Command", NOTIFY, TEXT, command, .check = text_is_path,
       .help = "program that is run with title and text of a message")
OPTION(NOTIFY_SIGNALS, "Signals", NOTIFY, TEXT, signals, .preset = "*",
       .help = "patterns of the signals that count, with commas; !PATTERN: not these")
OPTION(NOTIFY_LEAST, "Least", NOTIFY, TEXT, least, .words = "warning or critical",
       .preset = "warning", .help = "least severity that is told: warning or critical")
OPTION(NOTIFY_RETURNS, "Returns", NOTIFY, FLAG, returns, .preset = "off",
       .help = "tell also that an alarm has returned")
OPTION(NOTIFY_BAD_AFTER, "BadAfter", NOTIFY, SECONDS, bad_after_ns, RANGE(0, 365 * DAY),
       .preset = "0", .help = "tell of a value that is bad for so many seconds; 0: never")
OPTION(NOTIFY_GATHER, "Gather", NOTIFY, SECONDS, gather_ns, RANGE(0, 3600), .preset = "10",
       .help = "how long an alarm waits for others in the same message, seconds")
OPTION(NOTIFY_EVERY, "Every", NOTIFY, SECONDS, every_ns, RANGE(0, DAY), .preset = "60",
       .help = "least time from one message to the next, seconds")
OPTION(NOTIFY_QUIET, "Quiet", NOTIFY, TEXT, quiet, .check = text_is_hours,
       .help = "hours in which warnings wait, such as 22:00-06:30")
OPTION(NOTIFY_QUIET_ALL, "QuietAll", NOTIFY, FLAG, quiet_all, .preset = "off",
       .help = "in these hours also critical alarms wait")
OPTION(NOTIFY_ESCALATE_AFTER, "EscalateAfter", NOTIFY, SECONDS, escalate_ns, RANGE(0, DAY),
       .preset = "0",
       .help = "tell once more of an alarm that nobody acknowledges for so long, seconds; 0: no")
OPTION(NOTIFY_ESCALATE_MAIL, "EscalateMail", NOTIFY, TEXT, escalate_mail, .check = text_is_mail,
       .help = "addresses that get a mail then")
OPTION(NOTIFY_LINK, "Link", NOTIFY, TEXT, link, .check = text_is_url,
       .help = "address of the page, for the messages")

/* Of the Web block */
OPTION(WEB_LISTEN, "Listen", WEB, TEXT, listen,
       .help = "addresses where the page is served, besides its socket")
OPTION(WEB_HOSTS, "Hosts", WEB, TEXT, hosts, .check = text_is_hosts,
       .help = "more names under which a browser may ask for the page")
OPTION(WEB_WRITE, "Write", WEB, FLAG, write, .preset = "off",
       .help = "let the page set outputs and acknowledge alarms")
OPTION(WEB_CONFIGURE, "Configure", WEB, FLAG, configure, .preset = "off",
       .help = "let the page edit and save the configuration")
OPTION(WEB_PROXY, "Proxy", WEB, TEXT, proxy,
       .help = "user or address of the reverse proxy that names the person")
OPTION(WEB_FILES, "Files", WEB, TEXT, files, .check = text_is_path,
       .help = "where the files of the page are")
OPTION(WEB_OTHERS, "Others", WEB, TEXT, others,
       .help = "pages of other machines: NAME ADDRESS, with commas between them")

/* Of the Mqtt block */
OPTION(MQTT_BROKER, "Broker", MQTT, TEXT, broker, .check = text_is_short,
       .preset = "mqtt://localhost",
       .help = "ways to a broker, with | between them; the first that works")
OPTION(MQTT_USER, "User", MQTT, TEXT, user, .check = text_is_short,
       .help = "name towards the broker")
OPTION(MQTT_PASSWORD_FILE, "PasswordFile", MQTT, TEXT, password_file, .check = text_is_file,
       .help = "file with the password, or name of a credential")
OPTION(MQTT_CA_FILE, "CaFile", MQTT, TEXT, ca_file, .check = text_is_file,
       .help = "certificates that vouch for the broker, likewise")
OPTION(MQTT_CERT_FILE, "CertFile", MQTT, TEXT, cert_file, .check = text_is_file,
       .help = "certificate towards the broker, likewise")
OPTION(MQTT_KEY_FILE, "KeyFile", MQTT, TEXT, key_file, .check = text_is_file,
       .help = "key of that certificate, likewise")
OPTION(MQTT_PROTOCOL, "Protocol", MQTT, TEXT, protocol, .words = "5 or 3.1.1", .preset = "5",
       .help = "version of MQTT to begin with: 5 or 3.1.1")
OPTION(MQTT_NODE, "Node", MQTT, TEXT, node, .check = text_is_name,
       .help = "name of this machine and instance in topics")
OPTION(MQTT_TOPIC, "Topic", MQTT, TEXT, topic, .check = text_is_topic, .preset = "owsd",
       .help = "what all topics begin with")
OPTION(MQTT_PROFILE, "Profile", MQTT, TEXT, profile, .check = text_is_profile,
       .preset = "homeassistant",
       .help = "for whom it is published:" MQTT_PROFILES(MQTT_PROFILE_WORD))
OPTION(MQTT_DISCOVERY, "Discovery", MQTT, TEXT, discovery, .check = text_is_topic,
       .preset = "homeassistant", .help = "where Home Assistant looks for devices")
OPTION(MQTT_OLD_READERS, "OldReaders", MQTT, FLAG, old_readers, .preset = "off",
       .help = "publish as readers of years ago want it, too")
OPTION(MQTT_LINK, "Link", MQTT, TEXT, link, .check = text_is_url,
       .help = "address of the page, for Home Assistant")
OPTION(MQTT_PRIMARY_HOST, "PrimaryHost", MQTT, TEXT, primary_host, .check = text_is_name,
       .help = "host of Sparkplug without which nothing is published")
OPTION(MQTT_WRITE, "Write", MQTT, FLAG, write, .preset = "off",
       .help = "take commands from the broker")
OPTION(MQTT_RENAME, "Rename", MQTT, FLAG, rename, .preset = "off",
       .help = "let who publishes at the broker rename signals")

/* Of the Modbus block */
OPTION(MODBUS_LISTEN, "Listen", MODBUS, TEXT, listen, .needed = "127.0.0.1:502",
       .help = "addresses where Modbus TCP is served")
OPTION(MODBUS_UNIT_ID, "UnitId", MODBUS, COUNT, unit, RANGE(0, 247), .preset = "0",
       .help = "the unit that answers; 0: every one")
OPTION(MODBUS_WORD_ORDER, "WordOrder", MODBUS, TEXT, word_order, .words = "big or little",
       .preset = "big", .help = "which register of a number comes first: big or little end")
OPTION(MODBUS_BAD_VALUE, "BadValue", MODBUS, TEXT, bad_value, .words = "nan or exception",
       .preset = "nan", .help = "what is read in place of a value that is not good: nan or exception")
OPTION(MODBUS_DECIMALS, "Decimals", MODBUS, COUNT, decimals, RANGE(0, 6), .preset = "1",
       .help = "digits after the point that the whole numbers of a value have")
OPTION(MODBUS_CLIENTS, "Clients", MODBUS, COUNT, clients, RANGE(1, 256), .preset = "64",
       .help = "most connections at a time")
OPTION(MODBUS_MAP, "Map", MODBUS, TEXT, map, .check = text_is_path,
       .help = "file with places of signals that are fixed")
OPTION(MODBUS_WRITE, "Write", MODBUS, FLAG, write, .preset = "off",
       .help = "take commands from the clients of Allow")
OPTION(MODBUS_ALLOW, "Allow", MODBUS, TEXT, allow,
       .help = "which signals from where: PATTERN ADDRESS..., with commas between them")
OPTION(MODBUS_BEAT, "Beat", MODBUS, SECONDS, beat_ns, RANGE(0, 3600), .preset = "10",
       .help = "silence of a client after which its outputs go to SafeValue, seconds; 0: never")
/* clang-format on */
#undef BLOCK
#undef OPTION
#undef OTHER
