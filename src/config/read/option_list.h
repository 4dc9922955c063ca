/* SPDX-License-Identifier: MIT */
/*
 * All keys of the configuration: name in enum option, key, block, kind of value, and the other
 * members of struct option_def. Included where OPTION() says what is made of each.
 */
/* clang-format off */
OPTION(VERSION, "Version", DRIVER, TEXT, .preset = "1.00", .help = "version of the file format")
OPTION(TARGET_NAME, "TargetName", DRIVER, TEXT, .preset = "localhost:4304",
       .help = "where owsd reaches the devices")
OPTION(MAX_CONS_ALARMS, "MaxConsAlarms", DRIVER, COUNT, TO(config, max_cons_alarms), RANGE(0, 1000),
       .preset = "5", .help = "alarms served in a row before one write or read goes through")
OPTION(MAX_REQUESTS, "MaxRequests", DRIVER, COUNT, RANGE(0, 1000), .preset = "1",
       .help = "requests at a time, in older files; counts as 1")
OPTION(MAX_RETRIES, "MaxRetries", DRIVER, COUNT, TO(config, max_retries), RANGE(0, 100),
       .preset = "3", .help = "retries after an item error")
OPTION(TIMEOUT, "Timeout", DRIVER, SECONDS, TO(config, timeout_ns), RANGE(0.001, DAY),
       .preset = "20", .help = "time limit of a request, seconds")
OPTION(PERIOD, "Period", DRIVER, SECONDS, TO(config, period_ns), RANGE(0.001, 60), .preset = "0.1",
       .help = "period of the driver, seconds")
OPTION(ALARM_PERIOD, "AlarmPeriod", DRIVER, SECONDS, TO(config, alarm_period_ns), RANGE(0, DAY),
       .preset = "0.05", .help = "least time between two readings of /alarm, seconds")
OPTION(LISTEN, "Listen", DRIVER, TEXT, .help = "where the owserver protocol is served")
OPTION(LISTEN_SOCKET, "ListenSocket", DRIVER, TEXT, TO(config, serve.socket),
       .check = text_is_socket, .help = "unix socket on which it is served")
OPTION(LISTEN_ALLOW, "ListenAllow", DRIVER, TEXT,
       .help = "addresses that may connect over the network")
OPTION(LISTEN_READ_ONLY, "ListenReadOnly", DRIVER, FLAG, TO(config, serve.read_only),
       .preset = "off", .quiet = true, .help = "refuse all writes over the protocol")
OPTION(CONTROL_ALLOW, "ControlAllow", DRIVER, TEXT, .repeats = true,
       .help = "who may command the signals of a pattern")
OPTION(ITEM_COUNT, "ItemCount", DRIVER, COUNT, RANGE(0, 1e9), .help = "number of items")
OPTION(ALARM_LINE, "AlarmLine", DRIVER, TEXT, TO(config, alarm_line), AT(config, alarm_line_at),
       .help = "GPIO line that is on while there is an alarm")
OPTION(HEARTBEAT_LINE, "HeartbeatLine", DRIVER, TEXT, TO(config, heartbeat_line),
       AT(config, heartbeat_line_at), .help = "GPIO line that blinks while owsd is well")
OPTION(BUS, "Bus", DRIVER, BLOCK, .repeats = true, .help = "options of one target")
OPTION(RECORDER, "Recorder", DRIVER, BLOCK, INSIDE(RECORDER, recorder),
       .help = "options of owsd-recorder, which keeps the history")
OPTION(INFLUX, "Influx", DRIVER, BLOCK, INSIDE(INFLUX, influx),
       .help = "options of owsd-influx, which pushes values to a server")
OPTION(WEB, "Web", DRIVER, BLOCK, INSIDE(WEB, web),
       .help = "options of owsd-web, which shows the signals in a browser")
OPTION(MQTT, "Mqtt", DRIVER, BLOCK, INSIDE(MQTT, mqtt),
       .help = "options of owsd-mqtt, which publishes the signals to a broker")
OPTION(ITEM, "Item", DRIVER, BLOCK, .repeats = true, .help = "one signal")

