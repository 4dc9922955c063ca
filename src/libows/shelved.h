/* SPDX-License-Identifier: MIT */
/* Who shelved the limit alarm of a record, until when and why. */
#ifndef LIBOWS_SHELVED_H
#define LIBOWS_SHELVED_H

#include "src/libows/ows.h"

struct ows;
/* Fills the members of a shelved alarm; leaves them as they are if no entry is of the record. */
void shelved_of(struct ows *h, uint32_t record, struct ows_alarm_state *state);

#endif
