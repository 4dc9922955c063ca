/* SPDX-License-Identifier: MIT */
/* Results are read while the next conversion runs: when it starts, who is read when, audits. */
#include <errno.h>

#include "hal/chips/thermometer.h"
#include "hal/native/double_buffer.h"
#include "hal/native/master.h"
#include "hal/native/presence.h"
#include "hal/native/trial.h"

#define AUDIT_EACH 16
#define CONVERT_NS (750 * TXN_MS)
#define US INT64_C(1000)
#define SUPPLY_NS (30 * TXN_MS) /* three looks */
/* What is read early is read within four fifths of the shortest time. */
#define EARLY(chip) ((int64_t)(chip)->shortest_us * US / 5 * 4)

/* Of a channel, at one moment. */
struct look {
	unsigned trusted; /* of those that are asked for */
	unsigned due;     /* wait for Convert T */
	unsigned unread;  /* ready, and can be read early, too */
	unsigned others;  /* not ready, at work, or cannot be read early */
	bool came;        /* a request came while its chip converted: others will follow */
	int64_t early_ns; /* until when all that are unread can be read early, after the start */
	int64_t all_early_ns; /* ... all that are trusted */
};

static bool is_trusted(const struct thermometer *chip)
{
	return chip->ahead == AHEAD_TRUSTED && chip->resolution == 12;
}

static bool asks_to_convert(const struct job *job, unsigned n)
{
	return job->req && job->txn.device && job->property && job->property->convert &&
	       job->kind == JOB_PROPERTY && job->req->op == BUS_READ &&
	       job->txn.device->channel == n;
}

static bool is_ready(const struct job *job, int64_t now)
{
	const struct thermometer *chip = thermometer_of(job->txn.device);

	return job->state == JOB_CONVERTING && job->ready_ns <= now && !job->again &&
	       chip->strict && is_trusted(chip) && chip->converted_ns <= now;
}

static void look_at_job(struct look *look, const struct job *job, int64_t now)
{
	const struct thermometer *chip = thermometer_of(job->txn.device);
	int64_t early = EARLY(chip);

	if (is_trusted(chip) && job->state != JOB_NEW && job->state != JOB_LOCATE) {
		look->trusted++;
		look->all_early_ns = early < look->all_early_ns ? early : look->all_early_ns;
	}
	look->due += job->state == JOB_DUE;
	if (is_ready(job, now)) {
		look->unread++;
		look->came |= job->since_ns > chip->converted_ns - CONVERT_NS;
		look->early_ns = early < look->early_ns ? early : look->early_ns;
	} else if (job->state == JOB_CONVERTING || job->state == JOB_RUN ||
	           job->state == JOB_PREPARE) {
		look->others++;
	}
}

static struct look look_at(const struct native *native, unsigned n, int64_t now)
{
	struct look look = {.early_ns = INT64_MAX, .all_early_ns = INT64_MAX};

	for (unsigned i = 0; i < NATIVE_DEPTH; i++)
		if (asks_to_convert(&native->jobs[i], n))
			look_at_job(&look, &native->jobs[i], now);
	for (unsigned i = 0; i < native->table.count; i++) {
		const struct device *device = &native->table.devices[i];

		if (native_thermometer(device, n))
			look.others += device->locked || thermometer_of(device)->converted_ns > now;
	}
	return look;
}

static bool all_supplied(const struct native *native, unsigned n)
{
	for (unsigned i = 0; i < native->table.count; i++) {
		const struct device *device = &native->table.devices[i];

		if (native_thermometer(device, n) && device->power != POWER_EXTERNAL)
			return false;
	}
	return true;
}

/* How many may be left to be read early; 0: another way is better. */
static unsigned most(const struct native *native, unsigned n, const struct schedule_plan *plan,
                     const struct look *look, int64_t now)
{
	if (!look->trusted || !all_supplied(native, n) || !trial_alone(native, n) ||
	    trial_waits(native, n, now) || plan->longest_ns != CONVERT_NS)
		return 0;
	return schedule_ahead(native, plan, look->trusted, look->all_early_ns);
}

void double_buffer_choose(struct native *native, unsigned n, const struct schedule_plan *plan,
                          int64_t now)
{
	bool *runs = &native->channel[n].buffer.runs;

	*runs = false;
	if (!trial_fits(native, n))
		return;
	struct look look = look_at(native, n, now);
	*runs = most(native, n, plan, &look, now) > 0;
}

bool double_buffer_runs(const struct native *native, unsigned n)
{
	return native->channel[n].buffer.runs;
}

/* A time that is not of a conversion since the last audit: only its own start renews it. */
static bool is_old(const struct native *native, const struct device *device)
{
	const struct thermometer *chip = thermometer_of(device);

	return chip->strict && chip->latched_ns < native->channel[device->channel].buffer.audit_ns;
}

