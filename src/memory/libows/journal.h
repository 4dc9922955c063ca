/* SPDX-License-Identifier: MIT */
/* The two journals of the image. */
#pragma once

#include "src/memory/libows/handle.h"

/*
 * The entry of that number; head: the number of the next one. Returns 0; -ENOENT: it is not there,
 * or no longer kept; -EAGAIN: owsd is writing it.
 */
int journal_read(struct ows *h, enum ows_area area, uint32_t head, uint32_t number,
                 struct ows_journal_entry *e);
