/* SPDX-License-Identifier: MIT */
/*
 * Devices that requests name, and that are not where they were, or that no search has found yet.
 *
 * One that did not answer is looked for three times where it was. An unknown one may be on
 * each channel, and a look at a branch of a coupler costs 50 ms of wire. So requests do not look by
 * themselves: they wait, and each look at a channel is one for all that wait, in as few searches as
 * it takes (search_among). A request is answered -ENODEV when each channel that it could be on was
 * looked at since it began to wait, or was searched as a whole since it came (the background
 * search; the search for keys, if it is one), and at its deadline, if such a search was ever made
 * of all of them. -ECOMM: all of them are short.
 *
 * Looks take a tenth of the time, and up to a second that was saved before; while nothing else
 * needs the wire a quarter. Requests of alarms and outputs may owe a second.
 */
#pragma once

#include "hal/native/state.h"

/* This job's device is not known: the job waits for a look, or has its answer. */
void locate_wait(struct native *native, struct job *job, int64_t now);
/* The device of this job did not answer: is it there? One transaction. */
void locate_missing(struct native *native, struct job *job, int64_t now);
/* One transaction of a look, if one is due; true: did that. idle: no request is ready. */
bool locate_step(struct native *native, int64_t now, bool idle, int64_t *next);
/* The deadline of a job that waits is over: what it is answered. */
int locate_expired(const struct native *native, const struct job *job);
/* Does a request wait for an id that begins with these bits? */
bool locate_wants(const struct native *native, const uint8_t prefix[8], unsigned bits);
