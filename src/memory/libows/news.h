/* SPDX-License-Identifier: MIT */
/* News of owsd: by the descriptor of a connected handle, else by the word of the image. */
#pragma once

#include <stdint.h>

#include "hal/base/time.h"

struct ows;

/*
 * Sleep while the image's count of news is as seen, left_ns at most. Returns 0, -ETIMEDOUT or
 * -EINTR.
 */
int news_sleep(struct ows *h, uint32_t seen, int64_t left_ns);

/* No event wakes a program when the next owsd is there, or when it did not reopen. */
#define NEXT_OWSD_NS (100 * NS_PER_MS)

/*
 * Returns -ESTALE; for the same image again after NEXT_OWSD_NS, or after timeout_ns (negative: no
 * limit) if that is shorter: a program that does not reopen, or cannot yet, does not spin.
 */
int news_stale(struct ows *h, int64_t timeout_ns);
