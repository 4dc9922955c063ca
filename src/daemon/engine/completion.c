/* SPDX-License-Identifier: MIT */
/* What the end of a read or a write does to its signal: value, quality, retry, log. */
#include <errno.h>
#include <string.h>

#include "src/daemon/engine/alarm/alarm_item.h"
#include "src/daemon/engine/command/in_force.h"
#include "src/daemon/engine/command/read_back.h"
#include "src/daemon/engine/completion.h"
#include "src/daemon/engine/device_facts.h"
#include "src/daemon/engine/presence.h"
#include "src/daemon/engine/retry.h"
#include "src/daemon/engine/routing/known.h"
#include "src/daemon/engine/scaling.h"
#include "src/daemon/engine/schedule.h"
#include "src/ground/signal/error.h"
#include "src/ground/signal/value.h"
#include "src/ground/text/log.h"

/* "no such property: check its spelling", "device error: wrong checksum"; what says all, once. */
static void report_failed(struct engine *e, const struct signal *s, const char *what, int err,
                          uint8_t quality)
{
	const char *text = ows_quality_text(quality);
	char words[ERROR_WORDS];

	if (strcmp(text, error_text(err)) == 0)
		text = "";
	log_warning(e->log, "%s (%s): %s%s%s%s", s->item->name, s->item->path, what, text,
	            *text && err ? ": " : "", err ? error_words(err, words) : "");
}

/*
 * Is nothing good of the device any more, or is something not known yet? A target that has a device
 * only by its own word is to hold its signals no longer than until another one has it too.
 */
static bool gives_nothing(const struct engine *e, const struct signal *failed)
{
	const struct device *d = &e->table.devices[failed->device];

	for (uint32_t i = 0; i < d->count; i++) {
		const struct signal *s = d->signals[i];

		if (signal_is_read(s) && s->read.retry.failures <= e->config->max_retries)
			return false;
	}
	return true;
}

/* Does the error say no more than what is known, by the signals of the device or by its bus? */
static bool is_known_absent(const struct engine *e, const struct signal *s, int err)
{
	return err == -ENODEV && signal_has_device(s) && e->table.devices[s->device].absent;
}

/* How many failed reads the signal forgives: none where asking again would say no more. */
static unsigned retries_of(const struct engine *e, const struct signal *s, int err)
{
	return failure_is_verdict(err) || is_known_absent(e, s, err) ? 0 : e->config->max_retries;
}

/* A device that stays absent is one fault, however often it is looked for. */
static void count_failure(struct engine *e, struct lane *lane, const struct signal *s, int err)
{
	if (is_known_absent(e, s, err) || (err == -ENODEV && s->sample.quality == OWS_Q_NO_DEVICE))
		return;
	lane->counters.item_errors++;
	engine_facts_failed(e, s);
}

/*
 * Of a read: a fault of a device may end at any time, which is to be seen soon, if asking costs
 * little: a verdict costs what a value does, and the first ones are asked for again as after any
 * error, for another target may know better. A write has its full back-off: a memory may wear with
 * each.
 */
static int64_t back_off(const struct lane *lane, const struct signal *s, int err, int64_t wait_ns)
{
	if (failure_is_verdict(err) && s->read.retry.failures <= lane->engine->config->max_retries)
		return 0;
	uint8_t quality = failure_quality(err);
	bool ends = quality != OWS_Q_NO_PROPERTY && quality != OWS_Q_TYPE &&
	            quality != OWS_Q_ACCESS;
	bool brief = failure_is_verdict(err) || (lane->port->brief && ends);

	return brief && wait_ns > RETRY_FIRST_NS ? RETRY_FIRST_NS : wait_ns;
}

int64_t engine_read_failed(struct engine *e, struct lane *lane, struct signal *s, int err)
{
	uint8_t quality = failure_quality(err);
	int64_t wait_ns;

	count_failure(e, lane, s, err);
	s->sample.err = err;
	if (!retry_fail(&s->read.retry, retries_of(e, s, err), &wait_ns))
		return 0;
	if (err == -ENODEV && signal_has_device(s))
		engine_device_lost(lane, s->device);
	else if (signal_has_device(s) && gives_nothing(e, s))
		engine_presence(e, lane, s->device, ROUTE_FAILING);
	if (s->sample.quality != quality) {
		s->sample.quality = quality;
		report_failed(e, s, "", err, quality);
	}
	return back_off(lane, s, err, wait_ns);
}

/*
 * Of a write. It says nothing of a value that is read. A verdict forbids no write: the next may go
 * through.
 */
