/* SPDX-License-Identifier: MIT */
/* Prints what the board lacks when a scan found nothing. */

#include <string.h>

#include "src/board/board.h"
#include "src/board/look.h"
#include "src/board/report.h"
#include "src/owsctl/scan_board.h"

static bool is_hardware(const char *target)
{
	return target && (!strcmp(target, "auto") || !strncmp(target, "i2c:", 4) ||
	                  !strcmp(target, "w1") || !strncmp(target, "w1:", 3));
}

void scan_board(const char *target)
{
	struct board_report report;
	char folder[400], why[800];

	if (!is_hardware(target))
		return;
	board_folder(folder, sizeof(folder));
	if (board_look("", folder, NULL, &report, why, sizeof(why)) == 0)
		board_print(&report, stderr);
}
