/* SPDX-License-Identifier: MIT */
/*
 * /statistics: what was asked of the bus, and how it went, under the names that owserver gives
 * them. Clients of owserver read numbers of 32 bits: a count wraps.
 */
#include <stddef.h>
#include <string.h>

#include "hal/native/state.h"
#include "hal/native/statistics.h"
#include "hal/native/virtual.h"

static enum tally_kind tally_kind_of(const struct job *job)
{
	switch ((enum bus_op)job->req->op) {
	case BUS_READ:
		return TALLY_READ;
	case BUS_WRITE:
		return TALLY_WRITE;
	case BUS_DIR:
	case BUS_PROBE:
		break;
	}
	return TALLY_DIRECTORY;
}

static void statistics_enter(struct tally *tally)
{
	tally->calls++;
	tally->now++;
	tally->sum += tally->now;
	if (tally->now > tally->max)
		tally->max = tally->now;
}

void tally_begin(struct native *native, struct job *job)
{
	job->since_ns = native_now(native);
	statistics_enter(&native->tally[tally_kind_of(job)]);
	statistics_enter(&native->tally[TALLY_OVERALL]);
}

static void count_entries(struct tally *tally, const struct job *job, size_t len)
{
	const uint8_t *data = job->req->data, *end = data + len;
	int of_device = job->path.device.len != 0 && job->kind == JOB_LISTING;

	tally->lists[of_device]++;
	while (data < end && (data = memchr(data, '\n', (size_t)(end - data)))) {
		tally->entries[of_device]++;
		data++;
	}
}

void tally_end(struct native *native, struct job *job, const struct bus_answer *answer)
{
	struct tally *tally = &native->tally[tally_kind_of(job)];
	int64_t took = native_now(native) - job->since_ns;

	tally->now--;
	native->tally[TALLY_OVERALL].now--;
	for (int i = 0; i < 3 && i <= job->failures; i++)
		tally->tries[i]++;
	if (took > native->delay_ns)
		native->delay_ns = took;
	if (answer->err)
		return;
	tally->success++;
	tally->bytes += answer->len;
	if (job->req->op == BUS_DIR)
		count_entries(tally, job, answer->len);
}

static int read_delay(struct txn *txn)
{
	txn->number[0] = (double)txn->native->delay_ns / 1e9;
	return 0;
}

enum { WAY_COUNT = 1, WAY_DELAY, WAY_ZERO };
static const struct property_how how[] = {
	[WAY_COUNT] = {.read = virtual_count},
	[WAY_DELAY] = {.read = read_delay},
	[WAY_ZERO] = {.read = virtual_arg},
};

#define COUNT(text, member) VIRTUAL_NUMBER(text, WAY_COUNT, offsetof(struct native, member))
#define TRIES(text, kind) \
	PROPERTY(text, UNSIGNED, VOLATILE, READ, .offline = true, ELEMENTS(3, NUMBERS), \
	         .arg = offsetof(struct native, tally[kind].tries), .how = WAY_COUNT)
#define THREADS(text, kind) \
	PROPERTY_DIR(text), COUNT(text "/max", tally[kind].max), \
		COUNT(text "/now", tally[kind].now), COUNT(text "/num", tally[kind].calls), \
		COUNT(text "/sum", tally[kind].sum)

static const struct property properties[] = {
	PROPERTY_DIR("cache"),
	COUNT("cache/additions", cache.added),
	PROPERTY_DIR("cache/external"),
	COUNT("cache/external/added", cache.added),
	COUNT("cache/external/deleted", cache.deleted),
	COUNT("cache/external/expired", cache.expired),
	COUNT("cache/external/hits", cache.hits),
	COUNT("cache/external/tries", cache.tries),
	VIRTUAL_NUMBER("cache/flips", WAY_ZERO, 0),
	PROPERTY_DIR("cache/primary"),
	COUNT("cache/primary/max", cache.held),
	COUNT("cache/primary/now", cache.held),
	PROPERTY_DIR("directory"),
	PROPERTY_DIR("directory/bus"),
	COUNT("directory/bus/calls", tally[TALLY_DIRECTORY].lists[0]),
	COUNT("directory/bus/entries", tally[TALLY_DIRECTORY].entries[0]),
	PROPERTY_DIR("directory/device"),
	COUNT("directory/device/calls", tally[TALLY_DIRECTORY].lists[1]),
	COUNT("directory/device/entries", tally[TALLY_DIRECTORY].entries[1]),
	VIRTUAL_NUMBER("directory/maxdepth", WAY_ZERO, 0),
	PROPERTY_DIR("errors"),
	/* owserver's names, which openHAB asks for: of checksums of 16 bits too */
	COUNT("errors/CRC8_errors", count[COUNT_CHECKSUMS]),
	COUNT("errors/CRC8_tries", count[COUNT_TRANSACTIONS]),
	COUNT("errors/checksum", count[COUNT_CHECKSUMS]),
	COUNT("errors/link", count[COUNT_LINK_ERRORS]),
	VIRTUAL("errors/max_delay", PROPERTY_FLOAT, LIFE_VOLATILE, ACCESS_READ, 0, WAY_DELAY),
	COUNT("errors/shorts", count[COUNT_SHORTS]),
	PROPERTY_DIR("read"),
	COUNT("read/bytes", tally[TALLY_READ].bytes),
	COUNT("read/cachebytes", cache.hit_bytes),
	COUNT("read/cachesuccess", count[COUNT_CACHE_HITS]),
	COUNT("read/calls", tally[TALLY_READ].calls),
	COUNT("read/success", tally[TALLY_READ].success),
	TRIES("read/tries", TALLY_READ),
	PROPERTY_DIR("threads"),
	THREADS("threads/directory", TALLY_DIRECTORY),
	THREADS("threads/overall", TALLY_OVERALL),
	THREADS("threads/read", TALLY_READ),
	THREADS("threads/write", TALLY_WRITE),
	PROPERTY_DIR("write"),
	COUNT("write/bytes", tally[TALLY_WRITE].bytes),
	COUNT("write/calls", tally[TALLY_WRITE].calls),
	COUNT("write/success", tally[TALLY_WRITE].success),
	TRIES("write/tries", TALLY_WRITE),
};

const struct family virtual_statistics = {.is_virtual = true, HOW(how), PROPERTIES(properties)};
