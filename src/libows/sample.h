/* SPDX-License-Identifier: MIT */
/* A sample of the image as the value that a caller of libows gets. */
#ifndef LIBOWS_SAMPLE_H
#define LIBOWS_SAMPLE_H

#include <string.h>

#include "src/libows/ows.h"
#include "src/shm/layout.h"

static inline void value_fill(struct ows_value *value, const struct ows_sample *sample,
                              uint8_t type)
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
	value->applied = sample->applied;
	value->len = sample->len;
	value->type = type;
	value->quality = sample->quality;
	value->detail = sample->detail;
	value->target = sample->target;
}

#endif
