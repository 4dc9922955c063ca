/* SPDX-License-Identifier: MIT */
/* The table of all keys of the configuration, and how the values of a block are read by it. */
#include <ctype.h>
#include <float.h>
#include <limits.h>
#include <math.h>
#include <string.h>
#include <strings.h>

#include "src/config/options.h"
#include "src/signal/value.h"
#include "src/text/distance.h"

#define DAY 86400.0

const struct option_def option_table[OPTION_COUNT_ALL] = {
	[OPT_VERSION] = {"Version", PLACE_DRIVER, OPTION_TEXT, .preset = "1.00",
                         .help = "version of the file format"},
	[OPT_TARGET_NAME] = {"TargetName", PLACE_DRIVER, OPTION_TEXT, .preset = "localhost:4304",
                             .help = "where owsd reaches the devices"},
	[OPT_MAX_CONS_ALARMS] = {"MaxConsAlarms", PLACE_DRIVER, OPTION_COUNT, false, 0, 1000, "5",
                                 "alarms served in a row before one write or read goes through"},
	[OPT_MAX_REQUESTS] = {"MaxRequests", PLACE_DRIVER, OPTION_COUNT, false, 0, 1000, "1",
                              "requests at a time, in older files; counts as 1"},
	[OPT_MAX_RETRIES] = {"MaxRetries", PLACE_DRIVER, OPTION_COUNT, false, 0, 100, "3",
                             "retries after an item error"},
	[OPT_TIMEOUT] = {"Timeout", PLACE_DRIVER, OPTION_SECONDS, false, 0.001, DAY, "20",
                         "time limit of a request, seconds"},
	[OPT_PERIOD] = {"Period", PLACE_DRIVER, OPTION_SECONDS, false, 0.001, 60, "0.1",
                        "period of the driver, seconds"},
	[OPT_ALARM_PERIOD] = {"AlarmPeriod", PLACE_DRIVER, OPTION_SECONDS, false, 0, DAY, "0.05",
                              "least time between two readings of /alarm, seconds"},
	[OPT_LISTEN] = {"Listen", PLACE_DRIVER, OPTION_TEXT,
                        .help = "where the owserver protocol is served"},
	[OPT_LISTEN_SOCKET] = {"ListenSocket", PLACE_DRIVER, OPTION_TEXT,
                               .help = "unix socket on which it is served"},
	[OPT_LISTEN_ALLOW] = {"ListenAllow", PLACE_DRIVER, OPTION_TEXT,
                              .help = "addresses that may connect over the network"},
	[OPT_LISTEN_READ_ONLY] = {"ListenReadOnly", PLACE_DRIVER, OPTION_FLAG, .preset = "off",
                                  .help = "refuse all writes over the protocol"},
	[OPT_CONTROL_ALLOW] = {"ControlAllow", PLACE_DRIVER, OPTION_TEXT, true,
                               .help = "who may command the signals of a pattern"},
	[OPT_ITEM_COUNT] = {"ItemCount", PLACE_DRIVER, OPTION_COUNT, false, 0, 1e9, NULL,
                            "number of items"},
	[OPT_ALARM_LINE] = {"AlarmLine", PLACE_DRIVER, OPTION_TEXT,
                            .help = "GPIO line that is on while there is an alarm"},
	[OPT_HEARTBEAT_LINE] = {"HeartbeatLine", PLACE_DRIVER, OPTION_TEXT,
                                .help = "GPIO line that blinks while owsd is well"},
	[OPT_BUS] = {"Bus", PLACE_DRIVER, OPTION_BLOCK, true, .help = "options of one target"},
	[OPT_RECORDER] = {"Recorder", PLACE_DRIVER, OPTION_BLOCK,
                          .help = "options of owsd-recorder, which keeps the history"},
	[OPT_INFLUX] = {"Influx", PLACE_DRIVER, OPTION_BLOCK,
                        .help = "options of owsd-influx, which pushes values to a server"},
	[OPT_WEB] = {"Web", PLACE_DRIVER, OPTION_BLOCK,
                     .help = "options of owsd-web, which shows the signals in a browser"},
	[OPT_MQTT] = {"Mqtt", PLACE_DRIVER, OPTION_BLOCK,
                      .help = "options of owsd-mqtt, which publishes the signals to a broker"},
	[OPT_ITEM] = {"Item", PLACE_DRIVER, OPTION_BLOCK, true, .help = "one signal"},

	[OPT_NAME] = {"Name", PLACE_ITEM, OPTION_TEXT, .help = "name of the signal"},
	[OPT_PATH] = {"Path", PLACE_ITEM, OPTION_TEXT, .help = "OWFS path of the property"},
	[OPT_IO_TYPE] = {"IOType", PLACE_ITEM, OPTION_COUNT, false, 0, UINT32_MAX, NULL,
                         "type, direction and Uncached as bits"},
	[OPT_TYPE] = {"Type", PLACE_ITEM, OPTION_TYPE, .help = "data type"},
	[OPT_IO] = {"IO", PLACE_ITEM, OPTION_IO, .preset = "input",
                    .help = "read cyclically, or written when changed"},
	[OPT_READABLE] = {"Readable", PLACE_ITEM, OPTION_FLAG,
                          .help = "start value of _ReadEnable; on for inputs, off for outputs"},
	[OPT_WRITABLE] = {"Writable", PLACE_ITEM, OPTION_FLAG,
                          .help = "start value of _WriteEnable; on for outputs, off for inputs"},
	[OPT_UNCACHED] = {"Uncached", PLACE_ITEM, OPTION_FLAG, .preset = "off",
                          .help = "read past the cache"},
	[OPT_INIT_VALUE] = {"InitValue", PLACE_ITEM, OPTION_TEXT, .preset = "",
                            .help = "value until the first read; outputs: written once at start"},
	[OPT_SAFE_VALUE] = {"SafeValue", PLACE_ITEM, OPTION_TEXT,
                            .help = "written when the control program stops beating"},
	[OPT_SAFE_DELAY] = {"SafeDelay", PLACE_ITEM, OPTION_SECONDS, false, 0, DAY, NULL,
                            "how long SafeValue waits for a control program that is lost, seconds"},
	[OPT_START] = {"Start", PLACE_ITEM, OPTION_TEXT, .preset = "init",
                       .help = "what an output begins with: init (InitValue) or last (as it was)"},
	[OPT_CONFIRM] = {"Confirm", PLACE_ITEM, OPTION_FLAG, .preset = "off",
                         .help = "a person is asked once more before a set by hand"},
	[OPT_READ_BACK] = {"ReadBack", PLACE_ITEM, OPTION_SECONDS, false, 0, DAY, NULL,
                           "how often an output is read back, seconds; 0: never; 10 for switches"},
	[OPT_RESTORE] = {"Restore", PLACE_ITEM, OPTION_FLAG, .preset = "off",
                         .help = "write a command again that the device does not have any more"},
	[OPT_PER_FACTOR] = {"PerFactor", PLACE_ITEM, OPTION_COUNT, false, 1, 1e6, "1",
                            "read again no sooner than that many periods later"},
	[OPT_STALE_AFTER] = {"StaleAfter", PLACE_ITEM, OPTION_SECONDS, false, 0, 365 * DAY, "0",
                             "age at which a value is no longer good, seconds; 0: never"},
	[OPT_ALARM] = {"Alarm", PLACE_ITEM, OPTION_FLAG, .preset = "off",
                       .help = "watch the device by its alarms"},
	[OPT_LATCH_ALARM] = {"LatchAlarm", PLACE_ITEM, OPTION_TEXT,
                             .help = "property that shows what changed"},
	[OPT_POR_ALARM] = {"PorAlarm", PLACE_ITEM, OPTION_TEXT,
                           .help = "property that shows that the device restarted"},
	[OPT_SET_ALARM] = {"SetAlarm", PLACE_ITEM, OPTION_TEXT,
                           .help = "property=value that arms the alarm"},
	[OPT_RESET_LATCH] = {"ResetLatch", PLACE_ITEM, OPTION_TEXT,
                             .help = "property=value that clears the latch"},
	[OPT_LIMIT_HH] = {"LimitHH", PLACE_ITEM, OPTION_NUMBER, false, -DBL_MAX, DBL_MAX, NULL,
                          "alarm at or above that value, higher than LimitH"},
	[OPT_LIMIT_H] = {"LimitH", PLACE_ITEM, OPTION_NUMBER, false, -DBL_MAX, DBL_MAX, NULL,
                         "alarm at or above that value"},
	[OPT_LIMIT_L] = {"LimitL", PLACE_ITEM, OPTION_NUMBER, false, -DBL_MAX, DBL_MAX, NULL,
                         "alarm at or below that value"},
	[OPT_LIMIT_LL] = {"LimitLL", PLACE_ITEM, OPTION_NUMBER, false, -DBL_MAX, DBL_MAX, NULL,
                          "alarm at or below that value, lower than LimitL"},
	[OPT_HYSTERESIS] = {"Hysteresis", PLACE_ITEM, OPTION_NUMBER, false, 0, DBL_MAX, "0",
                            "how far a value returns inside a limit before its alarm ends"},
	[OPT_ON_DELAY] = {"OnDelay", PLACE_ITEM, OPTION_SECONDS, false, 0, DAY, "0",
                          "how long a limit alarm's condition stands before it is raised, seconds"},
	[OPT_OFF_DELAY] = {"OffDelay", PLACE_ITEM, OPTION_SECONDS, false, 0, DAY, "0",
                           "how long it is gone before the alarm returns, seconds"},
	[OPT_UNIT] = {"Unit", PLACE_ITEM, OPTION_TEXT, .help = "unit of the value, such as bar"},
	[OPT_DECIMALS] = {"Decimals", PLACE_ITEM, OPTION_COUNT, false, 0, 15, NULL,
                          "most digits after the point, where people read the value"},
	[OPT_DESCRIPTION] = {"Description", PLACE_ITEM, OPTION_TEXT,
                             .help = "what the signal is, for people"},
	[OPT_SCALE] = {"Scale", PLACE_ITEM, OPTION_NUMBER, false, -DBL_MAX, DBL_MAX, "1",
                       "value = raw value * Scale + Offset"},
	[OPT_OFFSET] = {"Offset", PLACE_ITEM, OPTION_NUMBER, false, -DBL_MAX, DBL_MAX, "0",
                        "see Scale"},
	[OPT_POINTS] = {"Points", PLACE_ITEM, OPTION_TEXT,
                        .help = "a line through points RAW:VALUE, in place of Scale"},
	[OPT_MIN] = {"Min", PLACE_ITEM, OPTION_NUMBER, false, -DBL_MAX, DBL_MAX, NULL,
                     "a value below it is out of range"},
	[OPT_MAX] = {"Max", PLACE_ITEM, OPTION_NUMBER, false, -DBL_MAX, DBL_MAX, NULL,
                     "a value above it is out of range"},
	[OPT_FILTER] = {"Filter", PLACE_ITEM, OPTION_SECONDS, false, 0, DAY, "0",
                        "time constant of a low-pass filter, seconds; 0: none"},
	[OPT_DEADBAND] = {"Deadband", PLACE_ITEM, OPTION_NUMBER, false, 0, DBL_MAX, "0",
                          "a smaller change is not listed as one"},
	[OPT_CALIBRATED] = {"Calibrated", PLACE_ITEM, OPTION_TEXT,
                            .help = "date of the last calibration, for the record"},
	[OPT_RECORD] =
		{"Record", PLACE_ITEM, OPTION_TEXT,
                 .help = "when owsd-recorder keeps a value: change, deadband, interval, off"},

	[OPT_CLASS] = {"Class", PLACE_ITEM, OPTION_TEXT,
                       .help = "what it is to Home Assistant: light, cover, or a device class"},

	[OPT_BUS_TARGET] = {"Target", PLACE_BUS, OPTION_TEXT, .help = "the target it is for"},
	[OPT_BUS_POWER_LINE] = {"PowerLine", PLACE_BUS, OPTION_TEXT,
                                .help = "GPIO line that switches the supply of the wire"},
	[OPT_BUS_POWER_OFF_MS] = {"PowerOffMs", PLACE_BUS, OPTION_COUNT, false, 1, 60000, "500",
                                  "how long the supply is off, milliseconds"},
	[OPT_BUS_SLEEP_LINE] = {"SleepLine", PLACE_BUS, OPTION_TEXT,
                                .help = "GPIO line at the SLPZ pin of the chips"},
	[OPT_BUS_SENSORS] = {"Sensors", PLACE_BUS, OPTION_TEXT,
                             .help = "file of the sensors behind bridges to I2C"},
	[OPT_BUS_ACTIVE_LOW] = {"ActiveLow", PLACE_BUS, OPTION_TEXT,
                                .help = "lines that are 1 when low"},
	[OPT_BUS_PULL_UP] = {"PullUp", PLACE_BUS, OPTION_TEXT, .help = "lines with pull-up"},
	[OPT_BUS_PULL_DOWN] = {"PullDown", PLACE_BUS, OPTION_TEXT, .help = "lines with pull-down"},
	[OPT_BUS_OPEN_DRAIN] = {"OpenDrain", PLACE_BUS, OPTION_TEXT,
                                .help = "outputs that only pull low"},
	[OPT_BUS_OPEN_SOURCE] = {"OpenSource", PLACE_BUS, OPTION_TEXT,
                                 .help = "outputs that only drive high"},
	[OPT_BUS_TOUCH] = {"Touch", PLACE_BUS, OPTION_FLAG, .preset = "off",
                           .help = "keys that touch the wire are noticed at once"},

	[OPT_RECORDER_DIRECTORY] = {"Directory", PLACE_RECORDER, OPTION_TEXT,
                                    .help = "where the history is kept"},
	[OPT_RECORDER_KEEP] = {"Keep", PLACE_RECORDER, OPTION_COUNT, false, 0, 36500, "90",
                               "days after which values are deleted; 0: never"},
	[OPT_RECORDER_KEEP_MINUTES] = {"KeepMinutes", PLACE_RECORDER, OPTION_COUNT, false, 0, 36500,
                                       "730", "the same of sums by the minute, and of events"},
	[OPT_RECORDER_KEEP_HOURS] = {"KeepHours", PLACE_RECORDER, OPTION_COUNT, false, 0, 36500,
                                     "0", "the same of sums by the hour"},
	[OPT_RECORDER_SIZE] = {"Size", PLACE_RECORDER, OPTION_COUNT, false, 0, 1e6, "2000",
                               "most megabytes of history, the oldest is deleted; 0: no limit"},
	[OPT_RECORDER_FLUSH] = {"Flush", PLACE_RECORDER, OPTION_SECONDS, false, 1, 600, "60",
                                "how long what is recorded may be in memory alone, seconds"},
	[OPT_RECORDER_RECORD] = {"Record", PLACE_RECORDER, OPTION_TEXT, .preset = "change",
                                 .help = "of items without a Record of their own"},

	[OPT_INFLUX_URL] = {"Url", PLACE_INFLUX, OPTION_TEXT,
                            .help = "where the server takes line protocol: http or https"},
	[OPT_INFLUX_EVERY] = {"Every", PLACE_INFLUX, OPTION_SECONDS, false, 0.1, 3600, "10",
                              "how often what has changed is sent, seconds"},
	[OPT_INFLUX_TOKEN_FILE] = {"TokenFile", PLACE_INFLUX, OPTION_TEXT,
                                   .help = "file with the token, or name of a credential"},
	[OPT_INFLUX_MEASUREMENT] = {"Measurement", PLACE_INFLUX, OPTION_TEXT, .preset = "ows",
                                    .help = "measurement of all points"},
	[OPT_INFLUX_SPOOL] = {"Spool", PLACE_INFLUX, OPTION_TEXT,
                              .help = "where batches wait for a server that is not there"},
	[OPT_INFLUX_SPOOL_SIZE] = {"SpoolSize", PLACE_INFLUX, OPTION_COUNT, false, 1, 100000, "64",
                                   "most megabytes that wait, the oldest are dropped"},
	[OPT_INFLUX_CLOCK_WAIT] = {"ClockWait", PLACE_INFLUX, OPTION_SECONDS, false, 0, DAY, "600",
                                   "uptime from which a clock that nobody set is believed"},
	[OPT_WEB_LISTEN] = {"Listen", PLACE_WEB, OPTION_TEXT,
                            .help = "addresses where the page is served, besides its socket"},
	[OPT_WEB_HOSTS] = {"Hosts", PLACE_WEB, OPTION_TEXT,
                           .help = "more names under which a browser may ask for the page"},
	[OPT_WEB_WRITE] = {"Write", PLACE_WEB, OPTION_FLAG, .preset = "off",
                           .help = "let the page set outputs and acknowledge alarms"},
	[OPT_WEB_CONFIGURE] = {"Configure", PLACE_WEB, OPTION_FLAG, .preset = "off",
                               .help = "let the page edit and save the configuration"},
	[OPT_WEB_PROXY] = {"Proxy", PLACE_WEB, OPTION_TEXT,
                           .help = "user or address of the reverse proxy that names the person"},
	[OPT_WEB_FILES] = {"Files", PLACE_WEB, OPTION_TEXT,
                           .help = "where the files of the page are"},
	[OPT_MQTT_BROKER] = {"Broker", PLACE_MQTT, OPTION_TEXT, .preset = "mqtt://localhost",
                             .help = "ways to a broker, with | between them; the first that works"},
	[OPT_MQTT_USER] = {"User", PLACE_MQTT, OPTION_TEXT, .help = "name towards the broker"},
	[OPT_MQTT_PASSWORD_FILE] = {"PasswordFile", PLACE_MQTT, OPTION_TEXT,
                                    .help = "file with the password, or name of a credential"},
	[OPT_MQTT_CA_FILE] = {"CaFile", PLACE_MQTT, OPTION_TEXT,
                              .help = "certificates that vouch for the broker, likewise"},
	[OPT_MQTT_CERT_FILE] = {"CertFile", PLACE_MQTT, OPTION_TEXT,
                                .help = "certificate towards the broker, likewise"},
	[OPT_MQTT_KEY_FILE] = {"KeyFile", PLACE_MQTT, OPTION_TEXT,
                               .help = "key of that certificate, likewise"},
	[OPT_MQTT_PROTOCOL] = {"Protocol", PLACE_MQTT, OPTION_TEXT, .preset = "5",
                               .help = "version of MQTT to begin with: 5 or 3.1.1"},
	[OPT_MQTT_NODE] = {"Node", PLACE_MQTT, OPTION_TEXT,
                           .help = "name of this machine and instance in topics"},
	[OPT_MQTT_TOPIC] = {"Topic", PLACE_MQTT, OPTION_TEXT, .preset = "owsd",
                            .help = "what all topics begin with"},
	[OPT_MQTT_PROFILE] = {"Profile", PLACE_MQTT, OPTION_TEXT, .preset = "homeassistant",
                              .help = "for whom it is published:" MQTT_PROFILES(MQTT_PROFILE_WORD)},
	[OPT_MQTT_DISCOVERY] = {"Discovery", PLACE_MQTT, OPTION_TEXT, .preset = "homeassistant",
                                .help = "where Home Assistant looks for devices"},
	[OPT_MQTT_PRIMARY_HOST] = {"PrimaryHost", PLACE_MQTT, OPTION_TEXT,
                                   .help = "host of Sparkplug without which nothing is published"},
	[OPT_MQTT_WRITE] = {"Write", PLACE_MQTT, OPTION_FLAG, .preset = "off",
                            .help = "take commands from the broker"},
};

