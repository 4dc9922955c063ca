/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <string.h>

#include "hal/native/format.h"
#include "hal/native/native.h"

#define TRIES_CHECKSUM 3
#define TRIES_SHORT 2
#define TRIES_DEVICE 2
#define TRIES_LINK 6
#define PROBE_AGE_NS (2 * NATIVE_S)

static void unlock(struct native *native, struct job *job)
{
	for (unsigned chip = 0; chip < NATIVE_CHANNELS; chip++)
		if (native->holder[chip] == job)
			native->holder[chip] = NULL;
	if (job->locks && job->txn.device)
		job->txn.device->locked = false;
	job->locks = false;
}

void job_answer(struct native *native, struct job *job, int err)
{
	struct bus_answer answer = {.id = job->req->id, .err = err, .kind = BUS_TEXT,
	                            .measured_ns = native_now(native)};

	unlock(native, job);
	if (native->master->ops->simulated)
		answer.detail |= BUS_DETAIL_SIMULATED;
	if (!err && job->req->op == BUS_WRITE)
		answer.len = (uint32_t)job->taken;
	else if (!err)
		answer.len = (uint32_t)job->out;
	if (!err && job->req->op == BUS_READ) {
		const struct property *property = job->property;

		if (job->txn.measured_ns)
			answer.measured_ns = job->txn.measured_ns;
		if (property && property->type == PROPERTY_BINARY)
			answer.kind = BUS_BYTES;
		if (property && format_is_number(property, job->extension)) {
			answer.kind = BUS_NUMBER;
			answer.number = format_as_number(property, job->extension, &job->txn);
		}
	}
	job->req = NULL;
	native->lent--;
	native->bus.env->answer(native->bus.env->ctx, &answer);
}

static void answer_cached(struct native *native, struct job *job, const struct cache_entry *entry)
{
	struct bus_answer answer = {.id = job->req->id, .kind = entry->kind, .len = entry->len,
	                            .detail = BUS_DETAIL_CACHED, .measured_ns = entry->measured_ns,
	                            .number = entry->number};

	if (entry->len > job->req->len) {
		job_answer(native, job, -EMSGSIZE);
		return;
	}
	if (native->master->ops->simulated)
		answer.detail |= BUS_DETAIL_SIMULATED;
	memcpy(job->req->data, entry->text, entry->len);
	native_count(native, COUNT_CACHE_HITS);
	job->req = NULL;
	native->lent--;
	native->bus.env->answer(native->bus.env->ctx, &answer);
}

static int64_t life_ns(const struct native *native, const struct property *property)
{
	switch ((enum property_life)property->life) {
	case LIFE_STATIC:
	case LIFE_STABLE:
		return native->stable_ns;
	case LIFE_VOLATILE:
		return native->volatile_ns;
	case LIFE_SECOND:
		return NATIVE_S;
	}
	return 0;
}

static void keep(struct native *native, struct job *job)
{
	const struct property *property = job->property;
	int64_t measured = job->txn.measured_ns ? job->txn.measured_ns : native_now(native);

	if (!job->txn.device || property->offline || job->out > CACHE_TEXT_MAX)
		return;
	struct cache_entry *entry =
		cache_add(&native->cache, job->txn.device, property, job->extension);
	entry->measured_ns = measured;
	entry->until_ns = measured + life_ns(native, property);
	entry->kind = property->type == PROPERTY_BINARY ? BUS_BYTES : BUS_TEXT;
	if (format_is_number(property, job->extension)) {
		entry->kind = BUS_NUMBER;
		entry->number = format_as_number(property, job->extension, &job->txn);
	}
	entry->len = (uint8_t)job->out;
	memcpy(entry->text, job->req->data, job->out);
}

static bool is_all(const struct job *job)
{
	return job->extension == EXTENSION_ALL && !job->property->array.aggregate &&
	       job->property->type != PROPERTY_BITS;
}

/* Make the txn ready for the next element, from its beginning. */
static void txn_begin(struct native *native, struct job *job)
{
	struct txn *txn = &job->txn;
	struct device *device = txn->device;
	unsigned n = device ? device->channel : job->bus >= 0 ? (unsigned)job->bus : 0;

	memset(txn, 0, sizeof(*txn));
	txn->native = native;
	txn->device = device;
	txn->channel = n;
	txn->link = native->channel[n].link;
	txn->property = job->property;
	txn->element = is_all(job) ? (int)job->element
	                           : job->extension >= 0 ? job->extension & 0xff : 0;
	if (job->req->op == BUS_READ) {
		txn->data = job->req->data + job->out;
		txn->room = job->req->len - job->out;
	}
}

