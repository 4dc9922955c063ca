/* SPDX-License-Identifier: MIT */
/*
 * The configuration as owsd understood it, printed as a file that owsd would read again: each value
 * in force is there, also where it is the default.
 */
#include <stdarg.h>
#include <stdlib.h>

#include "src/config/edit/print.h"
#include "src/config/edit/rio_write.h"
#include "src/config/read/limits.h"
#include "src/ground/signal/value.h"

/* The key, indented by the depth of its block. */
static void put_key(FILE *out, enum option_place place, const char *key)
{
	fprintf(out, "%*s%-*s ", place == PLACE_DRIVER ? 2 : 4, "", RIO_KEY_WIDTH - 1, key);
}

static void put_plain(FILE *out, enum option_place place, const char *key, const char *text)
{
	char *quoted = rio_quote(text);

	put_key(out, place, key);
	fprintf(out, "%s\n", quoted ? quoted : "\"\"");
	free(quoted);
}

/* Nothing is printed where there is no text. */
static void put_text(FILE *out, enum option option, const char *text)
{
	if (text)
		put_plain(out, option_table[option].place, option_table[option].key, text);
}

static void put_word(FILE *out, enum option option, const char *format, ...)
	__attribute__((format(printf, 3, 4)));
static void put_word(FILE *out, enum option option, const char *format, ...)
{
	va_list args;

	put_key(out, option_table[option].place, option_table[option].key);
	va_start(args, format);
	vfprintf(out, format, args);
	va_end(args);
	fputc('\n', out);
}

static void put_flag(FILE *out, enum option option, bool flag)
{
	put_word(out, option, "%s", flag ? "on" : "off");
}

static void put_number(FILE *out, enum option option, double number)
{
	char text[VALUE_TEXT_MAX];

	value_to_text(OWS_DOUBLE, value_of_double(number), text);
	put_word(out, option, "%s", text);
}

static void put_seconds(FILE *out, enum option option, int64_t ns)
{
	put_number(out, option, (double)ns / 1e9);
}

static void put_limits(FILE *out, const struct config_limits *limits)
{
	for (int i = CONFIG_LIMITS - 1; i >= 0; i--)
		if (limits->has[i])
			put_number(out, limit_options[i], limits->limit[i]);
	if (!limits->any)
		return;
	put_number(out, OPT_HYSTERESIS, limits->hysteresis);
	put_seconds(out, OPT_ON_DELAY, limits->on_delay_ns);
	put_seconds(out, OPT_OFF_DELAY, limits->off_delay_ns);
}

static void put_scaling(FILE *out, const struct config_item *item)
{
	const struct scale *scale = &item->scale;

	put_text(out, OPT_UNIT, item->unit);
	if (item->decimals >= 0)
		put_word(out, OPT_DECIMALS, "%d", item->decimals);
	put_text(out, OPT_DESCRIPTION, item->description);
	if (scale->linear && !item->converted) {
		put_number(out, OPT_SCALE, scale->factor);
		put_number(out, OPT_OFFSET, scale->offset);
	}
	put_text(out, OPT_POINTS, item->points);
	if (scale->has_min)
		put_number(out, OPT_MIN, scale->min);
	if (scale->has_max)
		put_number(out, OPT_MAX, scale->max);
	if (item->max_step > 0)
		put_number(out, OPT_MAX_STEP, item->max_step);
	if (item->filter_s > 0)
		put_number(out, OPT_FILTER, item->filter_s);
	if (item->deadband > 0)
		put_number(out, OPT_DEADBAND, item->deadband);
	put_text(out, OPT_CALIBRATED, item->calibrated);
}

static void put_targets(FILE *out, const struct config *config)
{
	static const char *const relations[] = {
		[CONFIG_FIRST] = "",
		[CONFIG_COMMA] = ", ",
		[CONFIG_BAR] = " | ",
	};

	put_key(out, PLACE_DRIVER, option_table[OPT_TARGET_NAME].key);
	putc('"', out);
	for (unsigned i = 0; i < config->target_count; i++) {
		fputs(relations[config->targets[i].relation], out);
		for (const char *p = config->targets[i].text; *p; p++) {
			if (*p == '"' || *p == '\\')
				fputc('\\', out);
			fputc(*p, out);
		}
	}
	fputs("\"\n", out);
}

