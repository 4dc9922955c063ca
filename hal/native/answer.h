/* SPDX-License-Identifier: MIT */
/* How a request ends, or begins again. */
#pragma once

#include "hal/native/state.h"

void job_answer(struct native *native, struct job *job, int err);
void job_answer_cached(struct native *native, struct job *job, const struct cache_entry *entry);
/* The master answers what is its own, without a wire; false: the path is not. */
bool job_answer_own(struct native *native, struct job *job);
/* The cache takes the answer. */
void job_keep(struct native *native, struct job *job);
/* Let go of device and pull-up. */
void job_unlock(struct native *native, struct job *job);
void job_restart(struct native *native, struct job *job);
/* A transaction of it failed and is made again; the first of these only counts that. */
void job_count_retry(struct job *job);
void job_again(struct native *native, struct job *job);
/* The same with what its conversion left. */
void job_reread(struct native *native, struct job *job);