static void begin_audit(struct native *native, unsigned n, int64_t now)
{
	struct double_buffer *buffer = &native->channel[n].buffer;

	buffer->single = false;
	for (unsigned i = 0; i < native->table.count; i++) {
		struct device *device = &native->table.devices[i];

		if (!native_thermometer(device, n))
			continue;
		thermometer_of(device)->audited = false;
		buffer->single |= is_old(native, device);
	}
	buffer->auditing = true;
	buffer->audit_ns = now;
}

bool double_buffer_begins(struct native *native, unsigned n, int64_t now)
{
	struct double_buffer *buffer = &native->channel[n].buffer;

	if (!trial_fits(native, n) || !buffer->runs)
		return false;
	struct look look = look_at(native, n, now);
	if (look.others || !look.unread || !(look.due || look.came))
		return false;
	if (buffer->cycle >= AUDIT_EACH) {
		if (!buffer->auditing)
			begin_audit(native, n, now);
		return false;
	}
	struct schedule_plan plan = schedule_look(native, n);
	unsigned k = most(native, n, &plan, &look, now);
	int64_t read = schedule_cost(&native->schedule, SCHEDULE_READ);

	return look.unread <= k && (look.unread - 1) * read <= look.early_ns;
}

static void next_cycle(struct native *native, unsigned n)
{
	struct double_buffer *buffer = &native->channel[n].buffer;
	unsigned count = 0;

	for (unsigned i = 0; i < native->table.count; i++)
		count += native_thermometer(&native->table.devices[i], n);
	buffer->supplies = count / AUDIT_EACH + 1;
}

void double_buffer_begun(struct native *native, unsigned n, int err)
{
	struct double_buffer *buffer = &native->channel[n].buffer;

	buffer->cycle = err < 0 ? AUDIT_EACH : (uint8_t)(buffer->cycle + 1);
	if (err < 0)
		return;
	buffer->auditing = false;
	next_cycle(native, n);
}

void double_buffer_restarts(struct native *native, unsigned n)
{
	native->channel[n].buffer.cycle = 0;
	next_cycle(native, n);
}

bool double_buffer_single(const struct native *native, unsigned n)
{
	return native->channel[n].buffer.single;
}

void double_buffer_single_over(struct native *native, unsigned n)
{
	native->channel[n].buffer.single = false;
	double_buffer_restarts(native, n);
}

void double_buffer_converts(const struct native *native, struct device *device, bool own,
                            int64_t now)
{
	struct thermometer *chip = thermometer_of(device);
	/* A start that nobody saw may be the one whose result is read next. */
	bool clear = !chip->tried && now >= chip->busy_ns;
	bool over = clear && chip->converted_ns && chip->converted_ns <= now;
	bool runs = trial_fits(native, device->channel) && now >= chip->busy_ns &&
	            native->channel[device->channel].buffer.runs && is_trusted(chip);

	chip->conversion = (uint8_t)(chip->conversion + (clear ? 1 : 2));
	chip->held_until_ns = 0;
	if (runs && over && chip->strict) {
		chip->held_ns = chip->ended_ns;
		chip->held_own = chip->own;
		chip->held_until_ns = now + EARLY(chip);
	}
	chip->strict = runs;
	chip->own = own;
	if (chip->ahead == AHEAD_TRUSTED)
		chip->ended_ns = now + (int64_t)chip->shortest_us * US;
}

bool double_buffer_serves(const struct native *native, const struct job *job, int64_t now)
{
	const struct device *device = job->txn.device;
	const struct thermometer *chip = thermometer_of(device);

	return trial_fits(native, device->channel) &&
	       native->channel[device->channel].buffer.runs && chip->strict && is_trusted(chip) &&
	       !job->again && chip->converted_ns > now && chip->ended_ns > job->since_ns;
}

bool double_buffer_holds(const struct job *job, int64_t now)
{
	const struct thermometer *chip = thermometer_of(job->txn.device);

	return job->state == JOB_CONVERTING && job->ready_ns <= now && chip->strict &&
	       now <= chip->held_until_ns && chip->converted_ns > now;
}

/* A result that differs proves the end (thermometer_likely_ns): worth a reading if the last did. */
static bool is_likely(const struct thermometer *chip)
{
	return is_trusted(chip) && chip->changes &&
	       chip->read_of == (uint8_t)(chip->conversion - 1);
}

void double_buffer_expire(struct native *native, int64_t now)
{
	for (unsigned i = 0; native->double_buffer && i < NATIVE_DEPTH; i++) {
		struct job *job = &native->jobs[i];

		if (!job->req || !job->txn.device || !job->property || !job->property->convert ||
		    job->kind != JOB_PROPERTY || job->state != JOB_CONVERTING)
			continue;
		struct thermometer *chip = thermometer_of(job->txn.device);
		if (!chip->strict || chip->converted_ns <= now)
			continue;
		if (job->ready_ns <= now && now > chip->held_until_ns &&
		    now < thermometer_likely_ns(chip))
			job->ready_ns = chip->converted_ns;
		if (job->ready_ns == chip->converted_ns && is_likely(chip))
			job->ready_ns = thermometer_likely_ns(chip);
	}
}

