/* SPDX-License-Identifier: MIT */
/* A property is read or written: element by element, transaction by transaction. */
#include <errno.h>
#include <string.h>

#include "hal/chips/facts.h"
#include "hal/chips/field.h"
#include "hal/chips/format.h"
#include "hal/chips/thermometers/thermometer_proof.h"
#include "hal/native/answer.h"
#include "hal/native/convert/convert.h"
#include "hal/native/exchange.h"
#include "hal/native/job_txn.h"
#include "hal/native/listing.h"
#include "hal/native/outcome.h"
#include "hal/native/resolve.h"
#include "hal/native/touch.h"

/* Transactions of one request until others of its rank have their turn. */
#define TURN 8
/* A list waits for as many tries with a wrong checksum. */
#define TRIES_TOLD 3

static bool is_text(const struct property *property)
{
	return property->type == PROPERTY_ASCII || property->type == PROPERTY_BINARY ||
	       property->type == PROPERTY_ALIAS;
}

/* Is it kept as it is written? Then an end of line or of string behind it is not part of it. */
static bool is_kept_as_written(const struct property *property)
{
	return property->type == PROPERTY_ALIAS ||
	       (property->type == PROPERTY_ASCII && property->access == ACCESS_BOTH);
}

static const struct family *family_of_job(const struct job *job)
{
	return job->txn.device ? job->txn.device->family : job->table;
}

static property_function *read_function(const struct job *job)
{
	return property_reader(family_of_job(job), job->property);
}

static property_function *write_function(const struct job *job)
{
	return property_writer(family_of_job(job), job->property);
}

/*
 * After a chunk of a long binary: is there another to be read? When the chip was written since the
 * first one, between the transactions of this job, that is the first again (until the request's
 * deadline): no answer is partly old.
 */
static bool next_chunk(struct job *job)
{
	const struct property *property = job->property;
	const struct txn *txn = &job->txn;

	if (property->type != PROPERTY_BINARY || !property->field.area ||
	    property_size(property) <= FIELD_CHUNK)
		return false;
	if (job->changes != txn->device->changes)
		job->out = 0;
	return txn->len && job->out < property_size(property);
}

