/* SPDX-License-Identifier: MIT */
/* scan --rio: makes a configuration of the devices that were found. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "src/config/edit.h"
#include "src/config/rio_write.h"
#include "src/owsctl/ctl.h"
#include "src/owsctl/scan_item.h"
#include "src/owsctl/scan_rio.h"

static struct rio_node *driver_of(struct rio *rio)
{
	return rio_child(&rio->root, "OwsDrv");
}

static int scan_rio_fill(struct rio **rio, struct scan_names *names, const struct scan *scan,
                         const char *target, struct scan_choice choice)
{
	char *quoted = rio_quote(target);
	int err = quoted ? rio_set(rio, driver_of(*rio), "TargetName", quoted) : -ENOMEM;

	rio_quote_free(quoted);
	for (unsigned i = 0; i < scan->count; i++)
		scan_make_items(names, &scan->device[i], choice);
	if (!err)
		err = scan_add_items(rio, names);
	return err;
}

int scan_rio(const struct scan *scan, const char *target, bool several, struct scan_choice choice)
{
	struct config_report silent = {0};
	struct scan_names names;
	struct rio *rio = NULL;
	int err, status = CTL_DONE;

	/* several targets are written as in TargetName, so the name of a single one has neither */
	if (!several && strpbrk(target, ",|"))
		return ctl_fail("%s cannot be a TargetName: it holds \",\" or \"|\"", target);
	err = scan_names_init(&names, (size_t)scan->count * SCAN_ITEMS) ? 0 : -ENOMEM;
	if (!err)
		err = rio_parse("scan", edit_empty, strlen(edit_empty), &silent, &rio);
	if (!err)
		err = scan_rio_fill(&rio, &names, scan, target, choice);
	if (err)
		status = ctl_fail("%s", err == -ENOMEM ? "no memory" : strerror(-err));
	else if (!names.count)
		status = ctl_nothing(
			"%s has %u device%s, and none that a configuration could be made "
			"for",
			target, scan->count, scan->count == 1 ? "" : "s");
	else if ((status = scan_check(rio, target)) == CTL_DONE)
		fwrite(rio->text, 1, rio->len, stdout);
	if (rio)
		rio_free(rio);
	scan_names_free(&names);
	return status;
}
