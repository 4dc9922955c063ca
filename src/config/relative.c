/* SPDX-License-Identifier: MIT */
/* Finds the files that a configuration names by a relative path. */
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "src/config/build.h"
#include "src/config/relative.h"

/* Is there such a file? What follows it in a simulated target, as :0x18, is no part of its name. */
static bool exists(const char *name)
{
	const char *chip = strstr(name, ":0x");
	char file[PATH_MAX];
	int n = snprintf(file, sizeof(file), "%.*s", chip ? (int)(chip - name) : INT_MAX, name);

	return n >= 0 && (size_t)n < sizeof(file) && access(file, F_OK) == 0;
}

/* The folder of a file: is it the working directory? Then a name stays as it is written. */
static bool is_here(const char *file, const char *slash)
{
	char folder[PATH_MAX];
	struct stat here, there;

	snprintf(folder, sizeof(folder), "%.*s", (int)(slash + 1 - file), file);
	return stat(folder, &there) == 0 && stat(".", &here) == 0 && here.st_dev == there.st_dev &&
	       here.st_ino == there.st_ino;
}

const char *relative_file(struct build *build, const char *text, size_t prefix,
                          const struct place *place)
{
	const char *file = build->box->config.file, *name = text + prefix;
	const char *slash = strrchr(file, '/');
	char whole[PATH_MAX];
	int n;

	if (*name == '/' || !*name || !slash || is_here(file, slash))
		return build_keep(build, text, strlen(text));
	n = snprintf(whole, sizeof(whole), "%.*s%.*s%s", (int)prefix, text, (int)(slash + 1 - file),
	             file, name);
	if (n < 0 || (size_t)n >= sizeof(whole) || (!exists(whole + prefix) && exists(name))) {
		if (place)
			report_warning(build->report, *place,
			               "%s is taken from the working directory; a relative path "
			               "counts from the folder of this file, %.*s",
			               name, (int)(slash + 1 - file), file);
		return build_keep(build, text, strlen(text));
	}
	return build_keep(build, whole, (size_t)n);
}