/* One element, or chunk, more of the answer; true: there are others. */
static int add_element(struct job *job)
{
	struct txn *txn = &job->txn;
	const struct property *property = job->property;
	bool all = job_wants_all(job);

	if (job->out == 0 && job->element == 0 && txn->device)
		job->changes = txn->device->changes;
	/* of a float its text is what was meant: 1.2, which as a float is 1.2000000477 */
	if (job->req->number && !job->req->single && format_is_number(property, job->extension))
		return 0;
	if (is_text(property)) {
		if (txn->len > txn->room)
			return -EMSGSIZE;
		job->out += txn->len;
		if (!all && next_chunk(job))
			return 1;
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

/* After a part of much, those of its rank that came later have their turn. */
static void queue_again(struct native *native, struct job *job)
{
	job->steps = 0;
	job->order = native->order++;
}

static void read_done(struct native *native, struct job *job)
{
	int more;

	job->tries = 0;
	if (job->txn.device) {
		job->txn.device->settled |= !job->property->offline;
		if (job->property->convert)
			thermometer_unread(job->txn.device, false);
	}
	if (reading_excluded(job->property, job_wants_all(job) ? EXTENSION_NONE : job->extension,
	                     &job->txn))
		more = -EDOM;
	else
		more = add_element(job);
	if (more < 0) {
		job_answer(native, job, more);
		return;
	}
	if (more) {
		queue_again(native, job);
		job_txn(native, job);
		return;
	}
	job_keep(native, job);
	job_answer(native, job, 0);
}

int job_take_value(struct job *job)
{
	struct txn *txn = &job->txn;
	const struct property *property = job->property;
	const char *text = (const char *)job->req->data;
	size_t size = property->takes ? property->takes : property_size(property);
	bool all = job_wants_all(job);

	if (job->req->number && format_is_number(property, job->extension))
		return take_number(property, job->extension, job->req->value, txn);
	size_t whole = bus_write_text(job->req), len = whole;
	if (is_text(property)) {
		size_t skip = all ? job->element * size : 0;

		if (is_kept_as_written(property)) {
			len = text_end(text, len);
			job->taken = whole - len;
		}
		if (skip > len)
			skip = len;
		txn->at = job->req->offset < size ? job->req->offset : size;
		size -= txn->at;
		txn->data = job->req->data + skip;
		txn->len = len - skip < size ? len - skip : size;
		txn->room = txn->len;
		return 0;
	}
	if (all) {
		/* no element is written when a later one cannot be */
		if ((job->element == 0 && !list_fits(property, text, len)) ||
		    !list_part(text, len, job->element, &text, &len))
			return -EINVAL;
		return parse_value(property, EXTENSION_NONE, text, len, txn);
	}
	return parse_value(property, job->extension, text, len, txn);
}

static void write_done(struct native *native, struct job *job)
{
	bool text = is_text(job->property);

	if (job->txn.device && !job->property->offline)
		job->txn.device->settled = true;
	job->taken = text ? job->taken + job->txn.len : bus_write_text(job->req);
	job->tries = 0;
	if (job_wants_all(job) && ++job->element < job->property->array.count &&
	    (!text || job->taken < bus_write_text(job->req))) {
		job_txn(native, job);
		return;
	}
	job_answer(native, job, 0);
}

/* One element of an aggregate is written: the others are read first. */
static bool needs_merge(const struct job *job)
{
	return job->req->op == BUS_WRITE && !job->merged && job->extension >= 0 &&
	       job->property->array.count > 1 && read_function(job) &&
	       write_function(job) != field_write &&
	       (job->property->array.aggregate || job->property->type == PROPERTY_BITS);
}

/* What a disturbed wire may have made of it does not count for long. */
static void forget_doubtful(struct device *device, int64_t now)
{
	if (family_doubts(device) && now >= device->told_ns + FAMILY_DOUBT_NS)
		family_forget(device);
}

/*
 * Which chip it is, where the family code does not tell: known before anything is asked of it.
 * -ENOENT: such a chip has no such property. -EIO: a fault of the chip may be why it has none.
 */
static int identify_chip(struct job *job)
{
	struct txn *txn = &job->txn;
	const struct family *family = family_of_job(job);

	if (!txn->device || !family->identify || job->property->offline ||
	    family_owner(family, job->property) != family)
		return 0;
	struct device *device = txn->device;

	forget_doubtful(device, txn_now(txn));
	if (device->kind)
		return family_has(device, job->property) ? 0
		       : family_doubts(device)           ? -EIO
		                                         : -ENOENT;
	int err = family->identify(txn);

	if (err)
		return err;
	device->told_ns = txn_now(txn);
	memset(txn->own, 0, sizeof(txn->own));
	txn->misread = false;
	return TXN_MORE;
}

static int run_function(struct job *job)
{
	property_function *merge = family_how(family_of_job(job), job->property)->merge;
	bool binary = job->property->type == PROPERTY_BINARY;
	struct txn *txn = &job->txn;

	if (!job->offered)
		return -ENOENT;
	if (job->req->op == BUS_READ && binary &&
	    txn->room + txn->at < property_size(job->property))
		return -EMSGSIZE;
	if (job->req->op == BUS_READ && txn->device &&
	    strcmp(job->property->name, "present") == 0 &&
	    touch_knows(txn->native, txn->device, txn_now(txn))) {
		txn->number[0] = 1;
		txn->measured_ns = txn->device->ok_ns;
		return 0;
	}
	int known = identify_chip(job);
	if (known)
		return known;
	if (job->req->op == BUS_READ)
		return read_function(job)(txn);
	if (needs_merge(job))
		return merge ? merge(txn) : read_function(job)(txn);
	if (txn->phase == 0) {
		int err = job_take_value(job);

		if (err)
			return err;
	}
	/* A write that fails may have changed the chip, too. */
	if (txn->device && !job->property->offline) {
		txn->device->changes++;
		txn_void(txn);
	}
	return write_function(job)(txn);
}

/* The function has to be called again; until then the chip is locked for other jobs. */
static void run_again(struct native *native, struct job *job)
{
	if (++job->steps == TURN)
		queue_again(native, job);
	if (job->txn.strong)
		native_hold(native, job->txn.channel, job, job->txn.wake_ns);
	job->txn.strong = false;
	if (job->txn.device && !job->locks) {
		job->locks = true;
		job->txn.device->locked = true;
	}
}

static bool is_type(const struct job *job)
{
	return job->req->op == BUS_READ && job->property && job->property->offline &&
	       strcmp(job->property->name, "type") == 0;
}

bool job_asks_first(const struct job *job, int64_t now)
{
	struct device *device = job->txn.device;

	if (!device || (job->req->op != BUS_DIR && !is_type(job)))
		return false;
	forget_doubtful(device, now);
	return family_untold(device) && (job->req->op == BUS_DIR || !family_type(device));
}

/* The path may name a directory that such a chip does not have. */
static void answer_asked(struct native *native, struct job *job, int64_t now)
{
	int err = resolve(native, job);

	if (!err && job->kind == JOB_PROPERTY) {
		job_txn(native, job);
		job_run_property(native, job, now);
	} else {
		job_answer(native, job, err ? err : listing(native, job));
	}
}

/*
 * It is there, and does not say what it is: the list has what all have that it may be. A type is
 * not guessed.
 */
static void untold(struct native *native, struct job *job, int err, int64_t now)
{
	bool silent = job->txn.silent || err == -ENODEV;

	if (job->txn.link_error)
		job_failed(native, job, err);
	else if (err == -EBADMSG && ++job->tries < TRIES_TOLD)
		job_again(native, job);
	else if (silent && !job->verified)
		job_missing(native, job, err);
	else if (job->kind == JOB_PROPERTY && (silent || err == -EBADMSG))
		job_answer(native, job, silent ? -EIO : err);
	else
		answer_asked(native, job, now);
}

void job_run_asking(struct native *native, struct job *job, int64_t now)
{
	const struct family *family = job->txn.device->family;
	struct txn *txn = &job->txn;
	int err;

	/* one that each device has: no chip refuses it */
	txn->property = family_common.properties;
	err = txn_end(txn, (family->identify ? family->identify : family->tell)(txn));
	job_saw(native, job, err, now);
	if (err < 0) {
		untold(native, job, err, now);
		return;
	}
	if (err == TXN_MORE) {
		run_again(native, job);
		return;
	}
	txn->device->told_ns = now;
	answer_asked(native, job, now);
}

/*
 * Does nothing show that this chip has sent what was read? Of a write one search is enough, after
 * it: what it wrote is not written twice for that.
 */
static bool lacks_proof(struct job *job)
{
	const struct txn *txn = &job->txn;

	if (!txn->blank || !txn->device || job->property->offline)
		return false;
	job->prove = job->req->op == BUS_WRITE || job->prove == PROVE_READ ? PROVE_AFTER
	                                                                   : PROVE_BEFORE;
	return true;
}

/* A checksum would have told ones from an answer. A driver's chip is asked for something else. */
static int ask_for_chip(struct txn *txn)
{
	if (txn->device->family->proof != PROOF_PRESENCE)
		return -EBADMSG;
	if (txn_driven(txn)) {
		int there = area_ask_driver(txn, txn->device->family->areas,
		                            txn->device->family->area_count);

		return there ? there : -EIO;
	}
	int there = txn_verify(txn, false);
	return there ? there : -ENODEV;
}

/* The search before or after a reading. True: the reading is proved. */
static bool prove_reading(struct native *native, struct job *job, int64_t now)
{
	int err = txn_end(&job->txn, ask_for_chip(&job->txn));

	err = err > 0 ? 0 : err;
	job_saw(native, job, err, now);
	if (err) {
		/* The readings that were to be shared are void, and what they said of the chip. */
		txn_void(&job->txn);
		job_failed(native, job, err);
		return false;
	}
	if (job->prove == PROVE_AFTER) {
		job->prove = PROVE_NOT;
		return true;
	}
	job->prove = PROVE_READ;
	job_txn(native, job);
	return false;
}

void job_run_property(struct native *native, struct job *job, int64_t now)
{
	struct txn *txn = &job->txn;
	bool asks = job->prove == PROVE_BEFORE || job->prove == PROVE_AFTER;

	if (asks && !prove_reading(native, job, now))
		return;
	if (!asks) {
		int err = txn_end(txn, run_function(job));

		job_saw(native, job, err, now);
		if (convert_instead(job, err)) {
			job_restart(native, job);
			return;
		}
		if (err < 0) {
			job_failed(native, job, err);
			return;
		}
		if (err == TXN_MORE || lacks_proof(job)) {
			run_again(native, job);
			return;
		}
	}
	job->prove = PROVE_NOT;
	job_unlock(native, job);
	int err = convert_judge(job);
	if (err) {
		if (err < 0)
			job_answer(native, job, err);
		else
			job_restart(native, job);
		return;
	}
	if (needs_merge(job)) {
		job->merged = true;
		txn->phase = 0;
		txn->wake_ns = 0;
		memset(&txn->area, 0, sizeof(txn->area));
		memset(txn->own, 0, sizeof(txn->own));
		return;
	}
	if (job->req->op == BUS_READ)
		read_done(native, job);
	else
		write_done(native, job);
}