/* Of an item */
OPTION(NAME, "Name", ITEM, TEXT, TO(config_item, name), .help = "name of the signal")
OPTION(PATH, "Path", ITEM, TEXT, TO(config_item, path), AT(config_item, path_at),
       .help = "OWFS path of the property")
OPTION(IO_TYPE, "IOType", ITEM, COUNT, RANGE(0, UINT32_MAX),
       .help = "type, direction and Uncached as bits")
OPTION(IDENTITY, "Identity", ITEM, TEXT, TO(config_item, identity_text), .check = text_is_identity,
       .help = "the path that the signal began with, where its device was replaced")
OPTION(TYPE, "Type", ITEM, TYPE, TO(config_item, type), AT(config_item, type_at), .help = "data type")
OPTION(IO, "IO", ITEM, IO, TO(config_item, output), .preset = "input",
       .help = "read cyclically, or written when changed")
OPTION(READABLE, "Readable", ITEM, FLAG, TO(config_item, readable),
       .help = "start value of _ReadEnable; on for inputs, off for outputs")
OPTION(WRITABLE, "Writable", ITEM, FLAG, TO(config_item, writable),
       .help = "start value of _WriteEnable; on for outputs, off for inputs")
OPTION(UNCACHED, "Uncached", ITEM, FLAG, TO(config_item, fresh), .preset = "off",
       .help = "read past the cache")
OPTION(INIT_VALUE, "InitValue", ITEM, TEXT, TO(config_item, init_text), .preset = "",
       .help = "value until the first read; outputs: written once at start")
OPTION(SAFE_VALUE, "SafeValue", ITEM, TEXT, TO(config_item, safe_text), HAS(config_item, has_safe),
       .empty = true, .help = "written when the control program stops beating")
OPTION(SAFE_DELAY, "SafeDelay", ITEM, SECONDS, TO(config_item, safe_delay_ns),
       HAS(config_item, has_safe_delay), RANGE(0, DAY),
       .help = "how long SafeValue waits for a control program that is lost, seconds")
OPTION(START, "Start", ITEM, TEXT, TO(config_item, start), .check = text_is_start, .preset = "init",
       .quiet = true, .help = "what an output begins with: init (InitValue) or last (as it was)")
OPTION(CONFIRM, "Confirm", ITEM, FLAG, TO(config_item, confirm), .preset = "off", .quiet = true,
       .help = "a person is asked once more before a set by hand")
OPTION(READ_BACK, "ReadBack", ITEM, SECONDS, TO(config_item, read_back_ns),
       AT(config_item, read_back_at), RANGE(0, DAY), .quiet = true,
       .help = "how often an output is read back, seconds; 0: never; 10 for switches")
OPTION(RESTORE, "Restore", ITEM, FLAG, TO(config_item, restores),
       AT(config_item, restore_at), .preset = "off", .quiet = true,
       .help = "write a command again that the device does not have any more")
OPTION(PER_FACTOR, "PerFactor", ITEM, COUNT, TO(config_item, per_factor), RANGE(1, 1e6),
       .preset = "1", .help = "read again no sooner than that many periods later")
OPTION(STALE_AFTER, "StaleAfter", ITEM, SECONDS, TO(config_item, stale_after_ns),
       RANGE(0, 365 * DAY), .preset = "0",
       .help = "age at which a value is no longer good, seconds; 0: never")
OPTION(ALARM, "Alarm", ITEM, FLAG, TO(config_item, alarm), .preset = "off",
       .help = "watch the device by its alarms")
OPTION(LATCH_ALARM, "LatchAlarm", ITEM, TEXT, TO(config_item, latch_alarm),
       AT(config_item, latch_at), .empty = true, .help = "property that shows what changed")
OPTION(POR_ALARM, "PorAlarm", ITEM, TEXT, TO(config_item, por_alarm), AT(config_item, por_at),
       .empty = true, .help = "property that shows that the device restarted")
OPTION(SET_ALARM, "SetAlarm", ITEM, TEXT, TO(config_item, set_alarm), AT(config_item, set_at),
       .empty = true, .help = "property=value that arms the alarm")
