/* SPDX-License-Identifier: MIT */
/* What owsd-notify knows of each signal of the image; a reload moves it by the identity. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "src/config/read/config.h"
#include "src/faces/notify/queue.h"
#include "src/public/ows.h"

struct row {
	uint64_t print;    /* of its identity */
	int64_t bad_ns;    /* since when it is bad; 0: it is not */
	int64_t raised_ns; /* since when nobody acknowledges its limit alarm; 0: none stands */
	int now;           /* of rows that are replaced: its index then; -1: it is gone */
	bool chosen, told; /* told: that it is bad */
};
struct rows {
	struct row *row; /* as the signals of the image are numbered */
	int count;
};

/*
 * Rows for the signals that ows has now, with what was known of those that are chosen; entries of
 * the queue get their new numbers. False: no memory, and there are none.
 */
bool rows_make(struct rows *rows, struct ows *ows, const struct config_notify *notify,
               struct queue *queue);
/* The second half of it, pure: sorts the rows that are replaced. */
void rows_carry(struct rows *from, struct rows *to, struct queue *queue);
