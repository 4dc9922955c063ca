/* SPDX-License-Identifier: MIT */
/* Words for what history has. */
#include "src/history/file/record.h"

const char *history_reason_text(uint8_t reason)
{
	static const char *const texts[HISTORY_REASONS] = {
		[0] = "none",
		[OWS_HISTORY_STOPPED] = "recorder stopped",
		[OWS_HISTORY_LOST] = "recorder or machine lost",
		[OWS_HISTORY_OWSD_LOST] = "owsd lost",
		[OWS_HISTORY_OVERRUN] = "too many changes",
		[OWS_HISTORY_DISK] = "disk failed",
		[OWS_HISTORY_NOT_ASKED] = "not recorded",
	};

	return reason < HISTORY_REASONS ? texts[reason] : "unknown";
}