bool double_buffer_may_wait(const struct job *job)
{
	return job->txn.device && job->txn.device->family->thermometer &&
	       thermometer_of(job->txn.device)->strict &&
	       is_trusted(thermometer_of(job->txn.device));
}

bool double_buffer_hurries(const struct native *native, int64_t now)
{
	for (unsigned i = 0; native->double_buffer && i < NATIVE_DEPTH; i++) {
		const struct job *job = &native->jobs[i];

		if (job->req && job->txn.device && job->property && job->property->convert &&
		    job->kind == JOB_PROPERTY && double_buffer_holds(job, now))
			return true;
	}
	return false;
}

/* --- Audits ----------------------------------------------------------------------------------- */

static bool to_be_audited(const struct device *device, unsigned n, int64_t now)
{
	if (!native_thermometer(device, n))
		return false;
	const struct thermometer *chip = thermometer_of(device);

	return !device->locked && is_trusted(chip) && chip->strict && !chip->audited &&
	       chip->converted_ns > now && chip->read_of == (uint8_t)(chip->conversion - 1) &&
	       now <= chip->held_until_ns;
}

/* What the transaction has shown of link and device. */
static void saw(struct native *native, struct txn *txn, int err)
{
	native_count(native, COUNT_TRANSACTIONS);
	if (txn->restarted)
		presence_restarted(native, txn->device);
	else if (!err && txn->heard)
		presence_seen(txn->device, native_now(native));
	if (!txn->link_error)
		master_good(native, txn->channel);
	else if (txn->link_error != -ECOMM)
		master_recover(native, txn->channel, txn->link_error);
}

static struct txn begin_txn(struct native *native, struct device *device)
{
	unsigned n = device->channel;

	return (struct txn){.native = native,
	                    .link = native->channel[n].link,
	                    .channel = n,
	                    .device = device,
	                    .since_ns = INT64_MAX,
	                    .oldest_ns = INT64_MAX};
}

static void audit(struct native *native, struct device *device)
{
	struct thermometer *chip = thermometer_of(device);
	struct txn txn = begin_txn(native, device);
	uint8_t bytes[9];
	int err = txn_end(&txn, thermometer_scratchpad(&txn, bytes));
	bool same = !err && bytes[SP_LSB] == chip->latched[0] &&
	            bytes[SP_MSB] == chip->latched[1] && bytes[SP_REMAIN] == chip->latched[2];
	bool restarted = txn.restarted;

	saw(native, &txn, err);
	if (err || restarted)
		return;
	chip->audited = true;
	if (!same)
		trial_doubt(native, device, "an audit read something else than before");
}

static bool audit_one(struct native *native, unsigned n, int64_t now)
{
	struct double_buffer *buffer = &native->channel[n].buffer;

	for (unsigned i = 0; buffer->auditing && i < native->table.count; i++) {
		unsigned at = (buffer->audit_i + i) % native->table.count;

		if (!to_be_audited(&native->table.devices[at], n, now))
			continue;
		buffer->audit_i = at + 1;
		audit(native, &native->table.devices[at]);
		return true;
	}
	return false;
}

/* The next of the channel, while it converts and nothing is left to be read early. */
static bool ask_supply(struct native *native, unsigned n, int64_t now)
{
	struct double_buffer *buffer = &native->channel[n].buffer;

	for (unsigned i = 0; buffer->supplies && i < native->table.count; i++) {
		unsigned at = (buffer->supply_i + i) % native->table.count;
		struct device *device = &native->table.devices[at];

		if (!native_thermometer(device, n) || device->locked ||
		    !is_trusted(thermometer_of(device)) ||
		    thermometer_of(device)->converted_ns < now + SUPPLY_NS)
			continue;
		buffer->supply_i = at + 1;
		buffer->supplies--;
		struct txn txn = begin_txn(native, device);
		int bit = txn_end(&txn, thermometer_ask_power(&txn));
		saw(native, &txn, bit < 0 ? bit : 0);
		if (bit == 0)
			trial_doubt(native, device, "it has no supply of its own");
		return true;
	}
	return false;
}

bool double_buffer_step(struct native *native, int64_t now, bool idle)
{
	for (unsigned n = 0; native->double_buffer && n < native->channels; n++) {
		if (!trial_fits(native, n) || !native->channel[n].buffer.runs ||
		    native_held(native, n, NULL, now))
			continue;
		if (audit_one(native, n, now) ||
		    (idle && !double_buffer_hurries(native, now) && ask_supply(native, n, now)))
			return true;
	}
	return false;
}