static int64_t fail_write(struct engine *e, struct lane *lane, struct signal *s, int err)
{
	uint8_t quality = failure_quality(err);
	int64_t wait_ns;

	unsigned max_retries = is_known_absent(e, s, err) ? 0 : e->config->max_retries;
	bool failed = s->command.retry.doublings;

	count_failure(e, lane, s, err);
	s->command.err = err;
	if (!retry_fail(&s->command.retry, max_retries, &wait_ns))
		return 0;
	if (!failed)
		report_failed(e, s, "cannot be written: ", err, quality);
	if (!signal_reads(s))
		s->sample.quality = quality;
	if (err == -ENODEV && signal_has_device(s))
		engine_device_lost(lane, s->device);
	return wait_ns;
}

/* A good reading proves that the device is there; that a write was taken only claims it. */
static void request_succeeded(struct engine *e, struct lane *lane, struct signal *s,
                              uint8_t quality, bool proven)
{
	struct device *d = !signal_has_device(s) ? NULL : &e->table.devices[s->device];

	if (!ows_good(s->sample.quality) && s->sample.quality != OWS_Q_INITIAL &&
	    s->sample.quality != OWS_Q_LAST_USABLE && s->sample.quality != OWS_Q_DIFFERS &&
	    ows_good(quality))
		log_info(e->log, "%s (%s): good again", s->item->name, s->item->path);
	s->sample.quality = quality;
	s->sample.err = 0;
	s->read.held = false;
	s->sample.target = (uint8_t)lane->index;
	engine_facts_good(e, s);
	if (proven)
		engine_presence(e, lane, s->device, ROUTE_PRESENT);
	else
		engine_presence_claimed(e, lane, s->device);
	if (d && d->absent && s->shows_device)
		engine_device_back(lane, d);
}

/*
 * An answer that was on its way while the engine did not run may be measured long before it came,
 * and its bus could not know: then it is as old as its request.
 */
static int64_t time_of_reading(const struct engine *e, const struct slot *slot,
                               const struct bus_answer *answer)
{
	int64_t measured_ns = answer->measured_ns ? answer->measured_ns : e->time.now_ns;

	return slot->begun_ns < e->time.gap_ns && slot->begun_ns < measured_ns ? slot->begun_ns
	                                                                       : measured_ns;
}

/* The value of an answer into the sample; 0, or why it cannot be one. */
static int value_of_answer(struct signal *s, const struct slot *slot,
                           const struct bus_answer *answer, int64_t measured_ns, uint8_t *quality)
{
	enum ows_type type = signal_raw_type(s);
	int64_t raw;
	int err;

	if (answer->err)
		return answer->err;
	if (signal_is_string(s)) {
		uint32_t len = answer->len < TABLE_TEXT_CAP ? answer->len : TABLE_TEXT_CAP;

		*quality = answer->len > TABLE_TEXT_CAP ? OWS_Q_CUT : OWS_Q_GOOD;
		memcpy(s->text, slot->data, len);
		s->sample.len = len;
		return 0;
	}
	if (answer->kind == BUS_NUMBER)
		err = value_from_number(type, answer->number, &raw, quality);
	else
		err = value_from_text(type, (const char *)slot->data, answer->len, &raw, quality);
	if (!err)
		err = signal_scale_raw(s, raw, measured_ns, quality);
	return err;
}

/* A reading jumped. The device has answered: nothing backs off, and no fault of it counts. */
static void hold_back(struct engine *e, struct lane *lane, struct signal *s)
{
	struct ows_sample *sample = &s->sample;
	char others[LOG_OTHERS];
	int64_t none;
	uint64_t n;

	lane->counters.held_back++;
	/* the first value of all is held back too, and is no jump */
	n = s->scaling.step.begun ? log_rate(&e->held_back, e->time.now_ns) : 0;
	if (n)
		log_notice(e->log, "%s (%s): %g after %g jumps beyond MaxStep: it is held back%s",
		           s->item->name, s->item->path, s->scaling.step.doubt,
		           s->scaling.step.good, log_others(n, others));
	sample->err = -EREMCHG;
	if (retry_fail(&s->read.retry, e->config->max_retries, &none) &&
	    sample->quality != OWS_Q_INITIAL &&
	    (ows_good(sample->quality) || sample->quality < OWS_Q_LAST_USABLE))
		sample->quality = OWS_Q_LAST_USABLE;
	s->read.retry.doublings = 0; /* a fault of the device that follows is its first */
}

