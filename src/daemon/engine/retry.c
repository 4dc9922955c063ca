/* SPDX-License-Identifier: MIT */
/*
 * What an error means for its signal: which kind it is, which quality it gives, and the back-off.
 */
#include <errno.h>

#include "src/daemon/engine/retry.h"
#include "src/public/ows.h"

enum failure failure_of(int err)
{
	switch (-err) {
	case 0:
		return FAILURE_NONE;
	case ENOTCONN:
	case ECONNREFUSED:
	case ETIMEDOUT:
	case ECONNRESET:
	case EPROTO:
		return FAILURE_TARGET;
	case ETIME:
	case ECANCELED:
		return FAILURE_VOID;
	default:
		return FAILURE_ITEM;
	}
}

bool failure_is_verdict(int err)
{
	return err == -ENODATA || err == -ERANGE;
}

uint8_t failure_quality(int err)
{
	switch (-err) {
	case ENOENT:
	case EISDIR:
	case ENOTDIR:
	case EOPNOTSUPP:
		return OWS_Q_NO_PROPERTY;
	case EILSEQ:
	case EMSGSIZE:
		return OWS_Q_TYPE;
	case EACCES:
	case EPERM:
		return OWS_Q_ACCESS;
	case ENODEV:
		return OWS_Q_NO_DEVICE;
	case ERANGE:
		return OWS_Q_SENSOR;
	case ECOMM:
		return OWS_Q_SHORT;
	case ENXIO:
	case ENOTCONN:
	case ECONNREFUSED:
	case ETIMEDOUT:
	case ECONNRESET:
	case EPROTO:
	case ETIME:
		return OWS_Q_TARGET;
	default:
		return OWS_Q_DEVICE;
	}
}

bool retry_fail(struct retry *retry, unsigned max_retries, int64_t *wait_ns)
{
	int64_t wait;

	if (retry->failures < UINT16_MAX)
		retry->failures++;
	*wait_ns = 0;
	if (retry->failures <= max_retries)
		return false;
	wait = RETRY_FIRST_NS << retry->doublings;
	if (wait >= RETRY_MAX_NS)
		wait = RETRY_MAX_NS;
	else
		retry->doublings++;
	*wait_ns = wait;
	return true;
}

void retry_clear(struct retry *retry)
{
	*retry = (struct retry){0};
}
