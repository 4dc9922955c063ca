/* SPDX-License-Identifier: MIT */
/*
 * The way from outside to an output, of all faces: the signal is found, the value is taken for its
 * type, and what is refused is so in words. A command has an age: what may have waited for longer
 * than COMMAND_OLD_NS is refused, whatever held it.
 */
#pragma once

#include "src/faces/kit/face.h"

struct face_command {
	const char *program, *instance; /* of the face */
	const char *name;               /* of the signal */
	const char *text;               /* what to set; NULL: nothing */
	bool reads;                     /* owsd is to read it, and nothing is set */
	const char *person;             /* for whom, as ows_for() takes it */
	int64_t came_ns;                /* it came later than that: face_came() */
};

/*
 * The id of the signal, and *info of it; -ETIME: the command may be too old, -ESTALE: owsd has
 * ended or reloaded, else as ows_find(). What is done then is done for the person.
 */
int face_command_find(struct ows *h, const struct face_command *command, struct ows_info *info);
/* Set it, or have it read. As ows_set(); -ETIME as above. */
int face_command_set(struct ows *h, const struct face_command *command, int id,
                     const struct ows_info *info, uint32_t *stamp);

/* The way to the outputs of an instance, kept open between commands. Zeroed at first. */
struct face_way {
	struct ows *h;   /* NULL: not connected */
	int64_t open_ns; /* when it may be tried again */
};

/*
 * What is done by the way, again on the new image if it says -ESTALE as owsd has reloaded. Waits
 * for owsd when it connects, two seconds at most, once a second. 0, or as the functions above;
 * -ESTALE: also that there is no owsd.
 */
typedef int face_deed(struct ows *h, void *ctx);
int face_way_try(struct face_way *way, const struct face_command *command, face_deed *deed,
                 void *ctx);

/*
 * Before it is set: the face may give the command another text, or refuse it by returning a
 * negative errno. id: of the signal, as long as way.h is the same.
 */
typedef int face_fit(void *ctx, int id, const struct ows_info *info, struct face_command *command);

/* That as a deed: find, and set. fit NULL: as it is. */
int face_command_give(struct face_way *way, struct face_command *command, struct ows_info *info,
                      face_fit *fit, void *ctx);
void face_way_close(struct face_way *way);

#define FACE_REFUSAL 256
/*
 * Why it was refused, and what to do, or which values there are. info: of the signal; its name is
 * NULL as long as that was not found. Returns words.
 */
const char *face_refusal(const struct face_command *command, const struct ows_info *info, int err,
                         char words[FACE_REFUSAL]);