OPTION(RESET_LATCH, "ResetLatch", ITEM, TEXT, TO(config_item, reset_latch),
       AT(config_item, reset_at), .empty = true, .help = "property=value that clears the latch")
OPTION(LIMIT_HH, "LimitHH", ITEM, NUMBER, TO(config_item, limits.limit[CONFIG_LIMIT_HH]),
       HAS(config_item, limits.has[CONFIG_LIMIT_HH]),
       .help = "alarm at or above that value, higher than LimitH")
OPTION(LIMIT_H, "LimitH", ITEM, NUMBER, TO(config_item, limits.limit[CONFIG_LIMIT_H]),
       HAS(config_item, limits.has[CONFIG_LIMIT_H]), .help = "alarm at or above that value")
OPTION(LIMIT_L, "LimitL", ITEM, NUMBER, TO(config_item, limits.limit[CONFIG_LIMIT_L]),
       HAS(config_item, limits.has[CONFIG_LIMIT_L]), .help = "alarm at or below that value")
OPTION(LIMIT_LL, "LimitLL", ITEM, NUMBER, TO(config_item, limits.limit[CONFIG_LIMIT_LL]),
       HAS(config_item, limits.has[CONFIG_LIMIT_LL]),
       .help = "alarm at or below that value, lower than LimitL")
OPTION(HYSTERESIS, "Hysteresis", ITEM, NUMBER, TO(config_item, limits.hysteresis),
       RANGE(0, DBL_MAX), .preset = "0", .quiet = true,
       .help = "how far a value returns inside a limit before its alarm ends")
OPTION(ON_DELAY, "OnDelay", ITEM, SECONDS, TO(config_item, limits.on_delay_ns), RANGE(0, DAY),
       .preset = "0", .quiet = true,
       .help = "how long a limit alarm's condition stands before it is raised, seconds")
OPTION(OFF_DELAY, "OffDelay", ITEM, SECONDS, TO(config_item, limits.off_delay_ns), RANGE(0, DAY),
       .preset = "0", .quiet = true,
       .help = "how long it is gone before the alarm returns, seconds")
OPTION(UNIT, "Unit", ITEM, TEXT, TO(config_item, unit), .check = text_is_unit, .empty = true,
       .help = "unit of the value, such as bar")
OPTION(DECIMALS, "Decimals", ITEM, COUNT, TO(config_item, decimals), RANGE(0, 15),
       .help = "most digits after the point, where people read the value")
OPTION(DESCRIPTION, "Description", ITEM, TEXT, TO(config_item, description), .check = text_is_line,
       .help = "what the signal is, for people")
OPTION(SCALE, "Scale", ITEM, NUMBER, TO(config_item, factor), .preset = "1", .quiet = true,
       .help = "value = raw value * Scale + Offset")
OPTION(OFFSET, "Offset", ITEM, NUMBER, TO(config_item, offset), .preset = "0", .quiet = true,
       .help = "see Scale")
OPTION(POINTS, "Points", ITEM, TEXT, TO(config_item, points),
       .help = "a line through points RAW:VALUE, in place of Scale")
OPTION(MIN, "Min", ITEM, NUMBER, TO(config_item, scale.min), HAS(config_item, scale.has_min),
       .help = "a value below it is out of range")
OPTION(MAX, "Max", ITEM, NUMBER, TO(config_item, scale.max), HAS(config_item, scale.has_max),
       .help = "a value above it is out of range")
OPTION(MAX_STEP, "MaxStep", ITEM, NUMBER, TO(config_item, max_step), RANGE(0, DBL_MAX),
       .preset = "0", .quiet = true,
       .help = "most that the value changes in a second: a larger jump is held back; 0: no limit")
OPTION(FILTER, "Filter", ITEM, SECONDS, TO(config_item, filter_s), RANGE(0, DAY), .preset = "0",
       .quiet = true, .help = "time constant of a low-pass filter, seconds; 0: none")
OPTION(DEADBAND, "Deadband", ITEM, NUMBER, TO(config_item, deadband), RANGE(0, DBL_MAX),
       .preset = "0", .quiet = true, .help = "a smaller change is not listed as one")
OPTION(CALIBRATED, "Calibrated", ITEM, TEXT, TO(config_item, calibrated), .check = text_is_date,
       .help = "date of the last calibration, for the record")
