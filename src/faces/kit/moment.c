/* SPDX-License-Identifier: MIT */
/* The time that a value with its quality is of. */
#include "src/faces/kit/moment.h"
#include "src/public/ows.h"

int64_t moment_of(const struct ows_value *v, int64_t now_ns)
{
	int64_t time_ns = ows_good(v->quality)           ? v->measured_ns
	                  : v->tried_ns > v->measured_ns ? v->tried_ns
	                                                 : now_ns;

	/* StaleAfter is over long after the last attempt, perhaps */
	if (v->quality == OWS_Q_STALE || v->quality == OWS_Q_TARGET || v->quality == OWS_Q_NO_OWSD)
		time_ns = now_ns;
	return time_ns < now_ns ? time_ns : now_ns;
}
