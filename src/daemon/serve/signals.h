/* SPDX-License-Identifier: MIT */
/*
 * The table as clients of the protocol see it in /signals; the server reads and commands signals as
 * any consumer of the shared memory does. A value that is not good is answered as an error.
 */
#pragma once

#include "src/daemon/serve/directory.h"
#include "src/public/ows.h"

struct signals;

/*
 * Open the image of this instance, which is in place in that directory. It connects to the control
 * room at the first write. Allocates; no function below does. 0 or a negative errno.
 */
int signals_open(const char *dir, const char *instance, struct signals **signals);
void signals_close(struct signals *signals);

/* The signal's own name, also of an attribute, "" of the driver's; NULL: there is none. */
const char *signals_name(struct signals *signals, const char *name);
/* The record of the signal that has this name or attribute; -1: there is none. */
int signals_record(struct signals *signals, const char *name);
/*
 * The text of a signal or attribute. Its length; -ENOENT no such name, -EACCES not readable, -EIO
 * not good.
 */
int signals_read(struct signals *signals, const char *name, int64_t now_ns, char *text,
                 size_t room);

/* A command that is on its way. */
struct signals_command {
	unsigned record;     /* 0: nothing to wait for */
	uint32_t generation; /* the generation of the image in which the signal has this record */
	uint32_t stamp;
	int64_t since_ns;
};
/*
 * Command a signal or attribute for this person; image and journal show the person beside it.
 * 0; -EBUSY: owsd has still to look at the commands of others, call again soon; -ENOENT, -EACCES,
 * -EINVAL: the text is no value of its type, -EOVERFLOW: its type cannot hold the value, -EIO.
 */
int signals_write(struct signals *signals, const char *person, const char *name, int64_t now_ns,
                  const char *text, size_t len, struct signals_command *command);
/*
 * Returns 0 when the bus has the command, -EAGAIN before, else the error of the write; -EOVERFLOW:
 * owsd refused it, its type cannot hold the value, or it is beyond the signal's range. name is the
 * commanded name: a reload may have given the signal another record, or (-ENOENT) none.
 */
int signals_applied(struct signals *signals, const char *name, struct signals_command *command);

/* All names that a list can hold. False: no room. */
bool signals_list(struct signals *signals, struct directory *directory);
