/* SPDX-License-Identifier: MIT */
/*
 * /statistics: what was asked of the bus, and how it went, under the names that owserver gives
 * them. Clients of owserver read numbers of 32 bits: a count wraps.
 */
#include <errno.h>
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

enum { CALLS, SUCCESS, BYTES, NOW, MAX, SUM, BUS_LISTS, BUS_ENTRIES, LISTS, ENTRIES };
#define OF(kind, what) ((kind) << 8 | (what))

static int read_tally(struct txn *txn)
{
	const struct tally *tally = &txn->native->tally[txn->property->arg >> 8];
	const uint64_t values[] = {
		[CALLS] = tally->calls,
		[SUCCESS] = tally->success,
		[BYTES] = tally->bytes,
		[NOW] = tally->now,
		[MAX] = tally->max,
		[SUM] = tally->sum,
		[BUS_LISTS] = tally->lists[0],
		[BUS_ENTRIES] = tally->entries[0],
		[LISTS] = tally->lists[1],
		[ENTRIES] = tally->entries[1],
	};

	return virtual_count(txn, values[txn->property->arg & 0xff]);
}

static int read_tries(struct txn *txn)
{
	return virtual_count(txn, txn->native->tally[txn->property->arg].tries[txn->element]);
}

static int read_statistics_count(struct txn *txn)
{
	return virtual_count(txn, txn->native->count[txn->property->arg]);
}

enum { TRIES, HITS, ADDED, EXPIRED, DELETED, HELD, HIT_BYTES };

static int read_cache(struct txn *txn)
{
	const struct cache *cache = &txn->native->cache;
	const uint64_t values[] = {
		[TRIES] = cache->tries,         [HITS] = cache->hits,       [ADDED] = cache->added,
		[EXPIRED] = cache->expired,     [DELETED] = cache->deleted, [HELD] = cache->held,
		[HIT_BYTES] = cache->hit_bytes,
	};

	return virtual_count(txn, values[txn->property->arg]);
}

static int read_delay(struct txn *txn)
{
	txn->number[0] = (double)txn->native->delay_ns / 1e9;
	return 0;
}

enum { WAY_TALLY = 1, WAY_TRIES, WAY_COUNT, WAY_CACHE, WAY_DELAY, WAY_ZERO };
static const struct property_how how[] = {
	[WAY_TALLY] = {.read = read_tally},
	[WAY_TRIES] = {.read = read_tries},
	[WAY_COUNT] = {.read = read_statistics_count},
	[WAY_CACHE] = {.read = read_cache},
	[WAY_DELAY] = {.read = read_delay},
	[WAY_ZERO] = {.read = virtual_zero},
};

#define TALLY(text, kind, what) VIRTUAL_NUMBER(text, WAY_TALLY, OF(kind, what))
#define TRIES(text, kind) \
	PROPERTY(text, UNSIGNED, VOLATILE, READ, .offline = true, ELEMENTS(3, NUMBERS), \
	         .arg = (kind), .how = WAY_TRIES)
#define THREADS(text, kind) \
	PROPERTY_DIR(text), TALLY(text "/max", kind, MAX), TALLY(text "/now", kind, NOW), \
		TALLY(text "/num", kind, CALLS), TALLY(text "/sum", kind, SUM)

static const struct property properties[] = {
	PROPERTY_DIR("cache"),
	VIRTUAL_NUMBER("cache/additions", WAY_CACHE, ADDED),
	PROPERTY_DIR("cache/external"),
	VIRTUAL_NUMBER("cache/external/added", WAY_CACHE, ADDED),
	VIRTUAL_NUMBER("cache/external/deleted", WAY_CACHE, DELETED),
	VIRTUAL_NUMBER("cache/external/expired", WAY_CACHE, EXPIRED),
	VIRTUAL_NUMBER("cache/external/hits", WAY_CACHE, HITS),
	VIRTUAL_NUMBER("cache/external/tries", WAY_CACHE, TRIES),
	VIRTUAL_NUMBER("cache/flips", WAY_ZERO, 0),
	PROPERTY_DIR("cache/primary"),
	VIRTUAL_NUMBER("cache/primary/max", WAY_CACHE, HELD),
	VIRTUAL_NUMBER("cache/primary/now", WAY_CACHE, HELD),
	PROPERTY_DIR("directory"),
	PROPERTY_DIR("directory/bus"),
	TALLY("directory/bus/calls", TALLY_DIRECTORY, BUS_LISTS),
	TALLY("directory/bus/entries", TALLY_DIRECTORY, BUS_ENTRIES),
	PROPERTY_DIR("directory/device"),
	TALLY("directory/device/calls", TALLY_DIRECTORY, LISTS),
	TALLY("directory/device/entries", TALLY_DIRECTORY, ENTRIES),
	VIRTUAL_NUMBER("directory/maxdepth", WAY_ZERO, 0),
	PROPERTY_DIR("errors"),
	/* owserver's names, which openHAB asks for: of checksums of 16 bits too */
	VIRTUAL_NUMBER("errors/CRC8_errors", WAY_COUNT, COUNT_CHECKSUMS),
	VIRTUAL_NUMBER("errors/CRC8_tries", WAY_COUNT, COUNT_TRANSACTIONS),
	VIRTUAL_NUMBER("errors/checksum", WAY_COUNT, COUNT_CHECKSUMS),
	VIRTUAL_NUMBER("errors/link", WAY_COUNT, COUNT_LINK_ERRORS),
	VIRTUAL("errors/max_delay", PROPERTY_FLOAT, LIFE_VOLATILE, ACCESS_READ, 0, WAY_DELAY),
	VIRTUAL_NUMBER("errors/shorts", WAY_COUNT, COUNT_SHORTS),
	PROPERTY_DIR("read"),
	TALLY("read/bytes", TALLY_READ, BYTES),
	VIRTUAL_NUMBER("read/cachebytes", WAY_CACHE, HIT_BYTES),
	VIRTUAL_NUMBER("read/cachesuccess", WAY_COUNT, COUNT_CACHE_HITS),
	TALLY("read/calls", TALLY_READ, CALLS),
	TALLY("read/success", TALLY_READ, SUCCESS),
	TRIES("read/tries", TALLY_READ),
	PROPERTY_DIR("threads"),
	THREADS("threads/directory", TALLY_DIRECTORY),
	THREADS("threads/overall", TALLY_OVERALL),
	THREADS("threads/read", TALLY_READ),
	THREADS("threads/write", TALLY_WRITE),
	PROPERTY_DIR("write"),
	TALLY("write/bytes", TALLY_WRITE, BYTES),
	TALLY("write/calls", TALLY_WRITE, CALLS),
	TALLY("write/success", TALLY_WRITE, SUCCESS),
	TRIES("write/tries", TALLY_WRITE),
};

const struct family virtual_statistics = {.is_virtual = true, HOW(how), PROPERTIES(properties)};