int engine_apply_reading(struct engine *e, struct lane *lane, struct signal *s,
                         const struct slot *slot, const struct bus_answer *answer, int64_t *wait_ns)
{
	int64_t value = s->sample.value, raw = s->attrs.raw;
	int64_t measured_ns = time_of_reading(e, slot, answer);
	uint8_t quality = OWS_Q_GOOD;
	int err = value_of_answer(s, slot, answer, measured_ns, &quality);

	*wait_ns = 0;
	switch (failure_of(err)) {
	case FAILURE_NONE:
		lane->counters.reads++;
		retry_clear(&s->read.retry);
		if (!engine_compare(e, lane, s, slot, &quality)) {
			s->sample.value = value;
			s->attrs.raw = raw;
			break;
		}
		s->read.begun_ns = slot->begun_ns;
		signal_update(s, e->time.period, measured_ns, e->time.now_ns);
		s->sample.detail = answer->detail;
		request_succeeded(e, lane, s, quality, s->shows_device);
		break;
	case FAILURE_ITEM:
		if (err == -EREMCHG)
			hold_back(e, lane, s);
		else
			*wait_ns = engine_read_failed(e, lane, s, err);
		break;
	case FAILURE_TARGET:
		s->sample.err = err;
		break;
	case FAILURE_VOID:
		break;
	}
	return err;
}

void engine_read_next(struct engine *e, struct lane *lane, struct signal *s,
                      const struct slot *slot)
{
	if (s->command.doubted || slot->begun_ns < s->command.ended_ns)
		engine_read_now(e, s);
	else if (signal_reads(s))
		engine_read_at(e, s, slot->begun + engine_reads_apart(e, lane, s));
	else
		engine_read_at(e, s, engine_read_back_at(e, s));
}

void engine_read_done(struct engine *e, struct lane *lane, const struct slot *slot,
                      const struct bus_answer *answer)
{
	struct signal *s = &e->table.signals[slot->row];
	int64_t wait_ns;

	if (!signal_is_read(s) && !slot->one_shot) { /* disabled, or there is a new command */
		engine_read_at(e, s, engine_read_back_at(e, s));
		return;
	}
	if (engine_apply_reading(e, lane, s, slot, answer, &wait_ns) == 0)
		engine_read_next(e, lane, s, slot);
	else
		engine_read_at(e, s, e->time.period + (wait_ns ? engine_periods(e, wait_ns) : 1));
	/* what was asked for meanwhile; and a request that never began is no reading */
	if (s->read.once || (slot->one_shot && failure_of(answer->err) == FAILURE_VOID))
		engine_read_once(e, s);
}

static void write_succeeded(struct engine *e, struct lane *lane, const struct slot *slot,
                            const struct bus_answer *answer)
{
	struct signal *s = &e->table.signals[slot->row];

	lane->counters.writes++;
	if (s->command.retry.doublings && signal_reads(s))
		log_info(e->log, "%s (%s): written again", s->item->name, s->item->path);
	/* first, for a device that comes back forgets what was written, but for this */
	request_succeeded(e, lane, s, s->command.differs ? OWS_Q_DIFFERS : OWS_Q_GOOD, false);
	s->command.confirmed = true;
	s->command.lapsed = false;
	s->command.agrees = s->command.doubted = false;
	if (slot->begun_ns >= s->command.unproven_ns)
		s->command.unproven_ns = 0;
	if (signal_has_device(s) && e->table.devices[s->device].por == POR_SET)
		e->table.devices[s->device].por = POR_UNKNOWN; /* the write may have cleared it */
	s->command.written = slot->value;
	s->sample.detail = answer->detail;
	if (signal_is_string(s)) {
		memcpy(s->written_text, slot->data, slot->req.len);
		memcpy(s->text, slot->data, slot->req.len);
		s->command.written_len = s->sample.len = slot->req.len;
	} else {
		signal_written(s, slot->value);
	}
	signal_update(s, e->time.period, answer->measured_ns ? answer->measured_ns : e->time.now_ns,
	              e->time.now_ns);
	retry_clear(&s->command.retry);
	s->command.err = 0;
	engine_settle_earlier(e, s, slot);
	engine_settle(e, s);
	engine_write_check(e, s);
	if (s->command.differs)
		engine_read_now(e, s);
	else if (!signal_reads(s))
		engine_read_at(e, s, engine_read_back_at(e, s));
}

void engine_write_done(struct engine *e, struct lane *lane, const struct slot *slot,
                       const struct bus_answer *answer)
{
	struct signal *s = &e->table.signals[slot->row];
	int64_t wait_ns;

	s->command.ended_ns = e->time.now_ns;
	if (answer->err) {
		s->command.confirmed = false;
		s->command.one_shot |= slot->one_shot;
	}
	switch (failure_of(answer->err)) {
	case FAILURE_NONE:
		write_succeeded(e, lane, slot, answer);
		return;
	case FAILURE_ITEM:
		wait_ns = fail_write(e, lane, s, answer->err);
		engine_write_at(e, s, e->time.period + (wait_ns ? engine_periods(e, wait_ns) : 1));
		break;
	case FAILURE_TARGET:
		s->sample.err = answer->err;
		engine_write_check(e, s);
		break;
	case FAILURE_VOID:
		engine_write_check(e, s);
		break;
	}
}
