/* SPDX-License-Identifier: MIT */
/* The lamps of owsd: the alarm output and the heartbeat, each a GPIO line, and their thread. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/time.h"
#include "hal/gpio/line.h"
#include "src/daemon/host/indicator.h"
#include "src/daemon/host/own_thread.h"
#include "src/memory/shm/futex.h"
#include "src/memory/shm/reader.h"
#include "src/public/ows.h"

#define FLASH (100 * NS_PER_MS)
#define LOOK_NS (250 * NS_PER_MS) /* at the image, for alarms */
#define AGAIN_NS (5 * NS_PER_S)
#define STACK (64 * 1024)

struct lamp {
	const char *key; /* NULL: not configured */
	struct gpio_output output;
	bool reported;    /* that the line cannot be used */
	int64_t again_ns; /* when to take the line, or to set it again as a check */
	int lit;          /* as set; -1: unknown */
};

enum indicator_health {
	INDICATOR_DEAD,  /* the engine's heart does not beat: the lamp is dark */
	INDICATOR_ALONE, /* the heart beats, but no target is up: a flash every two seconds */
	INDICATOR_WELL,  /* the heart beats, a target is up: on and off for half a second each */
};

struct indicator {
	const struct image *image;
	struct log *log;
	int64_t period_ns, look_ns;
	bool alarm;
	struct lamp alarm_lamp, heartbeat_lamp;
	struct own_thread thread;
};

/* Does the alarm of any signal stand, or wait for its acknowledgement? */
static bool indicator_alarm(const struct image *image)
{
	for (uint32_t i = 1; i < image->record_count; i++) {
		const struct ows_record *record = &image->records[i];
		struct ows_slot slot;

		if (reader_slot(record, &slot) && (slot.attrs.limit_state != OWS_LIMIT_NORMAL ||
		                                   slot.sample.quality == OWS_Q_DIFFERS ||
		                                   (slot.attrs.flags & OWS_ATTR_ALARM_STANDS)))
			return true;
	}
	return false;
}

static enum indicator_health indicator_health(const struct image *image, int64_t period_ns,
                                              int64_t now_ns)
{
	int64_t patience_ns = 2 * period_ns + NS_PER_S;
	struct ows_sample beat;

	if (!reader_sample(&image->records[0], &beat) || now_ns - beat.measured_ns > patience_ns ||
	    beat.measured_ns - now_ns > patience_ns)
		return INDICATOR_DEAD;
	for (uint32_t i = 0; i < image->target_count; i++)
		if (__atomic_load_n(&image->targets[i].state, __ATOMIC_RELAXED) == 1)
			return INDICATOR_WELL;
	return INDICATOR_ALONE;
}

/* Is the heartbeat lamp on at now_ns? next_ns: the time after that at which it may change. */
static bool indicator_lit(enum indicator_health health, int64_t now_ns, int64_t *next_ns)
{
	static const struct {
		int64_t round_ns, lit_ns; /* on at the begin of each round */
	} rhythms[] = {
		[INDICATOR_ALONE] = {2 * NS_PER_S, FLASH},
		[INDICATOR_WELL] = {NS_PER_S, NS_PER_S / 2},
	};
	int64_t round_ns = rhythms[health].round_ns, lit_ns = rhythms[health].lit_ns;
	bool lit = round_ns && now_ns % round_ns < lit_ns;

	*next_ns = now_ns + LOOK_NS;
	if (round_ns)
		*next_ns = now_ns - now_ns % round_ns + (lit ? lit_ns : round_ns);
	return lit;
}

static void lose_lamp(struct indicator *indicator, struct lamp *lamp, const char *why)
{
	gpio_output_release(&lamp->output);
	lamp->lit = -1;
	if (!lamp->reported)
		log_warning(indicator->log, "%s: %s", lamp->key, why);
	lamp->reported = true;
}

