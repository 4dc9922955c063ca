/* SPDX-License-Identifier: MIT */
/* News of owsd: by the descriptor of a connected handle, else by the word of the image. */
#pragma once

#include <stdint.h>

struct ows;

/*
 * Sleep while the image's count of news is as seen, left_ns at most. Returns 0, -ETIMEDOUT or
 * -EINTR.
 */
int news_sleep(struct ows *h, uint32_t seen, int64_t left_ns);