static const char *const place_names[] = {"OwsDrv", "Item", "Bus", "Recorder",
                                          "Influx", "Web",  "Mqtt"};

int option_find(enum option_place place, const char *key)
{
	for (int i = 0; i < OPTION_COUNT_ALL; i++)
		if (option_table[i].place == place && !strcmp(option_table[i].key, key))
			return i;
	return -1;
}

/* The fields of OwsDrv's dialog whose words are far from those of the keys, as they begin. */
static const struct {
	const char *words;
	enum option option;
} dialog[] = {
	{"Target computer", OPT_TARGET_NAME},
	{"Maximum number of consecutive", OPT_MAX_CONS_ALARMS},
	{"Maximum number of retries", OPT_MAX_RETRIES},
	{"Timeout for", OPT_TIMEOUT},
	{"REX I/O Name", OPT_NAME},
	{"Sensor/Actuator Path", OPT_PATH},
	{"Power-on Reset Alarm", OPT_POR_ALARM},
};

const char *option_nearest(enum option_place place, const char *key, char text[OPTION_NEAREST])
{
	unsigned least = UINT_MAX;
	size_t used = 0;

	for (size_t i = 0; i < sizeof(dialog) / sizeof(dialog[0]); i++)
		if (option_table[dialog[i].option].place == place &&
		    !strncasecmp(key, dialog[i].words, strlen(dialog[i].words)))
			return option_table[dialog[i].option].key;
	for (int i = 0; i < OPTION_COUNT_ALL && used < OPTION_NEAREST; i++) {
		const char *known = option_table[i].key;
		unsigned distance;

		if (option_table[i].place != place)
			continue;
		distance = text_distance(key, known);
		if (distance > 1 + strlen(known) / 4 || distance > least)
			continue;
		used = distance < least ? 0 : used;
		used += (size_t)snprintf(text + used, OPTION_NEAREST - used, "%s%s",
		                         used ? " or " : "", known);
		least = distance;
	}
	return used ? text : NULL;
}