static void set_lamp(struct indicator *indicator, struct lamp *lamp, bool lit, int64_t now_ns)
{
	char why[160];
	int err;

	if (!lamp->key || ((lamp->lit == lit || !lamp->output.line) && now_ns < lamp->again_ns))
		return;
	lamp->again_ns = now_ns + AGAIN_NS;
	if (!lamp->output.line) {
		err = gpio_output_take(&lamp->output, lit, why, sizeof(why));
		if (!err && lamp->reported)
			log_notice(indicator->log, "%s: works again", lamp->key);
		if (!err)
			lamp->reported = false;
	} else {
		err = gpio_output_set(&lamp->output, lit);
		if (err)
			snprintf(why, sizeof(why), "%s", strerror(-err));
	}
	if (err)
		lose_lamp(indicator, lamp, why);
	else
		lamp->lit = lit;
}

int64_t indicator_step(struct indicator *indicator, int64_t now_ns)
{
	enum indicator_health health = indicator_health(indicator->image, indicator->period_ns,
	                                                now_ns);
	int64_t next_ns;
	bool lit = indicator_lit(health, now_ns, &next_ns);

	if (indicator->alarm_lamp.key && now_ns >= indicator->look_ns) {
		indicator->look_ns = now_ns + LOOK_NS;
		indicator->alarm = indicator_alarm(indicator->image);
	}
	set_lamp(indicator, &indicator->alarm_lamp, indicator->alarm, now_ns);
	set_lamp(indicator, &indicator->heartbeat_lamp, lit, now_ns);
	return indicator->alarm_lamp.key ? earlier_ns(next_ns, indicator->look_ns) : next_ns;
}

static int lamp_create(struct lamp *lamp, const char *key, const char *text, struct log *log)
{
	char why[160];
	int err;

	lamp->lit = -1;
	if (!text)
		return 0;
	err = gpio_spec_parse(text, &lamp->output.spec, why, sizeof(why));
	if (err)
		log_err(log, "%s: %s", key, why);
	else
		lamp->key = key;
	return err;
}

int indicator_create(const struct config *config, const struct image *image, struct log *log,
                     struct indicator **out)
{
	struct indicator *indicator;
	int err;

	*out = NULL;
	if (!config->alarm_line && !config->heartbeat_line)
		return 0;
	indicator = calloc(1, sizeof(*indicator));
	if (!indicator)
		return -ENOMEM;
	indicator->image = image;
	indicator->log = log;
	indicator->period_ns = config->period_ns;
	err = lamp_create(&indicator->alarm_lamp, "AlarmLine", config->alarm_line, log);
	if (!err)
		err = lamp_create(&indicator->heartbeat_lamp, "HeartbeatLine",
		                  config->heartbeat_line, log);
	if (err) {
		free(indicator);
		return -EINVAL;
	}
	*out = indicator;
	return 0;
}

void indicator_destroy(struct indicator *indicator)
{
	if (!indicator)
		return;
	if (indicator->heartbeat_lamp.output.line)
		gpio_output_set(&indicator->heartbeat_lamp.output, false);
	gpio_output_release(&indicator->heartbeat_lamp.output);
	gpio_output_release(&indicator->alarm_lamp.output);
	free(indicator);
}

static void *indicator_main(void *ctx)
{
	struct indicator *indicator = ctx;

	while (!own_thread_stops(&indicator->thread)) {
		int64_t next_ns = indicator_step(indicator, ows_now());
		int64_t left_ns = next_ns - ows_now();

		if (left_ns > 0)
			segment_wait(&indicator->thread.stop, 0, left_ns);
	}
	own_thread_ends(&indicator->thread);
	return NULL;
}

int indicator_start(struct indicator *indicator)
{
	return indicator ? own_thread_start(&indicator->thread, "owsd-lamps", STACK, indicator_main,
	                                    indicator)
	                 : 0;
}

bool indicator_stop(struct indicator *indicator, int64_t timeout_ns)
{
	return !indicator || own_thread_stop(&indicator->thread, NULL, timeout_ns);
}
