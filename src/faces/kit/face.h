/* SPDX-License-Identifier: MIT */
/*
 * A face: a program that shows the signals of owsd to others, or keeps them. It is a consumer of
 * libows like any other program, and a table of functions over one loop in one thread: main() gives
 * the table to face_main() (loop.h). docs/first-face.md has a whole one. The loop waits for changes
 * of the signals, for descriptors of the face and for its next tick; it opens the instance again
 * when owsd has reloaded, ended, died or started, reads the configuration again, ends at SIGTERM,
 * writes the log, and feeds the service manager's watchdog.
 *
 * All functions of the table are called by that thread. A face must not wait in them for longer
 * than a write to a file may take.
 *
 * Room src/faces/kit: what all faces share: one loop over the changes of an instance, one way for
 * commands.
 */
#pragma once

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "hal/base/time.h"
#include "src/config/read/config.h"
#include "src/config/read/listen.h"
#include "src/faces/kit/arguments.h"
#include "src/ground/service/notify.h"
#include "src/ground/text/log.h"
#include "src/public/ows.h"

enum face_news {
	/*
	 * owsd is there: at the start, or after it was lost. ows and config are new: indexes of
	 * signals may mean others. changes(NULL) follows.
	 */
	FACE_FOUND,
	FACE_RELOADED, /* the same owsd has reloaded its file, and nothing was missed; likewise */
	FACE_LOST,     /* owsd has ended, died or hangs: no value is good until FACE_FOUND */
	FACE_OVERRUN,  /* changes were missed; changes(NULL) follows */
	FACE_FILE,     /* SIGHUP: the configuration was read again; ows is as before */
	FACE_ALARM,    /* an entry of the journal of alarms: alarm */
	FACE_COMMAND,  /* an entry of the journal of commands: command */
	FACE_ENTRIES_LOST, /* so many entries of the two journals came too fast: count */
	FACE_DESCRIPTOR,   /* fd is ready */
};
struct face_event {
	enum face_news news;
	const struct ows_alarm *alarm;
	const struct ows_commanded *command;
	uint32_t count;
	int fd;
	short ready; /* as poll(2) has it in revents */
};

struct face;

/* NULL may be check, report, and tick where tick_ns stays INT64_MAX; all else is called. */
struct face_ops {
	const char *program; /* "owsd-recorder": in messages, and towards owsd */
	/* the one option of the face besides those of all faces; letter 0: none */
	struct face_option option;
	/*
	 * Of --check, besides the text of the file: may what the block names be used? face->config
	 * is there, and no more. Returns 0, or a negative errno after reporting why not with
	 * face_complain(). NULL: it names nothing. Also of the face's own option if that has no
	 * value: arguments->option is set then.
	 */
	int (*check)(const struct face *face);
	/*
	 * Before the loop; face->config is there, face->ows is not yet. Sets own, and what the face
	 * wants of tick_ns, pace_ns and after_ns. Returns 0, or a negative errno after reporting
	 * why with face_complain(): the program ends, and close() is not called.
	 */
	int (*open)(struct face *face);
	/*
	 * Values of the signals may have changed, as indexes of ows_info() and ows_get_signal(),
	 * each once; NULL: of any. Never called while owsd is lost.
	 */
	void (*changes)(struct face *face, const int *signals, int n);
	void (*event)(struct face *face, const struct face_event *event);
	/* At face->tick_ns or soon after; has to move tick_ns on. Also while owsd is lost. */
	void (*tick)(struct face *face, int64_t now_ns);
	/* Lines of the report (loop.c) besides those of all faces. NULL: none. */
	void (*report)(struct face *face, FILE *out);
	/* After the loop. */
	void (*close)(struct face *face);
};

#define FACE_DESCRIPTORS 8

struct face {
	const struct face_ops *ops;
	void *own; /* of the face */
	const struct face_arguments *arguments;
	struct config *config;
	struct ows *ows; /* NULL until the first FACE_FOUND */
	bool live;       /* owsd is there: between FACE_FOUND and FACE_LOST */
	int64_t tick_ns; /* CLOCK_BOOTTIME; INT64_MAX: no tick */
	/* While live: of all that changed before that time the face knows. */
	int64_t looked_ns;
	/* Least time from one look at the changes to the next: what comes in it comes at once */
	int64_t pace_ns;
	/* owsd reads the value after a device's alarm later: so long the entry waits; 0: not */
	int64_t after_ns;
	/* Entries of the journals up to that time are known already and give no event. */
	int64_t alarms_after_ns, commands_after_ns;
	struct log *log;

	/* of loop.c alone */
	struct notify notify;
	char status[256];
	int fds[FACE_DESCRIPTORS];
	short wanted[FACE_DESCRIPTORS];
	int64_t came_ns[FACE_DESCRIPTORS];
	unsigned fd_count;
	int64_t fed_ns;

	/* of loop.c alone, its report */
	char report[256]; /* its file; "": none */
	int64_t report_ns;
	int64_t loaded_ns; /* when the configuration was read last */
	char refused[256]; /* why it counts no more, though the one before does; "": it counts */

	/* of listeners.c alone: where it should listen and does not, and what to do; "": nowhere */
	char shut[LISTEN_WHY_MAX];
	const char *shut_remedy;

	/* of look.c alone */
	struct ows_cursor cursor;
	bool fresh; /* ows has just been opened: its first look is to come */
	bool stale; /* ows is of an image that counts no more */
	int64_t start_ns, stale_ns, look_ns, open_ns, fd_ns;
	uint32_t next_alarm, next_command;
	int fd, open_err;
};