OPTION(RECORD, "Record", ITEM, TEXT, TO(config_item, record_text),
       .help = "when owsd-recorder keeps a value: change, deadband, interval, off")
OPTION(CLASS, "Class", ITEM, TEXT, TO(config_item, device_class), .check = text_is_class,
       .help = "what it is to Home Assistant: light, cover, or a device class")

/* Of a Bus block */
OPTION(BUS_TARGET, "Target", BUS, TEXT, .help = "the target it is for")
OPTION(BUS_POWER_LINE, "PowerLine", BUS, TEXT,
       .help = "GPIO line that switches the supply of the wire")
OPTION(BUS_POWER_OFF_MS, "PowerOffMs", BUS, COUNT, RANGE(1, 60000), .preset = "500",
       .help = "how long the supply is off, milliseconds")
OPTION(BUS_SLEEP_LINE, "SleepLine", BUS, TEXT, .help = "GPIO line at the SLPZ pin of the chips")
OPTION(BUS_SENSORS, "Sensors", BUS, TEXT, .help = "file of the sensors behind bridges to I2C")
OPTION(BUS_ACTIVE_LOW, "ActiveLow", BUS, TEXT, .help = "lines that are 1 when low")
OPTION(BUS_PULL_UP, "PullUp", BUS, TEXT, .help = "lines with pull-up")
OPTION(BUS_PULL_DOWN, "PullDown", BUS, TEXT, .help = "lines with pull-down")
OPTION(BUS_OPEN_DRAIN, "OpenDrain", BUS, TEXT, .help = "outputs that only pull low")
OPTION(BUS_OPEN_SOURCE, "OpenSource", BUS, TEXT, .help = "outputs that only drive high")
OPTION(BUS_TOUCH, "Touch", BUS, FLAG, .preset = "off",
       .help = "keys that touch the wire are noticed at once")

/* Of the Recorder block */
OPTION(RECORDER_DIRECTORY, "Directory", RECORDER, TEXT, TO(config_recorder, directory),
       .check = text_is_path, .help = "where the history is kept")
OPTION(RECORDER_KEEP, "Keep", RECORDER, COUNT, TO(config_recorder, keep_days), RANGE(0, 36500),
       .preset = "90", .help = "days after which values are deleted; 0: never")
OPTION(RECORDER_KEEP_MINUTES, "KeepMinutes", RECORDER, COUNT, TO(config_recorder, keep_minutes),
       RANGE(0, 36500), .preset = "730", .help = "the same of sums by the minute, and of events")
OPTION(RECORDER_KEEP_HOURS, "KeepHours", RECORDER, COUNT, TO(config_recorder, keep_hours),
       RANGE(0, 36500), .preset = "0", .help = "the same of sums by the hour")
OPTION(RECORDER_SIZE, "Size", RECORDER, COUNT, TO(config_recorder, size_mb), RANGE(0, 1e6),
       .preset = "2000", .help = "most megabytes of history, the oldest is deleted; 0: no limit")
OPTION(RECORDER_FLUSH, "Flush", RECORDER, SECONDS, TO(config_recorder, flush_ns), RANGE(1, 600),
       .preset = "60", .help = "how long what is recorded may be in memory alone, seconds")
OPTION(RECORDER_RECORD, "Record", RECORDER, TEXT, TO(config_recorder, record_text),
       .preset = "change", .help = "of items without a Record of their own")

/* Of the Influx block */
OPTION(INFLUX_URL, "Url", INFLUX, TEXT, TO(config_influx, url), .check = text_is_url,
       .needed = "http://127.0.0.1:8428/write",
       .help = "where the server takes line protocol: http or https")
OPTION(INFLUX_EVERY, "Every", INFLUX, SECONDS, TO(config_influx, every_ns), RANGE(0.1, 3600),
       .preset = "10", .help = "how often what has changed is sent, seconds")
OPTION(INFLUX_TOKEN_FILE, "TokenFile", INFLUX, TEXT, TO(config_influx, token_file),
       .check = text_is_file, .help = "file with the token, or name of a credential")
