/* SPDX-License-Identifier: MIT */
/* A document that was edited is checked, and takes the place of its file. */
#include <errno.h>
#include <string.h>
#include <unistd.h>

#include "src/config/check/check.h"
#include "src/config/check/targets.h"
#include "src/config/edit/commit.h"
#include "src/config/edit/replace.h"
#include "src/config/read/load.h"
#include "src/config/read/report.h"
#include "src/config/read/rio_file.h"

int edit_lock(const char *file, struct config_report *report)
{
	const struct rio_position position = {file, 0, 0};
	int fd = replace_lock(file);

	if (fd == -EBUSY)
		report_error(report, position, "another program has been editing here for 5 s");
	else if (fd < 0)
		report_error(
			report, position, "cannot be locked: %s%s", strerror(-fd),
			fd == -EACCES || fd == -EPERM
				? "; edit it as its owner, with sudo, or on the page of owsd-web"
				: "");
	return fd;
}

int edit_commit(const struct rio *rio, const char *file, const char *edited,
                struct config_report *report)
{
	struct config *config;
	int err = config_parse(file, rio->text, rio->len, report, &config);

	if (err)
		return err;
	err = config_check_targets(config, report);
	if (!err && edited)
		config_check_items(config, edited, report);
	config_free(config);
	if (err)
		return err;
	err = replace_file(file, rio->text, rio->len);
	if (err == -ENOENT && rio_dangles(file))
		report_error(report, (struct rio_position){file, 0, 0}, RIO_DANGLES);
	else if (err)
		report_error(report, (struct rio_position){file, 0, 0}, "cannot be %s: %s",
		             access(file, F_OK) ? "made" : "replaced", strerror(-err));
	return err;
}
