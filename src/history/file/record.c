/* SPDX-License-Identifier: MIT */
/* Words for what history has. */
#include "src/history/file/record.h"

const char *history_reason_text(uint8_t reason)
{
	static const char *const texts[HISTORY_REASONS] = {
		[HISTORY_REASON_NONE] = "none",
		[HISTORY_STOPPED] = "recorder stopped",
		[HISTORY_LOST] = "recorder or machine lost",
		[HISTORY_OWSD_LOST] = "owsd lost",
		[HISTORY_OVERRUN] = "too many changes",
		[HISTORY_DISK] = "disk failed",
		[HISTORY_NOT_ASKED] = "not recorded",
	};

	return reason < HISTORY_REASONS ? texts[reason] : "unknown";
}
