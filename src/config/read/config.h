/* SPDX-License-Identifier: MIT */
/*
 * The configuration as the engine needs it: checked, with defaults filled in. Made from a .rio
 * document (rio.h) by config_load(). Immutable after that; all strings belong to it.
 *
 * Room src/config: the .rio file: read, checked, edited.
 */
#pragma once

#include <stdbool.h>
#include <stdio.h>

#include "src/config/read/listen.h"
#include "src/ground/signal/scale.h"
#include "src/public/ows.h"

enum config_limit {
	CONFIG_LIMIT_LL,
	CONFIG_LIMIT_L,
	CONFIG_LIMIT_H,
	CONFIG_LIMIT_HH,
	CONFIG_LIMITS,
};
/* Limit alarms of a signal; not of strings. */
struct config_limits {
	bool any; /* at least one limit is given: only then there are limit alarms */
	bool has[CONFIG_LIMITS];
	double limit[CONFIG_LIMITS]; /* rising, as far as given */
	double hysteresis;           /* not negative */
	int64_t on_delay_ns, off_delay_ns;
};

/*
 * When the history takes a value: at each occasion that is given. A change of quality and the first
 * value after a gap always are occasions, unless off.
 */
struct config_record {
	bool off;
	bool change;         /* each change of the value */
	bool raw;            /* and the raw value with it */
	double deadband;     /* a change that is greater; 0: not given */
	int64_t interval_ns; /* the newest value at each multiple of that time; 0: not given */
};

/* Where the value of a key stands in the file. */
struct config_spot {
	int line, column;
};

/*
 * A row of the file. What a family decides, config_know() fills in (src/config/check): family,
 * has_por, latch_stays, whole, converted with the scale and the symbol of the unit; read_back_ns
 * too where it is not given, or does nothing.
 */
struct config_item {
	/* What each reading asks for stands together: a large table is larger than the cache. */
	const char *path; /* normalised: leading "/", without "/uncached" and "/alarm" */
	enum ows_type type;
	uint32_t per_factor;
	bool output;
	bool readable, writable; /* start values of _ReadEnable and _WriteEnable */
	bool fresh;              /* Uncached, by flag or by path */
	bool has_por;            /* its device has a power-on flag, which is read too */
	bool restores;           /* and written again if it reads otherwise */
	bool alarm;
	int64_t read_back_ns;   /* outputs: how often it is read again; 0: never; -1: not given */
	int64_t stale_after_ns; /* 0: no limit */
	double filter_s, deadband, max_step; /* 0: none */
	struct scale scale;
	struct config_limits limits;

	const char *name;
	const char *identity;      /* what history and faces know the signal by; each has another */
	const char *identity_text; /* as written; NULL: identity is made of the path */
	const char *device;        /* the ROM id in path; NULL: an alias, or no device */
	const char *family;        /* what the chip is called, by its path; NULL: not known */
	bool has_init, has_safe, has_safe_delay;
	const char *start; /* "init" or "last" */
	bool starts_last;  /* outputs only */
	bool confirm;      /* pages ask a person once more before a set */
	int64_t safe_delay_ns;
	int64_t init_value, safe_value;    /* numbers, as in src/ground/signal/value.h */
	const char *init_text, *safe_text; /* as written; for strings the value itself */
	/* NULL: not defined, "": empty; Table 3.1 tells the two apart */
	const char *latch_alarm, *por_alarm, *set_alarm, *reset_latch;
	bool wrong;       /* has an error: so has the configuration */
	bool latch_stays; /* nothing of the item clears its latch */
	bool whole;       /* its property takes whole numbers only */
	bool converted;   /* scale is that from the unit of the chip to this one */
	/* of engineering values; NULL: not given. An empty unit is given too */
	const char *unit, *description, *group;
	const char *calibrated; /* "2026-11-22" */
	double factor, offset;  /* as written */
	const char *points;     /* as written */
	unsigned decimals;
	bool has_decimals;
	const char *record_text; /* as written; NULL: as the Recorder block says */
	struct config_record record;
	const char *device_class; /* "light", "door"; NULL: not given */
	int line;                 /* of Item */
	/* Where those keys stand; line 0: not given. */
	struct config_spot path_at, type_at, read_back_at, restore_at;
	struct config_spot latch_at, por_at, set_at, reset_at;
};
/* Does the item take sets? An input with Writable off never does, whatever its _WriteEnable. */
static inline bool config_item_takes_sets(const struct config_item *item)
{
	return item->output || item->writable;
}

/* How often an alarm item without PerFactor is read though no alarm came. */
#define CONFIG_ALARM_READ_NS (60 * INT64_C(1000000000))

enum config_relation {
	CONFIG_FIRST,
	CONFIG_COMMA, /* another wire */
	CONFIG_BAR,   /* another way to the wire of the target before it */
};
#define CONFIG_TARGETS_MAX 64
struct config_target {
	const char *text; /* "localhost:4304"; never empty */
	enum config_relation relation;
	unsigned group;   /* of the wire: counts the commas */
	bool automatic;   /* one of the ways of auto */
	int line, column; /* of TargetName's value; 0: not of the file */
};

/* One option of a Bus block, and where its value stands. */
struct config_option {
	const char *key, *text;
	uint64_t contents; /* a hash of the file that the text names; 0: it names none */
	int line, column;
};
struct config_bus {
	const char *target; /* as written */
	struct config_option *options;
	unsigned option_count;
	int line, column; /* of target */
};