/*
 * The alarm key that has such a value, or such a name: the original's names of these keys are not
 * public. NULL: it is no part of an alarm.
 */
static const char *alarm_key(const struct rio_node *node, char text[OPTION_NEAREST])
{
	const char *value = node->kind == RIO_STRING ? node->value : "";
	bool sets = strchr(value, '=') && !strpbrk(value, " \t"),
	     latch = !strncasecmp(value, "latch", 5);

	if (sets)
		return option_table[latch ? OPT_RESET_LATCH : OPT_SET_ALARM].key;
	if (latch)
		return option_table[OPT_LATCH_ALARM].key;
	if (!strcasecmp(value, "por") || !strncasecmp(value, "por.", 4))
		return option_table[OPT_POR_ALARM].key;
	if (!strcasestr(node->key, "alarm"))
		return NULL;
	if (strcasestr(node->key, "latch"))
		return option_table[OPT_LATCH_ALARM].key;
	if (strcasestr(node->key, "por"))
		return option_table[OPT_POR_ALARM].key;
	if (strcasestr(node->key, "set"))
		return option_table[OPT_SET_ALARM].key;
	const char *near = option_nearest(PLACE_ITEM, node->key, text);

	return near ? near : option_table[OPT_ALARM].key;
}

static void report_unknown(const struct rio_node *node, enum option_place place,
                           struct config_report *report)
{
	char text[OPTION_NEAREST], alarm_text[OPTION_NEAREST];
	const char *nearest = option_nearest(place, node->key, text);
	const char *alarm = place == PLACE_ITEM ? alarm_key(node, alarm_text) : NULL;

