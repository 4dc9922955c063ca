/* SPDX-License-Identifier: MIT */
/* Begins a configuration on a machine without owsd, with a writer that ends with owsd-web. */
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "src/faces/kit/arguments.h"
#include "src/faces/web/child.h"
#include "src/faces/web/edit.h"
#include "src/memory/shm/segment.h"

#define PROGRAM "owsd-web"
#define OPTION "--edit"
#define ENDING ".rio"
#define OWN 7 /* arguments that stand in the place of --edit FILE */

static const char begun[] = "OwsDrv {\n"
			    "  Version                 1.00\n"
			    "  TargetName              \"localhost:4304\"\n"
			    "  Web {\n"
			    "    Configure             on\n"
			    "  }\n"
			    "}\n";

static pid_t writer = -1;

bool edit_is_on(void)
{
	return writer > 0;
}

static void end_writer(void)
{
	kill(writer, SIGTERM);
}

int edit_make(const char *file)
{
	int fd = open(file, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644), err = 0;

	if (fd < 0)
		return errno == EEXIST ? 0 : -errno;
	if (write(fd, begun, sizeof(begun) - 1) != (ssize_t)sizeof(begun) - 1)
		err = errno ? -errno : -EIO;
	if (close(fd) && !err)
		err = -errno;
	if (err)
		unlink(file);
	return err;
}

void edit_name(const char *file, char name[EDIT_NAME])
{
	const char *base = strrchr(file, '/') ? strrchr(file, '/') + 1 : file;
	size_t len = strlen(base), ending = strlen(ENDING);

	if (len > ending && !strcmp(base + len - ending, ENDING))
		len -= ending;
	snprintf(name, EDIT_NAME, "%.*s", (int)(len < EDIT_NAME ? len : EDIT_NAME - 1), base);
	if (!segment_name_ok(name))
		snprintf(name, EDIT_NAME, "edit");
}

/* False after printing why. */
static bool start_writer(const char *file, const char *name)
{
	const char *arguments[] = {"owsd-writer-sim", "-n", name, "-c", file, NULL};
	int err = child_start(arguments, &writer);

	/* where there is none, no file of simulated devices can be of use */
	arguments[0] = "owsd-writer";
	if (err == -ENOENT)
		err = child_start(arguments, &writer);
	if (err) {
		face_complain(PROGRAM, "cannot start owsd-writer, which saves the file: %s",
		              strerror(-err));
		return false;
	}
	atexit(end_writer);
	return true;
}

bool edit_begin(int *argc, char ***argv)
{
	static char name[EDIT_NAME], config[] = "-c", instance[] = "-n", listen[] = "-l",
				     address[] = EDIT_ADDRESS;
	char **all, *file;
	int err;

	if (*argc < 2 || strcmp((*argv)[1], OPTION) != 0)
		return true;
	file = *argc > 2 ? (*argv)[2] : NULL;
	if (!file || *file == '-' || !*file) {
		face_complain(PROGRAM, OPTION ": expected the name of a file, such as new" ENDING);
		return false;
	}
	err = edit_make(file);
	if (err) {
		face_complain(PROGRAM, "%s: %s", file, strerror(-err));
		return false;
	}
	edit_name(file, name);
	all = calloc((size_t)*argc + OWN, sizeof(*all));
	if (!all || !start_writer(file, name)) {
		free(all);
		return false;
	}
	all[0] = (*argv)[0];
	all[1] = config;
	all[2] = file;
	all[3] = instance;
	all[4] = name;
	all[5] = listen;
	all[6] = address;
	/* what follows counts more: an address, or the name of an owsd that runs */
	memcpy(all + OWN, *argv + 3, (size_t)(*argc - 3) * sizeof(*all));
	*argc += OWN - 3;
	*argv = all;
	return true;
}