/* The served owserver protocol. */
struct config_serve {
	struct listen_address addresses[LISTEN_MAX];
	unsigned address_count; /* 0: not served on the network */
	struct listen_peers peers[LISTEN_PEERS_MAX];
	unsigned peer_count; /* 0: every peer may connect; loopback always may */
	const char *socket;  /* path of a unix socket; NULL: none */
	bool read_only;
};

/* The Recorder block, for owsd-recorder; with the defaults where the file has none. */
struct config_recorder {
	bool given;
	const char *directory;                        /* NULL: the program's own */
	unsigned keep_days, keep_minutes, keep_hours; /* days; 0: no limit */
	unsigned size_mb;                             /* 0: no limit */
	int64_t flush_ns;
	const char *record_text; /* of signals without a Record of their own */
	struct config_record record;
};

/* The Influx block, for owsd-influx; the texts are NULL where the file has none. */
struct config_influx {
	bool given;
	const char *url; /* NULL only without the block, or with an error in it */
	const char *token_file, *measurement;
	int64_t every_ns, clock_wait_ns;
};

/* The Web block, for owsd-web; with the defaults where the file has none. */
struct config_web {
	bool given;
	struct listen_address addresses[LISTEN_MAX];
	unsigned address_count;
	const char *listen;           /* as written; NULL: at no address */
	const char *hosts;            /* a list with commas; NULL: none */
	const char *proxy;            /* a user or an address; NULL: none */
	const char *files;            /* NULL: the program's own */
	const char *others;           /* a list, as others.h has it; NULL: none */
	uint32_t proxy_uid;           /* if has_proxy: this machine knows the user */
	struct listen_peers proxy_at; /* one address; bits 0: it is a user, or none */
	bool has_proxy, write, configure;
};

/* A way to a broker. */
#define CONFIG_MQTT_WAYS 8
/* The profiles. src/faces/mqtt has a table of each, profile_NAME. */
#define MQTT_PROFILES(EACH) \
	EACH(homeassistant) \
	EACH(plain) \
	EACH(sparkplug) \
	EACH(homie5) \
	EACH(wirenboard)
#define MQTT_PROFILE_WORD(name) " " #name
struct config_mqtt_way {
	const char *host; /* a name or an address, without brackets */
	uint16_t port;
	bool tls;
};
/* The Mqtt block, for owsd-mqtt; with the defaults where the file has none. */
struct config_mqtt {
	bool given;
	const char *broker; /* as written */
	struct config_mqtt_way ways[CONFIG_MQTT_WAYS];
	unsigned way_count;
	const char *user, *password_file, *ca_file, *cert_file, *key_file; /* NULL: none */
	const char *node; /* NULL: the program's own */
	const char *protocol, *topic, *profile, *discovery;
	const char *primary_host, *link; /* NULL: none */
	bool mqtt5, write, rename, old_readers;
};

/* The Modbus block, for owsd-modbus; with the defaults where the file has none. */
#define CONFIG_MODBUS_CLIENTS 256
struct config_modbus {
	bool given;
	struct listen_address addresses[LISTEN_MAX];
	unsigned address_count;
	const char *listen; /* as written; NULL only without the block, or with an error in it */
	const char *word_order, *bad_value;
	const char *map, *allow; /* NULL: none */
	unsigned unit, decimals, clients;
	int64_t beat_ns;
	bool write;
};

/* The Notify block, for owsd-notify; the texts are NULL where the file has none. */
struct config_notify {
	bool given;
	const char *mail, *mail_from, *sendmail, *escalate_mail; /* addresses: with commas */
	const char *url, *fields, *token_file, *command, *link;
	const char *signals, *least, *quiet;
	int64_t bad_after_ns, gather_ns, every_ns, escalate_ns;
	bool returns, quiet_all;
	struct config_spot at;
};

/* A user or a group of ControlAllow. */
struct config_holder {
	bool group;
	uint32_t id;
};
/* An entry of ControlAllow: the users that may command the signals whose names fit the pattern. */
struct config_allow {
	const char *text; /* as written */
	const char *pattern;
	struct config_holder *holders; /* those that this machine knows */
	unsigned holder_count;
};

struct config {
	const char *file;
	struct config_target *targets;
	unsigned target_count;
	unsigned max_cons_alarms;
	unsigned max_retries;
	int64_t timeout_ns, period_ns, alarm_period_ns;
	const char *alarm_line, *heartbeat_line; /* NULL: none */
	struct config_spot alarm_line_at, heartbeat_line_at;
	struct config_bus *buses;
	unsigned bus_count;
	struct config_item *items;
	unsigned item_count;
	struct config_serve serve;
	struct config_allow *allows;
	unsigned allow_count;
	struct config_recorder recorder;
	struct config_influx influx;
	struct config_web web;
	struct config_mqtt mqtt;
	struct config_modbus modbus;
	struct config_notify notify;
};

/* Receives the errors and warnings; a message is a whole line ("house.rio:12:26: error: ..."). */
struct config_report {
	void (*line)(void *ctx, bool is_error, const char *message);
	/* The same in parts, in place of line; line and column 0: the file as a whole. */
	void (*problem)(void *ctx, bool is_error, int line, int column, const char *text);
	void *ctx;
	/*
	 * A configuration with errors is given all the same, without the items that have some: what
	 * else is wrong can be looked for in it, nothing else.
	 */
	bool keeps_wrong;
	unsigned errors, warnings;
	int at_line; /* of what is reported now; 0: of none; INT_MAX: after all others */
};