	if (alarm)
		report_error(report, node->at,
		             "unknown key %s in %s looks like part of an alarm, which would be "
		             "off: write %s in its place",
		             node->key, place_names[place], alarm);
	else if (node->kind == RIO_BLOCK && option_find(PLACE_DRIVER, node->key) >= 0)
		report_warning(report, node->at,
		               "unknown key %s in %s is ignored; is a '}' missing before line %d?",
		               node->key, place_names[place], node->at.line);
	else if (nearest)
		report_warning(report, node->at, "unknown key %s in %s is ignored; is it %s?",
		               node->key, place_names[place], nearest);
	else
		report_warning(report, node->at, "unknown key %s in %s is ignored", node->key,
		               place_names[place]);
}

static bool parse_hex(const char *text, double *number)
{
	uint64_t sum = 0;

	if (text[0] != '0' || (text[1] != 'x' && text[1] != 'X') || !text[2])
		return false;
	for (text += 2; *text; text++) {
		if (!isxdigit((unsigned char)*text) || sum > UINT32_MAX)
			return false;
		sum = sum * 16 + (uint64_t)(isdigit((unsigned char)*text)
		                                    ? *text - '0'
		                                    : tolower((unsigned char)*text) - 'a' + 10);
	}
	*number = (double)sum;
	return true;
}

