/* SPDX-License-Identifier: MIT */
/* Records of which every field has the same number, so that a mixture of two shows. */
#include <string.h>

#include "tests/unit/aid/whole.h"

#define TEXT_MAX 1024

void whole_publish(struct image *image, uint32_t record, uint32_t n, uint32_t room)
{
	struct ows_sample sample = {
		.value = n,
		.measured_ns = n,
		.tried_ns = n,
		.err = (int32_t)n,
		.quality = (uint8_t)n,
		.detail = (uint8_t)n,
		.target = (uint8_t)n,
		.count = n,
		.confirmed = n,
		.len = room ? n % room : 0,
	};
	struct ows_attrs attrs = {
		.transactions = n,
		.update_ns = n,
		.age_max_ns = n,
		.commanded = n,
		.raw = n,
		.per_base = n,
		.alarms = n,
		.shelved = (uint8_t)n,
	};
	char text[TEXT_MAX];

	memset(text, 'a' + (char)(n % 26), sizeof(text));
	image_publish(image, record, &sample, &attrs, text);
}

bool whole_sample(const struct ows_sample *s)
{
	return s->check == ows_check((const void *)s, 11) && s->value == s->count &&
	       s->measured_ns == s->value && s->tried_ns == s->value &&
	       (uint32_t)s->err == s->count && s->quality == (uint8_t)s->count &&
	       s->target == s->quality && s->detail == s->quality && s->confirmed == s->count;
}

bool whole_slot(const struct ows_slot *s)
{
	const struct ows_attrs *a = &s->attrs;

	return whole_sample(&s->sample) && a->check == ows_check((const void *)a, 19) &&
	       a->transactions == s->sample.count && a->update_ns == s->sample.value &&
	       a->age_max_ns == a->update_ns && a->commanded == a->update_ns &&
	       a->raw == a->update_ns && a->per_base == s->sample.count &&
	       a->alarms == s->sample.count && a->shelved == (uint8_t)s->sample.count;
}

bool whole_text(const struct ows_sample *s, const char *text, uint32_t room)
{
	if (!whole_sample(s) || s->len != s->count % room || strlen(text) != s->len)
		return false;
	for (uint32_t i = 0; i < s->len; i++)
		if (text[i] != 'a' + (char)(s->count % 26))
			return false;
	return true;
}
