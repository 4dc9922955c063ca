/* SPDX-License-Identifier: MIT */
/* The newest value of a signal: what counts, why not, of when it is, whether it has changed. */
#include <errno.h>
#include <string.h>

#include "src/faces/show/newest.h"
#include "src/ground/signal/error.h"
#include "src/ground/signal/hash.h"
#include "src/ground/signal/quality.h"

bool face_value_counts(int err)
{
	return !err || err == -ENOSPC || err == -ESTALE;
}

void face_value(struct ows *h, int signal, bool live, int64_t now_ns, struct face_value *value)
{
	struct ows_value *v = &value->v;
	int err = -ESRCH;

	*v = (struct ows_value){.quality = OWS_Q_NO_OWSD};
	value->text[0] = '\0';
	if (h)
		err = ows_get_signal(h, signal, now_ns, v);
	if (face_value_counts(err) && v->type == OWS_STRING)
		err = ows_get_signal_text(h, signal, now_ns, v, value->text, sizeof(value->text));
	/* what was good a moment ago libows may show so for two seconds more */
	if (!live && ows_good(v->quality))
		v->quality = OWS_Q_NO_OWSD;
	value->known = face_value_counts(err) && live && v->quality != OWS_Q_NO_OWSD;
	value->good = value->known && ows_good(v->quality);
	value->simulated = v->detail & OWS_DETAIL_SIMULATED;
	value->lost = !live;
}

const char *face_value_text(struct face_value *value)
{
	enum ows_type type = (enum ows_type)value->v.type;

	if (type != OWS_STRING)
		value_to_text(type,
		              value_is_float(type) ? value_of_double(value->v.number)
		                                   : value->v.integer,
		              value->text);
	return value->text;
}

const char *face_value_why(const struct face_value *value)
{
	if (value->lost)
		return quality_cause(OWS_Q_NO_OWSD);
	if (value->good)
		return "";
	return value->v.err ? error_text(value->v.err) : quality_cause(value->v.quality);
}

const char *face_value_remedy(const struct face_value *value)
{
	const char *remedy = value->v.err ? error_remedy(value->v.err) : "";

	if (value->lost)
		return quality_remedy(OWS_Q_NO_OWSD);
	if (value->good)
		return "";
	return *remedy ? remedy : quality_remedy(value->v.quality);
}

int64_t face_value_time(const struct ows_value *v, int64_t now_ns)
{
	int64_t time_ns = ows_good(v->quality)           ? v->measured_ns
	                  : v->tried_ns > v->measured_ns ? v->tried_ns
	                                                 : now_ns;

	/* StaleAfter is over long after the last attempt, perhaps */
	if (v->quality == OWS_Q_STALE || v->quality == OWS_Q_TARGET || v->quality == OWS_Q_NO_OWSD)
		time_ns = now_ns;
	return time_ns < now_ns ? time_ns : now_ns;
}

uint64_t face_value_print(const struct ows_value *v, const char *text)
{
	uint64_t print = HASH_BEGIN ^ v->quality;

	if (!ows_good(v->quality))
		return print;
	if (v->type == OWS_STRING)
		return hash_text(print, text ? text : "", text ? strlen(text) : 0) | 1;
	print = hash_text(print, (const char *)&v->number, sizeof(v->number));
	if (!value_is_float((enum ows_type)v->type))
		print = hash_text(print, (const char *)&v->integer, sizeof(v->integer));
	return print | 1;
}