static void put_bus(FILE *out, const struct config_bus *bus)
{
	fprintf(out, "  %s {\n", option_table[OPT_BUS].key);
	put_text(out, OPT_BUS_TARGET, bus->target);
	for (unsigned i = 0; i < bus->option_count; i++)
		put_plain(out, PLACE_BUS, bus->options[i].key, bus->options[i].text);
	fputs("  }\n", out);
}

static void put_recorder(FILE *out, const struct config_recorder *recorder)
{
	if (!recorder->given)
		return;
	fprintf(out, "  %s {\n", option_table[OPT_RECORDER].key);
	put_text(out, OPT_RECORDER_DIRECTORY, recorder->directory);
	put_word(out, OPT_RECORDER_KEEP, "%u", recorder->keep_days);
	put_word(out, OPT_RECORDER_KEEP_MINUTES, "%u", recorder->keep_minutes);
	put_word(out, OPT_RECORDER_KEEP_HOURS, "%u", recorder->keep_hours);
	put_word(out, OPT_RECORDER_SIZE, "%u", recorder->size_mb);
	put_seconds(out, OPT_RECORDER_FLUSH, recorder->flush_ns);
	put_text(out, OPT_RECORDER_RECORD, recorder->record_text);
	fputs("  }\n", out);
}

static void put_influx(FILE *out, const struct config_influx *influx)
{
	if (!influx->given)
		return;
	fprintf(out, "  %s {\n", option_table[OPT_INFLUX].key);
	put_text(out, OPT_INFLUX_URL, influx->url);
	put_seconds(out, OPT_INFLUX_EVERY, influx->every_ns);
	put_text(out, OPT_INFLUX_TOKEN_FILE, influx->token_file);
	put_text(out, OPT_INFLUX_MEASUREMENT, influx->measurement);
	put_text(out, OPT_INFLUX_SPOOL, influx->spool);
	put_word(out, OPT_INFLUX_SPOOL_SIZE, "%u", influx->spool_mb);
	put_seconds(out, OPT_INFLUX_CLOCK_WAIT, influx->clock_wait_ns);
	fputs("  }\n", out);
}

static void put_mqtt(FILE *out, const struct config_mqtt *mqtt)
{
	if (!mqtt->given)
		return;
	fprintf(out, "  %s {\n", option_table[OPT_MQTT].key);
	put_text(out, OPT_MQTT_BROKER, mqtt->broker);
	put_text(out, OPT_MQTT_USER, mqtt->user);
	put_text(out, OPT_MQTT_PASSWORD_FILE, mqtt->password_file);
	put_text(out, OPT_MQTT_CA_FILE, mqtt->ca_file);
	put_text(out, OPT_MQTT_CERT_FILE, mqtt->cert_file);
	put_text(out, OPT_MQTT_KEY_FILE, mqtt->key_file);
	put_text(out, OPT_MQTT_PROTOCOL, mqtt->mqtt5 ? "5" : "3.1.1");
	put_text(out, OPT_MQTT_NODE, mqtt->node);
	put_text(out, OPT_MQTT_TOPIC, mqtt->topic);
	put_text(out, OPT_MQTT_PROFILE, mqtt->profile);
	put_text(out, OPT_MQTT_DISCOVERY, mqtt->discovery);
	put_text(out, OPT_MQTT_PRIMARY_HOST, mqtt->primary_host);
	put_flag(out, OPT_MQTT_WRITE, mqtt->write);
	fputs("  }\n", out);
}

static void put_web(FILE *out, const struct config_web *web)
{
	if (!web->given)
		return;
	fprintf(out, "  %s {\n", option_table[OPT_WEB].key);
	put_text(out, OPT_WEB_LISTEN, web->listen);
	put_text(out, OPT_WEB_HOSTS, web->hosts);
	put_flag(out, OPT_WEB_WRITE, web->write);
	put_flag(out, OPT_WEB_CONFIGURE, web->configure);
	put_text(out, OPT_WEB_PROXY, web->proxy);
	put_text(out, OPT_WEB_FILES, web->files);
	fputs("  }\n", out);
}

/* Entry i of a list: the key stands before the first one, and after the last one the line ends. */
static void put_entry(FILE *out, enum option option, unsigned i, unsigned count, const char *text)
{
	if (i == 0)
		put_key(out, option_table[option].place, option_table[option].key);
	fprintf(out, "%s%s%s", i ? ", " : "\"", text, i + 1 == count ? "\"\n" : "");
}