void job_restart(struct native *native, struct job *job)
{
	unlock(native, job);
	job->state = JOB_QUEUED;
	job->merged = false;
	job->txn.wake_ns = 0;
}

static bool is_text(const struct property *property)
{
	return property->type == PROPERTY_ASCII || property->type == PROPERTY_BINARY ||
	       property->type == PROPERTY_ALIAS;
}

/* One element more of the answer; true: there are others. */
static int add_element(struct job *job)
{
	struct txn *txn = &job->txn;
	const struct property *property = job->property;
	bool all = is_all(job);

	if (is_text(property)) {
		if (txn->len > txn->room)
			return -EMSGSIZE;
		job->out += txn->len;
	} else {
		int n = format_value(property, all ? EXTENSION_NONE : job->extension, txn,
		                     (char *)job->req->data + job->out, job->req->len - job->out);
		if (n < 0)
			return n;
		job->out += (size_t)n;
	}
	if (!all || ++job->element == property->array.count)
		return 0;
	if (property->type != PROPERTY_BINARY) {
		if (job->out == job->req->len)
			return -EMSGSIZE;
		job->req->data[job->out++] = ',';
	}
	return 1;
}

static void read_done(struct native *native, struct job *job)
{
	int more = add_element(job);

	if (more < 0) {
		job_answer(native, job, more);
		return;
	}
	job->tries = 0;
	if (job->txn.device)
		job->txn.device->settled |= !job->property->offline;
	if (more) {
		txn_begin(native, job);
		return;
	}
	keep(native, job);
	job_answer(native, job, 0);
}

/* The part of the request that is for this element. */
static int take_value(struct job *job)
{
	struct txn *txn = &job->txn;
	const struct property *property = job->property;
	const char *text = (const char *)job->req->data;
	size_t len = job->req->len, size = property_size(property);
	bool all = is_all(job);

	if (is_text(property)) {
		size_t skip = all ? job->element * size : 0;

		if (skip > len)
			skip = len;
		txn->data = job->req->data + skip;
		txn->len = len - skip < size ? len - skip : size;
		txn->room = txn->len;
		return 0;
	}
	if (all) {
		if (list_count(text, len) != property->array.count ||
		    !list_part(text, len, job->element, &text, &len))
			return -EINVAL;
		return parse_value(property, EXTENSION_NONE, text, len, txn);
	}
	return parse_value(property, job->extension, text, len, txn);
}

static void write_done(struct native *native, struct job *job)
{
	bool text = is_text(job->property);

	if (job->txn.device && !job->property->offline) {
		job->txn.device->changes++;
		job->txn.device->settled = true;
	}
	job->taken = text ? job->taken + job->txn.len : job->req->len;
	job->tries = 0;
	if (is_all(job) && ++job->element < job->property->array.count &&
	    (!text || job->taken < job->req->len)) {
		txn_begin(native, job);
		return;
	}
	job_answer(native, job, 0);
}

/* One element of an aggregate is written: the others are read first. */
static bool needs_merge(const struct job *job)
{
	return job->req->op == BUS_WRITE && !job->merged && job->extension >= 0 &&
	       job->property->array.count > 1 && job->property->read &&
	       (job->property->array.aggregate || job->property->type == PROPERTY_BITS);
}

static int run_function(struct job *job)
{
	struct txn *txn = &job->txn;

	if (job->req->op == BUS_READ)
		return txn->property->type == PROPERTY_BINARY && txn->room < property_size(job->property)
		               ? -EMSGSIZE
		               : job->property->read(txn);
	if (needs_merge(job))
		return job->property->read(txn);
	if (txn->phase == 0) {
		int err = take_value(job);

		if (err)
			return err;
	}
	return job->property->write(txn);
}

void job_saw(struct native *native, struct job *job, int err, int64_t now)
{
	struct txn *txn = &job->txn;

	if (!txn->on_wire)
		return;
	txn->on_wire = false;
	native_count(native, COUNT_TRANSACTIONS);
	if (!txn->link_error)
		master_good(native, txn->channel);
	if (txn->restarted && txn->device)
		hunt_restarted(native, txn->device);
	txn->restarted = false;
	if (txn->heard && err != -EBADMSG && txn->device)
		hunt_seen(txn->device, now);
	txn->heard = false;
}

static void hold(struct native *native, struct job *job)
{
	unsigned chip = job->txn.link->chip % NATIVE_CHANNELS;

	if (!job->txn.strong)
		return;
	job->txn.strong = false;
	native->hold_ns[chip] = job->txn.wake_ns;
	native->holder[chip] = job;
}

