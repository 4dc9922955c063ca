/* SPDX-License-Identifier: MIT */
/*
 * What the parts of owsd-web share. One thread has all of it: the loop of the face, in which
 * libmicrohttpd runs.
 *
 * Room src/faces/web: the program owsd-web: the page of an instance, its signals as JSON and as
 * events.
 */
#pragma once

#include "src/faces/kit/face.h"
#include "src/faces/web/doors.h"
#include "src/faces/web/files.h"
#include "src/faces/web/pace.h"
#include "src/faces/web/person.h"
#include "src/faces/web/recent.h"

#define WEB_ALARMS 64 /* the last ones, for streams that are behind */

struct request;
struct json;

/* What is behind a path. */
struct web_path {
	const char *path; /* without the first "/" */
	bool post;
	/* of owsd; without it the request is refused */
	enum web_need {
		WEB_NOTHING,
		WEB_IMAGE, /* the last image, though owsd may have ended */
		WEB_OWSD,
	} need;
	enum person_deed deed; /* of whoever may not do that the request is refused, too */
	/* Answers the request, and returns what libmicrohttpd wants; or */
	int (*answer)(struct request *request);
	/* writes the members of the object that is the answer. */
	void (*put)(struct json *json, const struct request *request);
};

/* Threads for what takes longer than the loop may wait. */
enum web_worker {
	WEB_PAST,
	WEB_COMMANDS,
	WEB_DRAFTS,
	WEB_SAVES,
	WEB_SCANS,
	WEB_WORKERS,
};

struct MHD_Daemon;
struct stream;
struct jobs;
struct others;

struct web {
	struct face *face;
	const struct web_path *(*route)(const char *path, bool post); /* NULL: there is none */
	struct MHD_Daemon *daemon;
	int epoll; /* of libmicrohttpd */
	struct doors doors;
	const char *serves; /* whom it serves at an address; in the log */
	int files;          /* the directory of the page; -1: there is none */
	struct recent recent;
	int *ids;              /* of libows, of outputs and what can have alarms; else -1 */
	struct others *others; /* NULL: none are named */
	struct jobs *workers[WEB_WORKERS]; /* NULL: nobody has asked for it yet */
	unsigned large;                    /* bodies that are large */
	size_t held;                       /* bytes of answers that are being sent */
	int bell;                          /* of all */
	uint32_t generation;               /* of the table; 0: owsd was never there */
	uint32_t refused;                  /* number of the reload that owsd has refused; 0: none */
	int64_t since_ns;                  /* when owsd-web was started */
	bool ends;
	struct stream *streams;
	unsigned stream_count;
	struct pace pace; /* of changes of values */
	struct shared shared;
	int64_t alive_ns; /* the next line that keeps streams alive */
	/* the last alarms, as texts of events */
	struct {
		uint64_t cursor;
		char *text;
	} alarms[WEB_ALARMS];
	unsigned next_alarm;
	uint64_t alarms_lost; /* the cursor up to which alarms may be missing above */
};
