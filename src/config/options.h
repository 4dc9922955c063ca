/* SPDX-License-Identifier: MIT */
/*
 * All keys of the configuration in one table: the reader takes types, limits and defaults from it,
 * owsd --check and the edits their order, and a test lays the manual page beside it.
 */
#pragma once

#include "src/config/arena.h"
#include "src/config/config.h"
#include "src/config/rio.h"

enum option_place {
	PLACE_DRIVER,
	PLACE_ITEM,
	PLACE_BUS,
	PLACE_RECORDER,
	PLACE_INFLUX,
	PLACE_WEB,
	PLACE_MQTT,
};

enum option_kind {
	OPTION_TEXT,
	OPTION_COUNT,   /* whole number, decimal or 0x hexadecimal */
	OPTION_SECONDS, /* decimal */
	OPTION_NUMBER,  /* decimal, not less than least */
	OPTION_FLAG,    /* on, off */
	OPTION_TYPE,    /* a name of value_type_name() */
	OPTION_IO,      /* input, output */
	OPTION_BLOCK,
};

enum option {
	OPT_VERSION,
	OPT_TARGET_NAME,
	OPT_MAX_CONS_ALARMS,
	OPT_MAX_REQUESTS,
	OPT_MAX_RETRIES,
	OPT_TIMEOUT,
	OPT_PERIOD,
	OPT_ALARM_PERIOD,
	OPT_LISTEN,
	OPT_LISTEN_SOCKET,
	OPT_LISTEN_ALLOW,
	OPT_LISTEN_READ_ONLY,
	OPT_CONTROL_ALLOW,
	OPT_ITEM_COUNT,
	OPT_ALARM_LINE,
	OPT_HEARTBEAT_LINE,
	OPT_BUS,
	OPT_RECORDER,
	OPT_INFLUX,
	OPT_WEB,
	OPT_MQTT,
	OPT_ITEM,
	/* of an item */
	OPT_NAME,
	OPT_PATH,
	OPT_IO_TYPE,
	OPT_TYPE,
	OPT_IO,
	OPT_READABLE,
	OPT_WRITABLE,
	OPT_UNCACHED,
	OPT_INIT_VALUE,
	OPT_SAFE_VALUE,
	OPT_SAFE_DELAY,
	OPT_START,
	OPT_CONFIRM,
	OPT_READ_BACK,
	OPT_RESTORE,
	OPT_PER_FACTOR,
	OPT_STALE_AFTER,
	OPT_ALARM,
	OPT_LATCH_ALARM,
	OPT_POR_ALARM,
	OPT_SET_ALARM,
	OPT_RESET_LATCH,
	OPT_LIMIT_HH,
	OPT_LIMIT_H,
	OPT_LIMIT_L,
	OPT_LIMIT_LL,
	OPT_HYSTERESIS,
	OPT_ON_DELAY,
	OPT_OFF_DELAY,
	OPT_UNIT,
	OPT_DECIMALS,
	OPT_DESCRIPTION,
	OPT_SCALE,
	OPT_OFFSET,
	OPT_POINTS,
	OPT_MIN,
	OPT_MAX,
	OPT_FILTER,
	OPT_DEADBAND,
	OPT_CALIBRATED,
	OPT_RECORD,
	OPT_CLASS,
	/* of a Bus block */
	OPT_BUS_TARGET,
	OPT_BUS_POWER_LINE,
	OPT_BUS_POWER_OFF_MS,
	OPT_BUS_SLEEP_LINE,
	OPT_BUS_SENSORS,
	OPT_BUS_ACTIVE_LOW,
	OPT_BUS_PULL_UP,
	OPT_BUS_PULL_DOWN,
	OPT_BUS_OPEN_DRAIN,
	OPT_BUS_OPEN_SOURCE,
	OPT_BUS_TOUCH,
	/* of the Recorder block */
	OPT_RECORDER_DIRECTORY,
	OPT_RECORDER_KEEP,
	OPT_RECORDER_KEEP_MINUTES,
	OPT_RECORDER_KEEP_HOURS,
	OPT_RECORDER_SIZE,
	OPT_RECORDER_FLUSH,
	OPT_RECORDER_RECORD,
	/* of the Influx block */
	OPT_INFLUX_URL,
	OPT_INFLUX_EVERY,
	OPT_INFLUX_TOKEN_FILE,
	OPT_INFLUX_MEASUREMENT,
	OPT_INFLUX_SPOOL,
	OPT_INFLUX_SPOOL_SIZE,
	OPT_INFLUX_CLOCK_WAIT,
	/* of the Web block */
	OPT_WEB_LISTEN,
	OPT_WEB_HOSTS,
	OPT_WEB_WRITE,
	OPT_WEB_CONFIGURE,
	OPT_WEB_PROXY,
	OPT_WEB_FILES,
	/* of the Mqtt block */
	OPT_MQTT_BROKER,
	OPT_MQTT_USER,
	OPT_MQTT_PASSWORD_FILE,
	OPT_MQTT_CA_FILE,
	OPT_MQTT_CERT_FILE,
	OPT_MQTT_KEY_FILE,
	OPT_MQTT_PROTOCOL,
	OPT_MQTT_NODE,
	OPT_MQTT_TOPIC,
	OPT_MQTT_PROFILE,
	OPT_MQTT_DISCOVERY,
	OPT_MQTT_PRIMARY_HOST,
	OPT_MQTT_WRITE,
	OPTION_COUNT_ALL,
};

struct option_def {
	const char *key;
	enum option_place place;
	enum option_kind kind;
	bool repeats;       /* may stand more than once */
	double least, most; /* counts, seconds and numbers */
	const char *preset; /* the default as it would be written; NULL: none */
	const char *help;   /* one line */
};
extern const struct option_def option_table[OPTION_COUNT_ALL];

/* The option of that key, -1 if there is none. */
int option_find(enum option_place place, const char *key);
/*
 * Write the nearest known keys of the place, "LimitH or LimitHH" where several are as near, into
 * text. Returns text; NULL if none is near.
 */
#define OPTION_NEAREST 200
const char *option_nearest(enum option_place place, const char *key, char text[OPTION_NEAREST]);

/* A key of a block as the reader found it. */
struct option_value {
	const struct rio_node *node; /* NULL: absent */
	bool given;                  /* present and valid; if not, number is the default */
	const char *text;            /* "" if not given */
	double number; /* counts, seconds, numbers, flags (0, 1), types, IO (1: output) */
};
/* Of seconds. */
static inline int64_t option_ns(const struct option_value *value)
{
	return (int64_t)(value->number * 1e9 + 0.5);
}

/*
 * Check the keys of a block against the table and put the values into values, which has
 * OPTION_COUNT_ALL entries: unknown keys warn; keys that stand twice and values that cannot be
 * are errors.
 */
void options_read(const struct rio_node *block, enum option_place place,
                  struct option_value *values, struct config_report *report);
