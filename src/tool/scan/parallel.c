/* SPDX-License-Identifier: MIT */
/* Reads devices by several connections to the same target. */
#include <pthread.h>

#include "src/tool/scan/parallel.h"
#include "src/tool/scan/scan.h"
#include "src/tool/scan/target.h"

#define READERS 8

struct reader {
	pthread_t thread;
	bool started;
	const struct target *like;
	struct scan_device *first;
	unsigned count;
	bool fresh;
	int err;
};

static void *read_some(void *ctx)
{
	struct reader *reader = ctx;
	struct target target = {.create = reader->like->create,
	                        .name = reader->like->name,
	                        .timeout_ns = reader->like->timeout_ns,
	                        .tap = reader->like->tap,
	                        .until_ns = reader->like->until_ns};
	char why[300];

	reader->err = target_connect(&target, why, sizeof(why));
	if (reader->err) {
		for (unsigned i = 0; i < reader->count; i++)
			for (unsigned k = 0; k < SCAN_PROPERTIES; k++)
				reader->first[i].value[k].err = reader->err;
		return NULL;
	}
	reader->err = scan_read(&target, reader->first, reader->count, reader->fresh);
	target_close(&target);
	return NULL;
}

int scan_read_parallel(const struct target *like, struct scan *scan, bool fresh)
{
	struct reader readers[READERS] = {0};
	unsigned readers_max = like->tap ? 1 : READERS, given = 0;
	unsigned n = scan->count < readers_max ? scan->count : readers_max;
	int err = 0;

	for (unsigned i = 0; i < n; i++) {
		readers[i] = (struct reader){.like = like,
		                             .first = scan->device + given,
		                             .count = (scan->count - given) / (n - i),
		                             .fresh = fresh};
		given += readers[i].count;
		readers[i].started = pthread_create(&readers[i].thread, NULL, read_some,
		                                    &readers[i]) == 0;
		if (!readers[i].started)
			read_some(&readers[i]);
	}
	for (unsigned i = 0; i < n; i++) {
		if (readers[i].started)
			pthread_join(readers[i].thread, NULL);
		err = err ? err : readers[i].err;
	}
	return err;
}
