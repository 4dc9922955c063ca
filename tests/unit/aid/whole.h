/* SPDX-License-Identifier: MIT */
/*
 * Records in which every field has the same number, so that a mixture of two records shows without
 * the check words: an oracle that shares nothing with the protocol under test.
 */
#pragma once

#include "src/memory/shm/image.h"

/* Texts have up to room - 1 bytes; 0: the record has no text. */
void whole_publish(struct image *image, uint32_t record, uint32_t n, uint32_t room);
bool whole_sample(const struct ows_sample *sample);
bool whole_slot(const struct ows_slot *slot);
/* A sample with its text. */
bool whole_text(const struct ows_sample *sample, const char *text, uint32_t room);