OPTION(INFLUX_MEASUREMENT, "Measurement", INFLUX, TEXT, TO(config_influx, measurement),
       .check = text_is_name, .preset = "ows", .help = "measurement of all points")
OPTION(INFLUX_CLOCK_WAIT, "ClockWait", INFLUX, SECONDS, TO(config_influx, clock_wait_ns),
       RANGE(0, DAY), .preset = "600",
       .help = "uptime from which a clock that nobody set is believed")

/* Of the Web block */
OPTION(WEB_LISTEN, "Listen", WEB, TEXT, TO(config_web, listen),
       .help = "addresses where the page is served, besides its socket")
OPTION(WEB_HOSTS, "Hosts", WEB, TEXT, TO(config_web, hosts), .check = text_is_hosts,
       .help = "more names under which a browser may ask for the page")
OPTION(WEB_WRITE, "Write", WEB, FLAG, TO(config_web, write), .preset = "off",
       .help = "let the page set outputs and acknowledge alarms")
OPTION(WEB_CONFIGURE, "Configure", WEB, FLAG, TO(config_web, configure), .preset = "off",
       .help = "let the page edit and save the configuration")
OPTION(WEB_PROXY, "Proxy", WEB, TEXT, TO(config_web, proxy),
       .help = "user or address of the reverse proxy that names the person")
OPTION(WEB_FILES, "Files", WEB, TEXT, TO(config_web, files), .check = text_is_path,
       .help = "where the files of the page are")

/* Of the Mqtt block */
OPTION(MQTT_BROKER, "Broker", MQTT, TEXT, TO(config_mqtt, broker), .check = text_is_short,
       .preset = "mqtt://localhost",
       .help = "ways to a broker, with | between them; the first that works")
OPTION(MQTT_USER, "User", MQTT, TEXT, TO(config_mqtt, user), .check = text_is_short,
       .help = "name towards the broker")
OPTION(MQTT_PASSWORD_FILE, "PasswordFile", MQTT, TEXT, TO(config_mqtt, password_file),
       .check = text_is_file, .help = "file with the password, or name of a credential")
OPTION(MQTT_CA_FILE, "CaFile", MQTT, TEXT, TO(config_mqtt, ca_file), .check = text_is_file,
       .help = "certificates that vouch for the broker, likewise")
OPTION(MQTT_CERT_FILE, "CertFile", MQTT, TEXT, TO(config_mqtt, cert_file), .check = text_is_file,
       .help = "certificate towards the broker, likewise")
OPTION(MQTT_KEY_FILE, "KeyFile", MQTT, TEXT, TO(config_mqtt, key_file), .check = text_is_file,
       .help = "key of that certificate, likewise")
OPTION(MQTT_PROTOCOL, "Protocol", MQTT, TEXT, TO(config_mqtt, protocol), .check = text_is_protocol,
       .preset = "5", .help = "version of MQTT to begin with: 5 or 3.1.1")
OPTION(MQTT_NODE, "Node", MQTT, TEXT, TO(config_mqtt, node), .check = text_is_name,
       .help = "name of this machine and instance in topics")
OPTION(MQTT_TOPIC, "Topic", MQTT, TEXT, TO(config_mqtt, topic), .check = text_is_topic,
       .preset = "owsd", .help = "what all topics begin with")
OPTION(MQTT_PROFILE, "Profile", MQTT, TEXT, TO(config_mqtt, profile), .check = text_is_profile,
       .preset = "homeassistant",
       .help = "for whom it is published:" MQTT_PROFILES(MQTT_PROFILE_WORD))
OPTION(MQTT_DISCOVERY, "Discovery", MQTT, TEXT, TO(config_mqtt, discovery), .check = text_is_topic,
       .preset = "homeassistant", .help = "where Home Assistant looks for devices")
OPTION(MQTT_PRIMARY_HOST, "PrimaryHost", MQTT, TEXT, TO(config_mqtt, primary_host),
       .check = text_is_name, .help = "host of Sparkplug without which nothing is published")
OPTION(MQTT_WRITE, "Write", MQTT, FLAG, TO(config_mqtt, write), .preset = "off",
       .help = "take commands from the broker")
/* clang-format on */