static bool parse_number(const char *text, enum ows_type type, double *number)
{
	int64_t value;

	if (value_parse(type, text, &value))
		return false;
	*number = value_number(type, value);
	return true;
}

static bool parse_kind(const struct option_def *def, const char *text, double *number)
{
	int type;

	switch (def->kind) {
	case OPTION_TEXT:
	case OPTION_BLOCK:
		return true;
	case OPTION_COUNT:
		return (parse_hex(text, number) || parse_number(text, OWS_LARGE, number)) &&
		       *number >= def->least && *number <= def->most;
	case OPTION_SECONDS:
	case OPTION_NUMBER:
		return parse_number(text, OWS_DOUBLE, number) && *number >= def->least &&
		       *number <= def->most;
	case OPTION_FLAG:
		return parse_number(text, OWS_BOOL, number);
	case OPTION_TYPE:
		type = value_type_parse(text);
		*number = type;
		return type >= 0;
	case OPTION_IO:
		*number = !strcmp(text, "output");
		return !strcmp(text, "output") || !strcmp(text, "input");
	}
	return false;
}

static void report_expected(const struct option_def *def, const struct rio_node *node,
                            struct config_report *report)
{
	switch (def->kind) {
	case OPTION_COUNT:
		if (def->most == UINT32_MAX)
			report_error(report, node->value_at,
			             "%s \"%s\": expected a whole number such as 0x0018", def->key,
			             node->value);
		else
			report_error(report, node->value_at,
			             "%s \"%s\": expected a whole number from %.0f to %.0f",
			             def->key, node->value, def->least, def->most);
		break;
	case OPTION_SECONDS:
		report_error(report, node->value_at,
		             "%s \"%s\": expected seconds from %.10g to %.10g", def->key,
		             node->value, def->least, def->most);
		break;
	case OPTION_NUMBER:
		report_error(report, node->value_at, "%s \"%s\": expected a number%s", def->key,
		             node->value, def->least < 0 ? "" : ", not negative");
		break;
	case OPTION_FLAG:
		report_error(report, node->value_at, "%s \"%s\": expected on or off", def->key,
		             node->value);
		break;
	case OPTION_TYPE:
		report_error(report, node->value_at,
		             "%s \"%s\": expected bool, byte, short, long, word, dword, float, "
		             "double, large or string",
		             def->key, node->value);
		break;
	case OPTION_IO:
		report_error(report, node->value_at, "%s \"%s\": expected input or output",
		             def->key, node->value);
		break;
	case OPTION_TEXT:
	case OPTION_BLOCK:
		break;
	}
}