static void put_serve(FILE *out, const struct config_serve *serve)
{
	char text[LISTEN_TEXT_MAX];

	if (!serve->address_count && !serve->socket)
		return;
	for (unsigned i = 0; i < serve->address_count; i++) {
		listen_print(&serve->addresses[i], text);
		put_entry(out, OPT_LISTEN, i, serve->address_count, text);
	}
	put_text(out, OPT_LISTEN_SOCKET, serve->socket);
	for (unsigned i = 0; i < serve->peer_count; i++) {
		listen_peers_print(&serve->peers[i], text);
		put_entry(out, OPT_LISTEN_ALLOW, i, serve->peer_count, text);
	}
	put_flag(out, OPT_LISTEN_READ_ONLY, serve->read_only);
}

/* A part of an alarm; with `all` it is said that it is not defined. */
static void put_alarm(FILE *out, enum option option, const char *text, bool all)
{
	if (text)
		put_text(out, option, text);
	else if (all)
		fprintf(out, "    # %-*s not defined\n", RIO_KEY_WIDTH - 3,
		        option_table[option].key);
}

void config_print_item(const struct config_item *item, bool all, FILE *out)
{
	fprintf(out, "  %s {\n", option_table[OPT_ITEM].key);
	put_text(out, OPT_NAME, item->name);
	put_text(out, OPT_PATH, item->path);
	put_word(out, OPT_TYPE, "%s", value_type_name(item->type));
	put_word(out, OPT_IO, "%s", item->output ? "output" : "input");
	put_flag(out, OPT_READABLE, item->readable);
	put_flag(out, OPT_WRITABLE, item->writable);
	put_flag(out, OPT_UNCACHED, item->fresh);
	put_text(out, OPT_INIT_VALUE, item->init_text);
	if (item->has_safe)
		put_text(out, OPT_SAFE_VALUE, item->safe_text);
	if (item->has_safe_delay)
		put_seconds(out, OPT_SAFE_DELAY, item->safe_delay_ns);
	if (item->starts_last)
		put_text(out, OPT_START, "last");
	if (item->confirm)
		put_flag(out, OPT_CONFIRM, true);
	if (item->output)
		put_seconds(out, OPT_READ_BACK, item->read_back_ns);
	if (item->restores)
		put_flag(out, OPT_RESTORE, true);
	put_word(out, OPT_PER_FACTOR, "%u", (unsigned)item->per_factor);
	put_seconds(out, OPT_STALE_AFTER, item->stale_after_ns);
	put_flag(out, OPT_ALARM, item->alarm);
	put_alarm(out, OPT_LATCH_ALARM, item->latch_alarm, all);
	put_alarm(out, OPT_POR_ALARM, item->por_alarm, all);
	put_alarm(out, OPT_SET_ALARM, item->set_alarm, all);
	put_alarm(out, OPT_RESET_LATCH, item->reset_latch, all);
	put_limits(out, &item->limits);
	put_scaling(out, item);
	put_text(out, OPT_RECORD, item->record_text);
	put_text(out, OPT_CLASS, item->device_class);
	fputs("  }\n", out);
}

void config_print(const struct config *config, FILE *out)
{
	fputs("OwsDrv {\n", out);
	put_word(out, OPT_VERSION, "%s", option_table[OPT_VERSION].preset);
	put_targets(out, config);
	put_word(out, OPT_MAX_CONS_ALARMS, "%u", config->max_cons_alarms);
	put_word(out, OPT_MAX_RETRIES, "%u", config->max_retries);
	put_seconds(out, OPT_TIMEOUT, config->timeout_ns);
	put_seconds(out, OPT_PERIOD, config->period_ns);
	put_seconds(out, OPT_ALARM_PERIOD, config->alarm_period_ns);
	put_serve(out, &config->serve);
	for (unsigned i = 0; i < config->allow_count; i++)
		put_text(out, OPT_CONTROL_ALLOW, config->allows[i].text);
	put_text(out, OPT_ALARM_LINE, config->alarm_line);
	put_text(out, OPT_HEARTBEAT_LINE, config->heartbeat_line);
	for (unsigned i = 0; i < config->bus_count; i++)
		put_bus(out, &config->buses[i]);
	put_recorder(out, &config->recorder);
	put_influx(out, &config->influx);
	put_web(out, &config->web);
	put_mqtt(out, &config->mqtt);
	put_word(out, OPT_ITEM_COUNT, "%u", config->item_count);
	for (unsigned i = 0; i < config->item_count; i++)
		config_print_item(&config->items[i], false, out);
	fputs("}\n", out);
}