static void run_property(struct native *native, struct job *job, int64_t now)
{
	struct txn *txn = &job->txn;
	int err = run_function(job);

	job_saw(native, job, err, now);
	if (err < 0) {
		job_failed(native, job, err);
		return;
	}
	if (err == TXN_MORE) {
		hold(native, job);
		if (txn->device && !job->locks) {
			job->locks = true;
			txn->device->locked = true;
		}
		return;
	}
	unlock(native, job);
	if (job->property->convert && !convert_right(job)) {
		/* It converted at another resolution than was thought. */
		job->txn.device->converted_ns = 0;
		job_restart(native, job);
		return;
	}
	if (needs_merge(job)) {
		job->merged = true;
		txn->phase = 0;
		txn->wake_ns = 0;
		return;
	}
	if (job->req->op == BUS_READ)
		read_done(native, job);
	else
		write_done(native, job);
}

static void failed_on_link(struct native *native, struct job *job, int err)
{
	unsigned channel = job->txn.channel;

	job->txn.link_error = 0;
	if (err == -ECOMM) {
		native_count(native, COUNT_SHORTS);
		native->channel[channel].shorts++;
		if (++job->tries >= TRIES_SHORT)
			job_answer(native, job, -ECOMM);
		else
			job_restart(native, job);
		return;
	}
	if (!master_recover(native, channel, err))
		return;
	if (++job->tries >= TRIES_LINK)
		job_answer(native, job, -EIO);
	else
		job_restart(native, job);
}

/* All ones, or nobody: is it away? Looked for once, on all channels. */
static void look_for(struct native *native, struct job *job, int err)
{
	if (job->verified) {
		job_answer(native, job, err == -ENODEV ? -EIO : err);
		return;
	}
	job_restart(native, job);
	job->verified = true;
	job->tries = 0;
	job->channel = job->txn.device->channel;
	job->state = JOB_LOCATE;
}

void job_failed(struct native *native, struct job *job, int err)
{
	if (job->txn.link_error) {
		failed_on_link(native, job, job->txn.link_error);
		return;
	}
	switch (err) {
	case -EBADMSG:
		native_count(native, COUNT_CHECKSUMS);
		if (++job->tries < TRIES_CHECKSUM)
			job_restart(native, job);
		else if (job->txn.silent && job->txn.device)
			look_for(native, job, err);
		else
			job_answer(native, job, err);
		return;
	case -ENODEV:
		if (job->txn.device)
			look_for(native, job, err);
		else
			job_answer(native, job, err);
		return;
	case -ERANGE:
		native_count(native, COUNT_POWER_FAULTS);
		if (!job->property->convert || ++job->faults >= 2) {
			job_answer(native, job, err);
			return;
		}
		job->txn.device->converted_ns = 0;
		job->fresh = true;
		job_restart(native, job);
		return;
	case -EIO:
		if (++job->tries < TRIES_DEVICE)
			job_restart(native, job);
		else
			job_answer(native, job, err);
		return;
	default:
		job_answer(native, job, err);
	}
}

static bool away(const struct native *native, const struct device *device)
{
	return !device || !device->present || device->channel >= native->channels;
}

static void look_read(struct native *native, struct job *job, int64_t now)
{
	const struct cache_entry *entry;

	native_count(native, COUNT_READS);
	if (job->fresh || job->property->offline || away(native, job->txn.device))
		return;
	entry = cache_find(&native->cache, job->txn.device, job->property, job->extension, now);
	if (entry)
		answer_cached(native, job, entry);
}

static void look_structure(struct native *native, struct job *job)
{
	const char *path = job->path.property.text + strlen("structure/");
	int n = structure_read(path, job->path.property.len - strlen("structure/"),
	                       (char *)job->req->data, job->req->len);

	if (n > 0)
		job->out = (size_t)n;
	job_answer(native, job, n < 0 ? n : 0);
}

/* A zero to /simultaneous/temperature is taken, and nothing converts. */
static void look_convert(struct native *native, struct job *job)
{
	int err = parse_value(job->property, job->extension, (const char *)job->req->data,
	                      job->req->len, &job->txn);

	job->taken = job->req->len;
	if (err || job->txn.number[0] == 0)
		job_answer(native, job, err);
}

