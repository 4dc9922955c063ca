/* SPDX-License-Identifier: MIT */
/* When thermometers convert. */
#pragma once

#include "hal/native/state.h"

/* A new request of a thermometer that is there: due now, if it can be. */
void convert_early(struct native *native, struct job *job, int64_t now);
void convert_begin(struct native *native, struct job *job, int64_t now);
void convert_prepare(struct native *native, struct job *job, int64_t now);
/*
 * Start a conversion where one is due. True: did a transaction, or the chip of the job *in_turn
 * is to convert in turn now, by convert_in_turn(). *next: when to look again.
 */
bool convert_step(struct native *native, int64_t now, int64_t *next, struct job **in_turn);
/* The job of a channel that has its chip convert in turn next, now. NULL: none does. */
struct job *convert_next_in_turn(struct native *native, unsigned n, int64_t now);
void convert_in_turn(struct native *native, struct job *job);
/*
 * The job asked for the latest result, and failed with err. All were told to convert, but nothing
 * proves that its chip did (a strong pull-up hides it)? Then the job has the chip convert anew.
 */
bool convert_instead(struct job *job, int err);
/*
 * The job has read what its chip holds. 0: that is the result that it asked for, or no result of a
 * conversion; TXN_MORE: it is to convert again, as that may be an older one; -EBADMSG: it gives up.
 */
int convert_judge(struct job *job);