static void read_one(const struct rio_node *node, const struct option_def *def,
                     struct option_value *value, struct config_report *report)
{
	double number = value->number;

	if (value->node && !def->repeats) {
		report_error(report, node->at, "%s is given twice, first in line %d", def->key,
		             value->node->at.line);
		return;
	}
	if (!value->node)
		value->node = node;
	if (node->broken && node->kind != RIO_BLOCK)
		return;
	if ((node->kind == RIO_BLOCK) != (def->kind == OPTION_BLOCK) || node->kind == RIO_LIST) {
		report_error(report, node->value_at, "%s: expected %s", def->key,
		             def->kind == OPTION_BLOCK ? "a block in { }" : "one value");
		if (def->kind == OPTION_BLOCK)
			value->node = NULL;
		return;
	}
	if (def->kind == OPTION_BLOCK)
		return;
	if (!parse_kind(def, node->value, &number)) {
		report_expected(def, node, report);
		return;
	}
	value->text = node->value;
	value->number = number;
	value->given = true;
}

void options_read(const struct rio_node *block, enum option_place place,
                  struct option_value *values, struct config_report *report)
{
	for (int i = 0; i < OPTION_COUNT_ALL; i++) {
		const struct option_def *def = &option_table[i];

		values[i] = (struct option_value){.text = ""};
		if (def->preset)
			parse_kind(def, def->preset, &values[i].number);
	}
	for (const struct rio_node *node = block->first; node; node = node->next) {
		int option = option_find(place, node->key);

		if (option >= 0)
			read_one(node, &option_table[option], &values[option], report);
		else if (*node->key)
			report_unknown(node, place, report);
	}
}