void job_look(struct native *native, struct job *job, int64_t now)
{
	int err = resolve(native, job);

	job->state = JOB_QUEUED;
	if (err) {
		job_answer(native, job, err);
		return;
	}
	switch ((enum job_kind)job->kind) {
	case JOB_NONE:
		return;
	case JOB_CONVERT:
		look_convert(native, job);
		/* fallthrough */
	case JOB_ALARM:
	case JOB_SCAN:
		job->channel = job->bus >= 0 ? (uint8_t)job->bus : 0;
		return;
	case JOB_STRUCTURE:
		look_structure(native, job);
		return;
	case JOB_LISTING:
		if (job->path.device.len && away(native, job->txn.device))
			return;
		native_count(native, COUNT_DIRECTORIES);
		job_answer(native, job, job->req->op == BUS_DIR ? listing(native, job) : 0);
		return;
	case JOB_PROBE:
		if (job->path.device.len == 0)
			job_answer(native, job, 0);
		else if (!job->fresh && !away(native, job->txn.device) &&
		         job->txn.device->ok_ns + PROBE_AGE_NS > now && job->txn.device->ok_ns)
			job_answer(native, job, 0);
		return;
	case JOB_PROPERTY:
		if (job->req->op == BUS_READ)
			look_read(native, job, now);
		else
			native_count(native, COUNT_WRITES);
		if (!job->req || !job->property->offline ||
		    (job->path.device.len && away(native, job->txn.device)))
			return;
		while (job->req) {
			txn_begin(native, job);
			run_property(native, job, now);
		}
	}
}

static void later(int64_t when, int64_t *next)
{
	if (when < *next)
		*next = when;
}

static unsigned channel_of(const struct job *job)
{
	if (job->state == JOB_LOCATE || job->kind == JOB_SCAN || job->kind == JOB_ALARM ||
	    job->kind == JOB_CONVERT)
		return job->channel;
	return job->txn.device ? job->txn.device->channel : job->bus >= 0 ? (unsigned)job->bus : 0;
}

bool job_ready(const struct native *native, const struct job *job, int64_t now, int64_t *next)
{
	const struct device *device = job->txn.device;
	unsigned channel = channel_of(job);
	int64_t when = 0;

	switch ((enum job_state)job->state) {
	case JOB_NEW:
	case JOB_DUE:
		return false;
	case JOB_QUEUED:
		if (device && device->locked)
			return false;
		break;
	case JOB_LOCATE:
		break;
	case JOB_CONVERTING:
		when = job->ready_ns;
		if (when <= now && device && device->locked)
			return false;
		break;
	case JOB_PREPARE:
	case JOB_RUN:
		when = job->txn.wake_ns;
		if (device && device->locked && !job->locks)
			return false;
		break;
	}
	if (channel < native->channels && native_held(native, channel, job, now)) {
		int64_t held = native->hold_ns[native->channel[channel].link->chip % NATIVE_CHANNELS];

		when = held > when ? held : when;
	}
	if (when > now) {
		later(when, next);
		return false;
	}
	return true;
}

static void run_probe(struct native *native, struct job *job, int64_t now)
{
	txn_begin(native, job);
	int there = txn_verify(&job->txn, false);

	job_saw(native, job, there > 0 ? 0 : -ENODEV, now);
	if (job->txn.link_error)
		job_failed(native, job, there);
	else if (there)
		job_answer(native, job, 0);
	else
		look_for(native, job, -ENODEV);
}

static void begin_property(struct native *native, struct job *job, int64_t now)
{
	if (job->path.device.len && away(native, job->txn.device)) {
		job->state = JOB_LOCATE;
		job->channel = job->bus >= 0 ? (uint8_t)job->bus : 0;
		hunt_locate(native, job, now);
		return;
	}
	if (job->kind == JOB_LISTING) {
		job_answer(native, job, listing(native, job));
		return;
	}
	if (job->kind == JOB_PROBE) {
		run_probe(native, job, now);
		return;
	}
	txn_begin(native, job);
	if (job->property->convert && job->req->op == BUS_READ) {
		convert_begin(native, job, now);
		return;
	}
	job->state = JOB_RUN;
	run_property(native, job, now);
}

void job_step(struct native *native, struct job *job, int64_t now)
{
	job->begun = true;
	switch ((enum job_state)job->state) {
	case JOB_NEW:
	case JOB_DUE:
		return;
	case JOB_QUEUED:
		if (job->kind == JOB_SCAN || job->kind == JOB_ALARM)
			hunt_scan(native, job, now);
		else if (job->kind == JOB_CONVERT)
			convert_all(native, job, now);
		else
			begin_property(native, job, now);
		return;
	case JOB_LOCATE:
		hunt_locate(native, job, now);
		return;
	case JOB_PREPARE:
		convert_prepare(native, job, now);
		return;
	case JOB_CONVERTING:
		job->state = JOB_RUN;
		run_property(native, job, now);
		return;
	case JOB_RUN:
		run_property(native, job, now);
	}
}
