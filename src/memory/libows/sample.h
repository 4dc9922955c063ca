/* SPDX-License-Identifier: MIT */
/* A sample of the image as the value that a caller of libows gets. */
#pragma once

#include <string.h>

#include "src/memory/libows/handle.h"

/* The stamp of this handle's last command for the record that was confirmed; 0: none. */
static inline uint32_t value_applied(const struct ows *h, uint32_t record)
{
	return h->give.base != NULL ? word_get(&give_slot(&h->give, record)->applied) : 0;
}

static inline void value_fill(const struct ows *h, uint32_t record, struct ows_value *value,
                              const struct ows_sample *sample, uint8_t type)
{
	if (type == OWS_DOUBLE || type == OWS_FLOAT) {
		memcpy(&value->number, &sample->value, sizeof(value->number));
		value->integer = 0;
	} else if (type == OWS_STRING) {
		value->number = 0;
		value->integer = 0;
	} else {
		value->number = (double)sample->value;
		value->integer = sample->value;
	}
	value->measured_ns = sample->measured_ns;
	value->tried_ns = sample->tried_ns;
	value->err = sample->err;
	value->count = sample->count;
	value->applied = value_applied(h, record);
	value->len = sample->len;
	value->type = type;
	value->quality = sample->quality;
	value->detail = sample->detail;
	value->target = sample->target;
}
