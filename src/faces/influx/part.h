/* SPDX-License-Identifier: MIT */
/*
 * The part of a batch that is sent at once: the whole batch, until the server calls it too large
 * (413). Pure functions over whole lines.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct part {
	size_t at, len; /* within the batch; len 0: part_next() has to be called */
	size_t most;    /* bytes that the server takes; 0: as many as a batch has */
};

/* Choose what is sent after at: whole lines, at least one. Returns its length; 0: all is sent. */
size_t part_next(struct part *part, const char *batch, size_t batch_len);
/* The server has the part. */
void part_taken(struct part *part);
/* The part is too large: take half of it from now on. False: it is one line. */
bool part_halve(struct part *part, const char *batch);
/* Another batch, or the same one from its begin; what the server takes is still known. */
void part_begin(struct part *part);
